//! `outcomes`: one row per trace.

use mesh_damper_identify::trace::result::Verdict;

use super::{Column, Table, Values};
use crate::outcome::{Effect, Found, Outcome};
use crate::row::Row;

/// The table of `rows`, one row each.
pub fn outcomes(rows: &[Row]) -> Table {
    let text = |of: fn(&Row) -> Option<String>| Values::Text(rows.iter().map(of).collect());
    let texts = |of: fn(&Row) -> &[String]| {
        Values::Texts(rows.iter().map(|row| of(row).to_vec()).collect())
    };
    let found = |of: fn(&Found) -> Option<String>| {
        Values::Text(rows.iter().map(|row| of(made(row)?)).collect())
    };
    let lists = |of: fn(&Found) -> Vec<String>| {
        Values::Texts(
            rows.iter()
                .map(|row| made(row).map(of).unwrap_or_default())
                .collect(),
        )
    };
    let real = |of: fn(&Found) -> Option<f64>| {
        Values::Real(rows.iter().map(|row| of(made(row)?)).collect())
    };
    let count = |of: fn(&Found) -> usize| {
        let count = |row| made(row).map(|found| of(found) as u64);
        Values::Count(rows.iter().map(count).collect())
    };
    let adopted = rows.iter().map(|row| made(row).map(|found| found.adopted));
    let columns = [
        (
            "id",
            "Identity of the trace: a hash of what its recordings hold, their roles, the settings and the program's version.",
            text(|row| row.id.clone()),
        ),
        (
            "trace",
            "The group, or the recording's path as it was listed.",
            text(|row| Some(row.trace.clone())),
        ),
        (
            "group",
            "The group that the table names.",
            text(|row| row.group.clone()),
        ),
        (
            "specimen",
            "The specimen that the table names.",
            text(|row| row.specimen.clone()),
        ),
        (
            "recordings",
            "Paths of the recordings that were fitted.",
            texts(|row| &row.recordings),
        ),
        (
            "held_out",
            "Paths of the recordings that were held out.",
            texts(|row| &row.held_out),
        ),
        (
            "copies",
            "Paths of recordings that hold the same: they are no rows of their own.",
            texts(|row| &row.copies),
        ),
        (
            "outcome",
            "`traced` or `failed`.",
            text(|row| {
                Some(
                    if made(row).is_some() {
                        "traced"
                    } else {
                        "failed"
                    }
                    .to_owned(),
                )
            }),
        ),
        (
            "verdict",
            "`none`, `found`, `ambiguous` or `unlisted`, as in `trace.json`.",
            found(|found| Some(word(found.verdict))),
        ),
        (
            "effects",
            "Families of the effects found.",
            lists(|found| families(&found.effects)),
        ),
        (
            "unconfirmed",
            "Families of effects that are in the model and not confirmed.",
            lists(|found| families(&found.unconfirmed)),
        ),
        (
            "depends_on",
            "What the force beyond the law depends on.",
            lists(|found| found.depends_on.clone()),
        ),
        (
            "adopted",
            "Whether the model holds what was found.",
            Values::Flag(adopted.collect()),
        ),
        (
            "nrmse_baseline_fitted",
            "Error of the law alone on what was fitted, RMS over RMS of the force.",
            real(|found| found.nrmse.baseline_fitted),
        ),
        (
            "nrmse_baseline_held_out",
            "The same on what was held out.",
            real(|found| found.nrmse.baseline_held_out),
        ),
        (
            "nrmse_augmented_fitted",
            "Error of the model on what was fitted, in f64.",
            real(|found| found.nrmse.augmented_fitted),
        ),
        (
            "nrmse_augmented_held_out",
            "The same on what was held out.",
            real(|found| found.nrmse.augmented_held_out),
        ),
        (
            "nrmse_on_target_held_out",
            "Error of the embedded model in f32 on what was held out.",
            real(|found| found.nrmse.on_target_held_out),
        ),
        (
            "nrmse_noise_floor",
            "Noise of the measured force, over the RMS of the force.",
            real(|found| found.nrmse.noise_floor),
        ),
        (
            "remainder_times_noise",
            "What the model leaves, over the noise; none where that is noise.",
            real(|found| found.remainder_times_noise),
        ),
        (
            "warning_count",
            "How many things are wrong with the data.",
            count(|found| found.warnings.len()),
        ),
        (
            "warnings",
            "What is wrong with the data. Files are named as they were when it was traced.",
            lists(|found| found.warnings.clone()),
        ),
        (
            "guesses",
            "What was taken for what in the files without being sure.",
            lists(|found| found.guesses.clone()),
        ),
        (
            "samples",
            "Samples of all recordings.",
            count(|found| found.samples),
        ),
        (
            "duration_s",
            "Length of all recordings.",
            real(|found| Some(found.duration_s)),
        ),
        (
            "displacement_min_mm",
            "Least displacement that was fitted.",
            real(|found| Some(found.fitted_range.displacement[0])),
        ),
        (
            "displacement_max_mm",
            "Largest displacement that was fitted.",
            real(|found| Some(found.fitted_range.displacement[1])),
        ),
        (
            "velocity_min_mm_s",
            "Least velocity that was fitted.",
            real(|found| Some(found.fitted_range.velocity[0])),
        ),
        (
            "velocity_max_mm_s",
            "Largest velocity that was fitted.",
            real(|found| Some(found.fitted_range.velocity[1])),
        ),
        (
            "trace_s",
            "What the trace took.",
            real(|found| Some(found.trace_s)),
        ),
        (
            "program_version",
            "The version of the program that made it.",
            found(|found| Some(found.program_version.clone())),
        ),
        (
            "folder",
            "The trace's folder, below the batch's, with `trace.json` and `model.json`.",
            found(|found| Some(found.folder.clone())),
        ),
        (
            "error",
            "Why the trace could not be made, in one line.",
            text(|row| match &row.outcome {
                Outcome::Failed(failure) => Some(failure.error.clone()),
                Outcome::Traced(_) => None,
            }),
        ),
    ];
    let columns = columns.into_iter();
    Table(
        columns
            .map(|(name, about, values)| Column {
                name,
                about,
                values,
            })
            .collect(),
    )
}

fn made(row: &Row) -> Option<&Found> {
    match &row.outcome {
        Outcome::Traced(found) => Some(found),
        Outcome::Failed(_) => None,
    }
}

fn families(effects: &[Effect]) -> Vec<String> {
    effects.iter().map(|effect| effect.family.clone()).collect()
}

/// The word for a verdict in `trace.json`.
fn word(verdict: Verdict) -> String {
    match verdict {
        Verdict::None => "none",
        Verdict::Found => "found",
        Verdict::Ambiguous => "ambiguous",
        Verdict::Unlisted => "unlisted",
    }
    .to_owned()
}
