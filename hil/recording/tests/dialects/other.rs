//! Wrong answers to a question.
//!
//! If a file lacks some information, the reader cannot refuse an answer: a force without a unit is read in kN if the user says so.
//! But an answer changes only its own subject, and an answer that contradicts the file is refused.

use mesh_damper_tables::files::Reading;

use super::corpus::{Column, Dialect, SAMPLES, channels, is_channel_true, read, say};

/// The options that a message offers to type.
pub fn offered(error: &str) -> Vec<String> {
    let begins = ["--channel ", "--unit ", "--decimal "];
    let places = begins.into_iter().flat_map(|option| {
        let places = error.match_indices(option);
        places.map(move |(at, _)| (option, &error[at + option.len()..]))
    });
    let each = places.map(|(option, rest)| {
        let end = match rest.split_once("='") {
            Some((quantity, name)) if !quantity.contains([' ', ';', ',']) => {
                let length = name.find('\'').unwrap_or(name.len());
                quantity.len() + 2 + length + 1
            }
            _ => rest.find([' ', ';', ',']).unwrap_or(rest.len()),
        };
        format!("{option}{}", &rest[..end])
    });
    // A placeholder that the user has to fill in.
    each.filter(|option| !option.ends_with("=NAME")).collect()
}

/// Whether an option other than the right one is refused, or changes only its own subject.
pub fn check(
    dialect: &Dialect,
    before: &Reading,
    right: &[&'static str],
    other: &str,
) -> Result<(), String> {
    let mut said = before.clone();
    say(&mut said, other);
    let about = |option: &str| {
        option
            .split_once('=')
            .map_or("", |(about, _)| about)
            .to_owned()
    };
    // The remaining questions get the right answers.
    let mut left = right.iter().filter(|option| about(option) != about(other));
    let recording = loop {
        match (read(&dialect.bytes, &said), left.next()) {
            (Ok(recording), _) => break recording,
            (Err(_), None) => return Ok(()),
            (Err(_), Some(option)) => say(&mut said, option),
        }
    };
    if recording.len() != SAMPLES {
        return Err(format!(
            "with {other}: {} samples of {SAMPLES}",
            recording.len()
        ));
    }
    for ((name, values), column) in channels(&recording).into_iter().zip(dialect.columns) {
        let Err(why) = is_channel_true(name, values, column) else {
            continue;
        };
        let is_about = other.contains(&format!(" {name}="));
        let is_as_said = match other.split(' ').next() {
            // For any content of the column.
            Some("--channel") => is_about,
            Some("--unit") => is_about && factor(name, values, column).is_some(),
            // A thousands separator needs three digits.
            _ => {
                factor(name, values, column).is_some_and(|factor| (factor / 1e3 - 1.0).abs() < 1e-2)
            }
        };
        if !is_as_said {
            return Err(format!("with {other}: {why}"));
        }
    }
    Ok(())
}

/// The factor between the values and the true ones, if there is a single one.
fn factor(name: &str, values: &[f64], column: Column) -> Option<f64> {
    // Times may count from the first sample.
    let (first, begin) = match name {
        "time" => (values[0], (column.values)(0)),
        _ => (0.0, 0.0),
    };
    let mut pairs = (values.iter().enumerate())
        .map(|(index, value)| (value - first, (column.values)(index) - begin));
    let (value, truth) = pairs
        .clone()
        .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
    let factor = value / truth;
    let allowed = factor.abs() * (4.0 * column.rounding() + 1e-9);
    pairs
        .all(|(value, truth)| (value - factor * truth).abs() <= allowed)
        .then_some(factor)
}
