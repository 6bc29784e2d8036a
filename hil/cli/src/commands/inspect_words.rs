//! The output of `hil inspect`.

use std::borrow::Cow;
use std::fmt::Display;

use mesh_damper_output::error::InputError;
use mesh_damper_output::terminal::visible;
use mesh_damper_tables::columns;
use mesh_damper_tables::files::Column;

use super::inspect::{Inspected, InspectedColumn, InspectedRecording, InspectedTable};

/// Number of columns shown for a table, of parts that are not read, and of notes.
const SHOWN: usize = 40;
/// Longest name shown, in characters.
const NAME: usize = 36;
/// Number of comments shown, and the characters of each. Convention: a preamble in half a screen.
const COMMENTS: usize = 8;
const COMMENT: usize = 120;

/// Says all lines about a file, one after the other: it may have very many.
pub fn of(file: &Inspected, say: &mut dyn FnMut(&str)) {
    say(&format!("{}: {}", file.file.display(), file.file_format));
    for table in &file.tables {
        of_table(table, say);
    }
    let comments = file.comments.iter();
    let comments = comments.map(|comment| cut(comment, COMMENT));
    some(comments, "  comment: ", COMMENTS, "comments", say);
    if let Some(recording) = &file.recording {
        say(&of_recording(recording));
        let faults = recording.faults.iter();
        faults.for_each(|fault| say(&format!("  warning: {fault}")));
    }
    some(file.notes.iter(), "  note: ", SHOWN, "notes", say);
    let questions = file.questions.iter();
    questions.for_each(|question| say(&format!("  question: {question}")));
    if file.problem.is_some() {
        // The file must be corrected before a trace.
        return;
    }
    let how = if file.questions.is_empty() {
        "next"
    } else {
        "next; replace the words in capitals by your answers"
    };
    say(&format!("  {how}: {}", file.command));
}

/// Says the first of some texts, and how many more there are.
fn some(
    texts: impl ExactSizeIterator<Item = impl Display>,
    before: &str,
    most: usize,
    what: &str,
    say: &mut dyn FnMut(&str),
) {
    let more = texts.len().saturating_sub(most);
    texts
        .take(most)
        .for_each(|text| say(&format!("{before}{text}")));
    if more > 0 {
        let margin = " ".repeat(before.len() - before.trim_start().len());
        say(&format!("{margin}and {more} more {what}; --json has all"));
    }
}

fn of_table(table: &InspectedTable, say: &mut dyn FnMut(&str)) {
    let name = if table.name.is_empty() {
        String::new()
    } else {
        format!("table {}: ", table.name)
    };
    let rows = table
        .rows
        .map_or_else(String::new, |rows| format!(", {rows} rows"));
    let plural = if table.columns.len() == 1 { "" } else { "s" };
    let count = table.columns.len();
    say(&format!("  {name}{count} column{plural}{rows}"));
    let rows: Vec<[String; 4]> = table.columns.iter().take(SHOWN).map(cells).collect();
    let width = |index: usize| {
        rows.iter()
            .map(|row| row[index].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths = [0, 1, 2].map(width);
    for [name, values, range, taken] in &rows {
        let padded = |text: &str, width: usize| {
            format!(
                "{text}{}",
                " ".repeat(width.saturating_sub(text.chars().count()))
            )
        };
        say(&format!(
            "    {}  {}  {}  {taken}",
            padded(name, widths[0]),
            padded(values, widths[1]),
            padded(range, widths[2])
        ));
    }
    if count > SHOWN {
        say(&format!("    and {} more; --json has all", count - SHOWN));
    }
    some(
        table.skipped.iter(),
        "    not read: ",
        SHOWN,
        "that are not read",
        say,
    );
}

/// Name with unit, first values, range and interpretation of a column.
fn cells(column: &InspectedColumn) -> [String; 4] {
    let unit = column
        .unit
        .as_ref()
        .map_or_else(String::new, |unit| format!(" [{}]", columns::bare(unit)));
    let first: Vec<String> = column
        .first
        .iter()
        .take(3)
        .map(|value| value.map_or("-".into(), short))
        .collect();
    let more = if column.first.len() > 3 { " …" } else { "" };
    let range = column.range.map_or_else(String::new, |[least, most]| {
        format!("{} to {}", short(least), short(most))
    });
    [
        cut(&format!("{}{unit}", column.name), NAME),
        format!("{}{more}", first.join(" ")),
        range,
        column.taken_for.to_string(),
    ]
}

fn of_recording(recording: &InspectedRecording) -> String {
    let [first, last] = recording.time_s;
    let rate = match (recording.rate_hz, recording.jitter_steps) {
        (Some(rate), Some(jitter)) => format!(
            "{} Hz with a jitter of {:.1} % of a step",
            short(rate),
            100.0 * jitter
        ),
        (Some(rate), None) => format!("{} Hz", short(rate)),
        (None, _) => "without a constant rate".into(),
    };
    let cycle = recording
        .samples_per_cycle
        .map_or_else(String::new, |samples| {
            format!(", {} samples in the fastest cycles", samples.round())
        });
    let range =
        |[least, most]: [f64; 2], unit: &str| format!("{} to {} {unit}", short(least), short(most));
    let controls = if recording.controls.is_empty() {
        String::new()
    } else {
        format!("; control inputs {}", recording.controls.join(", "))
    };
    format!(
        "  recording: {} samples from {} to {} s, {rate}{cycle}; displacement {}; force {}{controls}",
        recording.samples,
        short(first),
        short(last),
        range(recording.displacement_mm, "mm"),
        range(recording.force_kn, "kN")
    )
}

/// The probable meaning of a column, as it is `described`, or the reason why it has none. While a question is open, no column is used
/// yet.
pub fn why_not(column: &Column, described: Option<String>, is_open: bool) -> Cow<'static, str> {
    match (described, column.is_numeric, is_open) {
        (Some(what), _, true) => format!("could be {what}").into(),
        (Some(what), _, false) => format!("could be {what}; not used").into(),
        (None, false, true) => "it holds text".into(),
        (None, false, false) => "not used: it holds text".into(),
        (None, true, true) => "its name does not match any channel".into(),
        (None, true, false) => "not used: its name does not match any channel".into(),
    }
}

/// A question without the name of the file.
pub fn question(error: &InputError) -> String {
    let line = error.to_string();
    let named = format!("{}: ", error.source_name);
    line.strip_prefix(&named).unwrap_or(&line).to_owned()
}

/// A number to six digits.
fn short(value: f64) -> String {
    mesh_damper_tables::write::decimal((format!("{value:.5e}")).parse().unwrap_or(value))
}

/// A text as it is shown, with blanks for tabs, of at most `longest` characters.
fn cut(text: &str, longest: usize) -> String {
    // What is longer in the file is longer when it is shown.
    let text: String = text.chars().take(longest + 1).collect();
    let text = text.replace('\t', " ");
    let text = visible(&text);
    if text.chars().count() <= longest {
        return text.into_owned();
    }
    text.chars().take(longest - 1).chain(['…']).collect()
}
