//! What `hil inspect` prints.

use mesh_damper_recording::columns;
use mesh_damper_recording::error::InputError;
use mesh_damper_recording::files::Column;

use super::inspect::{Inspected, InspectedColumn, InspectedRecording, InspectedTable};

/// Columns that are shown of a table.
const SHOWN: usize = 40;
/// Characters of a name, and of first values.
const NAME: usize = 36;

/// Everything about a file.
pub fn of(file: &Inspected) -> String {
    let mut lines = vec![format!("{}: {}", file.file.display(), file.file_format)];
    for table in &file.tables {
        lines.extend(of_table(table));
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
        // It is mended before anything is traced.
        return lines.join("\n");
    }
    let how = if file.questions.is_empty() {
        "next"
    } else {
        "next, with the options that answer the questions above"
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

/// Name with unit, first values, range and meaning of a column.
fn cells(column: &InspectedColumn) -> [String; 4] {
    let unit = column
        .unit
        .as_ref()
        .map_or_else(String::new, |unit| format!(" [{unit}]"));
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
        cut(&format!("{}{unit}", column.name)),
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
    let range =
        |[least, most]: [f64; 2], unit: &str| format!("{} to {} {unit}", short(least), short(most));
    let controls = if recording.controls.is_empty() {
        String::new()
    } else {
        format!("; control inputs {}", recording.controls.join(", "))
    };
    format!(
        "  recording: {} samples from {} to {} s, {rate}; displacement {}; force {}{controls}",
        recording.samples,
        short(first),
        short(last),
        range(recording.displacement_mm, "mm"),
        range(recording.force_kn, "kN")
    )
}

/// Why a column is not used, as far as its name and its first values say.
pub fn why_not(column: &Column) -> String {
    match columns::described(column) {
        Some(what) => format!("could be {what}; not used"),
        None if !column.is_numeric => "not used: it holds text".into(),
        None => "not used: its name names no channel".into(),
    }
}

/// A question without the name of the file.
pub fn question(error: &InputError) -> String {
    let line = error.to_string();
    let named = format!("{}: ", error.source_name);
    line.strip_prefix(&named).unwrap_or(&line).to_owned()
}

/// The first option that a text offers, with its value.
pub fn first_option(text: &str) -> Option<String> {
    let begin = text.find("--")?;
    let option = &text[begin..];
    let mut is_quoted = false;
    let mut blanks = 0;
    let end = option.find(|c: char| {
        is_quoted ^= c == '\'';
        blanks += usize::from(c == ' ' && !is_quoted);
        !is_quoted && (blanks == 2 || c == ',' || c == ';')
    });
    let option = option[..end.unwrap_or(option.len())].trim_end();
    // A value that nobody but the user knows.
    Some(match option {
        "--rate" => "--rate HZ".into(),
        "--table" => "--table NAME".into(),
        _ => option.to_owned(),
    })
}

/// A number to six digits.
fn short(value: f64) -> String {
    mesh_damper_recording::decimal((format!("{value:.5e}")).parse().unwrap_or(value))
}

fn cut(name: &str) -> String {
    let name: String = name
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if name.chars().count() <= NAME {
        return name;
    }
    name.chars().take(NAME - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_option_of_a_message_is_one_to_type() {
        for (text, is) in [
            (
                "say which: --channel force='Force 1, N' or --channel force=x",
                Some("--channel force='Force 1, N'"),
            ),
            (
                "use one of a, or give it: --unit time=s or --unit time=ms; units are s",
                Some("--unit time=s"),
            ),
            ("give the samples a second with --rate", Some("--rate HZ")),
            ("give the name of one with --table", Some("--table NAME")),
            (
                "say: --decimal point or --decimal comma",
                Some("--decimal point"),
            ),
            ("mend it", None),
        ] {
            assert_eq!(first_option(text).as_deref(), is, "{text}");
        }
    }
}
