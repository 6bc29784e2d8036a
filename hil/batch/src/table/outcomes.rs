//! `outcomes`: one row per trace.

use mesh_damper_identify::trace::result::Verdict;

use super::{Table, Values};
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
    columns! {
        id: "Identity of the trace: a hash of the contents of its recordings, their roles, the settings and the program's version.",
            text(|row| row.id.clone());
        trace: "The group, or the recording's path as it was listed.", text(|row| Some(row.trace.clone()));
        group: "The group from the table.", text(|row| row.group.clone());
        specimen: "The specimen from the table.", text(|row| row.specimen.clone());
        recordings: "Paths of the recordings that were fitted.", texts(|row| &row.recordings);
        held_out: "Paths of the recordings that were held out.", texts(|row| &row.held_out);
        copies: "Paths of recordings with the same content; they have no row of their own.", texts(|row| &row.copies);
        outcome: "`traced` or `failed`.", text(|row| Some(made(row).map_or("failed", |_| "traced").to_owned()));
        verdict: "`none`, `found`, `ambiguous` or `unlisted`, as in `trace.json`.", found(|found| Some(word(found.verdict)));
        effects: "Families of the effects found.", lists(|found| families(&found.effects));
        unconfirmed: "Families of effects that are in the model and not confirmed.", lists(|found| families(&found.unconfirmed));
        depends_on: "Variables on which the force beyond the law depends.", lists(|found| found.depends_on.clone());
        adopted: "Whether the model contains the effects found.", Values::Flag(adopted.collect());
        nrmse_baseline_fitted: "Error of the law alone on the fitted samples, RMS over RMS of the force.",
            real(|found| found.nrmse.baseline_fitted);
        nrmse_baseline_held_out: "The same on the held-out samples.", real(|found| found.nrmse.baseline_held_out);
        nrmse_augmented_fitted: "Error of the model on the fitted samples, in f64.", real(|found| found.nrmse.augmented_fitted);
        nrmse_augmented_held_out: "The same on the held-out samples.", real(|found| found.nrmse.augmented_held_out);
        nrmse_on_target_held_out: "Error of the embedded model in f32 on the held-out samples.",
            real(|found| found.nrmse.on_target_held_out);
        nrmse_noise_floor: "Noise of the measured force, over the RMS of the force.", real(|found| found.nrmse.noise_floor);
        remainder_times_noise: "Residual of the model as a multiple of the noise of force and motion; empty if it is only noise.",
            real(|found| found.remainder_times_noise);
        warning_count: "Number of warnings.", count(|found| found.warnings.len());
        warnings: "Problems of the data, as sentences. Files have the names of the time of the trace.",
            lists(|found| found.warnings.clone());
        guesses: "Guesses made in reading the files, as sentences.", lists(|found| found.guesses.clone());
        samples: "Number of samples in all recordings.", count(|found| found.samples);
        duration_s: "Duration of all recordings.", real(|found| Some(found.duration_s));
        displacement_min_mm: "Smallest displacement of the fitted samples.", real(|found| Some(found.fitted_range.displacement[0]));
        displacement_max_mm: "Largest displacement of the fitted samples.", real(|found| Some(found.fitted_range.displacement[1]));
        velocity_min_mm_s: "Smallest velocity of the fitted samples.", real(|found| Some(found.fitted_range.velocity[0]));
        velocity_max_mm_s: "Largest velocity of the fitted samples.", real(|found| Some(found.fitted_range.velocity[1]));
        trace_s: "Duration of the trace.", real(|found| Some(found.trace_s));
        program_version: "Version of the program that made the trace.", found(|found| Some(found.program_version.clone()));
        folder: "The trace's folder in the batch's folder, with `trace.json` and `model.json`.", found(|found| Some(found.folder.clone()));
        error: "The reason why the trace could not be made, in one line.",
            text(|row| match &row.outcome {
                Outcome::Failed(failure) => Some(failure.error.clone()),
                Outcome::Traced(_) => None,
            });
        conclusion: "The verdict in the words of the page. It tells apart a `none` that is `nothing missing` and one that is `not decided`.",
            found(|found| Some(found.conclusion().words().to_owned()));
    }
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
