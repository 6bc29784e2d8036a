//! The output of `hil inspect`.

use mesh_damper_output::error::InputError;
use mesh_damper_tables::columns;
use mesh_damper_tables::files::Column;

use super::inspect::{Inspected, InspectedColumn, InspectedRecording, InspectedTable};

/// Number of columns shown for a table.
const SHOWN: usize = 40;
/// Longest name shown, in characters.
const NAME: usize = 36;
/// Number of comments shown, and the characters of each. Convention: a preamble in half a screen.
const COMMENTS: usize = 8;
const COMMENT: usize = 120;

/// All lines about a file.
pub fn of(file: &Inspected) -> String {
    let mut lines = vec![format!("{}: {}", file.file.display(), file.file_format)];
    for table in &file.tables {
        lines.extend(of_table(table));
    }
    let comments = file.comments.iter().take(COMMENTS);
    lines.extend(comments.map(|comment| format!("  comment: {}", cut(comment, COMMENT))));
    if file.comments.len() > COMMENTS {
        let more = file.comments.len() - COMMENTS;
        lines.push(format!("  and {more} more comments; --json has all"));
    }
    if let Some(recording) = &file.recording {
        lines.push(of_recording(recording));
        lines.extend(
            recording
                .faults
                .iter()
                .map(|fault| format!("  warning: {fault}")),
        );
    }
    lines.extend(file.notes.iter().map(|note| format!("  note: {note}")));
    lines.extend(
        file.questions
            .iter()
            .map(|question| format!("  question: {question}")),
    );
    if file.problem.is_some() {
        // The file must be corrected before a trace.
        return lines.join("\n");
    }
    let how = if file.questions.is_empty() {
        "next"
    } else {
        "next; replace the words in capitals by your answers"
    };
    lines.push(format!("  {how}: {}", file.command));
    lines.join("\n")
}

fn of_table(table: &InspectedTable) -> Vec<String> {
    let name = if table.name.is_empty() {
        String::new()
    } else {
        format!("table {}: ", table.name)
    };
    let rows = table
        .rows
        .map_or_else(String::new, |rows| format!(", {rows} rows"));
    let plural = if table.columns.len() == 1 { "" } else { "s" };
    let mut lines = vec![format!(
        "  {name}{} column{plural}{rows}",
        table.columns.len()
    )];
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
        lines.push(format!(
            "    {}  {}  {}  {taken}",
            padded(name, widths[0]),
            padded(values, widths[1]),
            padded(range, widths[2])
        ));
    }
    if table.columns.len() > SHOWN {
        lines.push(format!(
            "    and {} more; --json has all",
            table.columns.len() - SHOWN
        ));
    }
    lines.extend(
        table
            .skipped
            .iter()
            .map(|what| format!("    not read: {what}")),
    );
    lines
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
        column.taken_for.clone(),
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

/// The probable meaning of a column, or the reason why it has none, by its name and first values. While a question is open, no column
/// is used yet.
pub fn why_not(column: &Column, is_open: bool) -> String {
    let why = match columns::described(column) {
        Some(what) if is_open => return format!("could be {what}"),
        Some(what) => return format!("could be {what}; not used"),
        None if !column.is_numeric => "it holds text",
        None => "its name does not match any channel",
    };
    if is_open {
        why.into()
    } else {
        format!("not used: {why}")
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

/// A text in one line, of at most `longest` characters.
fn cut(text: &str, longest: usize) -> String {
    let text: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().count() <= longest {
        return text;
    }
    text.chars().take(longest - 1).chain(['…']).collect()
}
