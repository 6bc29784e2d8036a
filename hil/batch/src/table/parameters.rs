//! `effects`: one row per parameter, of the law and of the effects of every trace.

use mesh_damper_identify::trace::result::Estimate;

use super::{Table, Values};
use crate::outcome::{Effect, Outcome};
use crate::row::Row;

/// One parameter.
struct Parameter<'a> {
    row: &'a Row,
    part: &'static str,
    family: &'a str,
    amplitude: Option<f64>,
    name: &'a str,
    estimate: &'a Estimate,
    errors: [Option<f64>; 2],
}

/// The table of the parameters of `rows`, one row each.
pub fn parameters(rows: &[Row]) -> Table {
    let all: Vec<Parameter<'_>> = rows.iter().flat_map(of_row).collect();
    let text =
        |of: fn(&Parameter<'_>) -> Option<String>| Values::Text(all.iter().map(of).collect());
    let real = |of: fn(&Parameter<'_>) -> Option<f64>| {
        let finite = |parameter| of(parameter).filter(|value| value.is_finite());
        Values::Real(all.iter().map(finite).collect())
    };
    columns! {
        id: "Identity of the trace, as in `outcomes`.", text(|one| one.row.id.clone());
        trace: "The trace, as in `outcomes`.", text(|one| Some(one.row.trace.clone()));
        specimen: "The specimen from the table.", text(|one| one.row.specimen.clone());
        part: "`law`; `effect` for an effect found; `unconfirmed` for one that is in the model and not confirmed.",
            text(|one| Some(one.part.to_owned()));
        family: "The law's name, or the family of the effect.", text(|one| Some(one.family.to_owned()));
        amplitude_mm: "Of a law: the amplitude of the coefficient; 0 if it holds for all amplitudes. Empty for an effect.",
            real(|one| one.amplitude);
        parameter: "The parameter's name.", text(|one| Some(one.name.to_owned()));
        value: "Its value, in `unit`.", real(|one| Some(one.estimate.value));
        low: "Lower end of its 90 % interval; empty if the data set no bound.", real(|one| Some(one.estimate.low));
        high: "Upper end of its 90 % interval; empty if the data set no bound.", real(|one| Some(one.estimate.high));
        unit: "The unit of the value and of both ends.", text(|one| Some(one.estimate.unit.clone()));
        nrmse_without: "Of an effect: the held-out error without it.", real(|one| one.errors[0]);
        nrmse_with: "Of an effect: the held-out error with it.", real(|one| one.errors[1]);
    }
}

fn of_row(row: &Row) -> Vec<Parameter<'_>> {
    let Outcome::Traced(found) = &row.outcome else {
        return Vec::new();
    };
    let law = found.law.iter().flat_map(|node| {
        [
            ("k1", &node.k1),
            ("k3", &node.k3),
            ("c", &node.c),
            ("alpha", &node.alpha),
        ]
        .map(|(name, estimate)| Parameter {
            row,
            part: "law",
            family: &found.law_name,
            amplitude: Some(node.amplitude),
            name,
            estimate,
            errors: [None; 2],
        })
    });
    let effects = [
        ("effect", &found.effects),
        ("unconfirmed", &found.unconfirmed),
    ];
    let effects = effects.into_iter().flat_map(|(part, effects)| {
        effects.iter().flat_map(move |effect: &Effect| {
            effect
                .parameters
                .iter()
                .map(move |(name, estimate)| Parameter {
                    row,
                    part,
                    family: &effect.family,
                    amplitude: None,
                    name,
                    estimate,
                    errors: [effect.nrmse_without, effect.nrmse_with],
                })
        })
    });
    law.chain(effects).collect()
}
