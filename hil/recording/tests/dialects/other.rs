//! Answers to a question that are not the right one.
//!
//! What a file does not say, nobody can refuse: a force of no unit is read in kN if the user says so. But an answer changes what it is
//! about and nothing else, and one that the file contradicts is refused.

use mesh_damper_recording::files::Reading;

use super::corpus::{Column, Dialect, SAMPLES, channels, is_channel_true, read, say};

/// The options that a message has to be typed.
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
    // It stands for what the user has to fill in.
    each.filter(|option| !option.ends_with("=NAME")).collect()
}

/// Whether another option than the right one is refused, or changes what it is about alone.
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
    // The questions that are left are answered rightly.
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
            // Whatever the column holds.
            Some("--channel") => is_about,
            Some("--unit") => is_about && factor(name, values, column).is_some(),
            // A sign that divides thousands takes three digits.
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

/// By what the values differ from the true ones, where that is one factor.
fn factor(name: &str, values: &[f64], column: Column) -> Option<f64> {
    // Times may be given from the first on.
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
