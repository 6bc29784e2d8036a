//! One page for a batch of traces: how often each result occurred, and each trace with a link to its own report.

mod groups;
mod pictures;
mod row;
mod traces;

use maud::{Markup, html};
use mesh_damper_identify::trace::result::Verdict;

pub use row::{BatchEffect, BatchOutcome, BatchRow};

use super::html::{Section, figure, page, table};
use super::picture;
use super::text;

/// Sorting and filtering of the traces.
const SCRIPT: &str = include_str!("../script/batch.js");

/// The page for the rows in their order, as one HTML file that needs no other. The links lead to the reports of the traces. It
/// takes about a third of a kilobyte per row.
pub fn batch_page(rows: &[BatchRow]) -> String {
    let failed: Vec<&BatchRow> = rows.iter().filter(|row| row.outcome.is_err()).collect();
    let title = match rows.len() {
        1 => "1 trace".into(),
        count => format!("{count} traces"),
    };
    let elapsed: f64 = rows.iter().map(|row| row.seconds).sum();
    let first = html! {
        div.verdict {
            p.heading { strong { (counted(rows)) } }
            p { "The traces took " (duration(elapsed)) " in total, one after another." }
        }
    };
    let sections = [
        Some(Section::new("1. Verdicts", groups::verdicts(rows))),
        errors(rows),
        groups::effects(rows).map(|body| Section::new("3. Effects", body)),
        traces::table(rows).map(|body| Section::new("4. Traces", body)),
        (!failed.is_empty()).then(|| Section::new("5. Failures", failures(&failed))),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    let last = html! {
        p {
            "Errors are the RMS of the force error divided by the RMS of the measured force, on data that was never fitted: before for \
             the law alone, after for the model. Intervals are 90 % intervals."
        }
    };
    page(&title, first, &sections, last, &[SCRIPT])
}

/// A verdict in the words of the page.
const fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Found => "found",
        Verdict::None => "nothing missing",
        Verdict::Ambiguous => "ambiguous",
        Verdict::Unlisted => "unlisted",
    }
}

/// Every verdict.
const VERDICTS: [Verdict; 4] = [
    Verdict::Found,
    Verdict::None,
    Verdict::Ambiguous,
    Verdict::Unlisted,
];

fn outcomes(rows: &[BatchRow]) -> impl Iterator<Item = &BatchOutcome> + Clone {
    rows.iter().filter_map(|row| row.outcome.as_ref().ok())
}

/// How often each verdict occurred, without those that did not.
fn counted(rows: &[BatchRow]) -> String {
    let failed = rows.len() - outcomes(rows).count();
    let verdicts = VERDICTS.map(|verdict| {
        let count = outcomes(rows).filter(|one| one.verdict == verdict).count();
        (count, word(verdict))
    });
    let all = verdicts.into_iter().chain([(failed, "failed")]);
    let given = all.filter(|(count, _)| *count > 0);
    let said: Vec<String> = given
        .map(|(count, word)| format!("{count} {word}"))
        .collect();
    match said.is_empty() {
        true => "Nothing was traced".into(),
        false => said.join(", "),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 120.0 => format!("{} s", text::number(seconds)),
        seconds if seconds < 7200.0 => format!("{} min", text::number(seconds / 60.0)),
        seconds => format!("{} h", text::number(seconds / 3600.0)),
    }
}

fn errors(rows: &[BatchRow]) -> Option<Section> {
    let picture = pictures::errors(rows)?;
    let limited = outcomes(rows).filter(|one| one.nrmse_after <= NOISE_LIMITED * one.noise);
    let body = html! {
        p {
            (limited.count()) " of " (outcomes(rows).count()) " traces are noise-limited after: their error is within " (NOISE_LIMITED)
            " times the noise."
        }
        (picture::key([&picture], &[]))
        (figure(html! { "error on data that was never fitted, before and after, over the noise of the recording" }, &picture))
    };
    Some(Section::new("2. Errors and noise", body))
}

/// Convention, as in the glossary of the reports: an error within this multiple of the noise is noise-limited.
const NOISE_LIMITED: f64 = 1.5;

fn failures(failed: &[&BatchRow]) -> Markup {
    let head = html! { tr {
        th scope="col" { "trace" } th.text scope="col" { "group" } th.text scope="col" { "error" }
    } };
    let rows = html! {
        @for row in failed {
            @if let Err(message) = &row.outcome {
                tr {
                    th.path scope="row" { (row.id) }
                    td.text { (row.group.as_deref().unwrap_or("–")) }
                    td.text.plain { (message) }
                }
            }
        }
    };
    table("Traces that failed", head, rows)
}

#[cfg(test)]
mod tests;
