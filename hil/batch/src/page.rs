//! `index.html`: the rows of a batch as a page.

use std::path::Path;

use mesh_damper_report::{BatchEffect, BatchOutcome, BatchRow, batch_page};

use crate::one::REPORT;
use crate::outcome::{Found, Outcome};
use crate::row::Row;

/// The page of `rows`, with links to the reports in the folders below `out`.
pub(crate) fn page(rows: &[Row], out: &Path) -> String {
    let rows: Vec<BatchRow> = rows.iter().map(|row| page_row(row, out)).collect();
    batch_page(&rows)
}

fn page_row(row: &Row, out: &Path) -> BatchRow {
    let (seconds, outcome) = match &row.outcome {
        Outcome::Traced(found) => (found.trace_s, Ok(page_outcome(found, out))),
        Outcome::Failed(failure) => (0.0, Err(failure.error.clone())),
    };
    BatchRow {
        id: row.trace.clone(),
        group: row.specimen.clone().or_else(|| row.group.clone()),
        recordings: row.recordings.clone(),
        held_out: row.held_out.clone(),
        seconds,
        outcome,
    }
}

fn page_outcome(found: &Found, out: &Path) -> BatchOutcome {
    let report = format!("{}/{REPORT}", found.folder);
    let effects = found.effects.iter().map(|effect| BatchEffect {
        family: effect.family.clone(),
        parameters: effect.parameters.clone(),
    });
    let shown = |error: Option<f64>| error.unwrap_or(f64::NAN);
    BatchOutcome {
        conclusion: found.conclusion(),
        effects: effects.collect(),
        adopted: found.adopted,
        nrmse_before: shown(found.nrmse.baseline_held_out),
        nrmse_after: shown(found.nrmse.augmented_held_out),
        noise: shown(found.nrmse.noise_floor),
        warnings: found.warnings.clone(),
        report: out.join(&report).is_file().then_some(report),
    }
}
