//! Statements of a text above its table: keys with values, one of which may be the sampling rate.

use mesh_damper_output::error::{InputError, Place, quoted};

use super::lines::{Cells, Separator};
use super::numbers::{Cell, Numbers};
use super::rows::{Row, RowKind};
use crate::budget::Budget;
use crate::files::table::Clock;
use crate::room::Room;

/// Bytes held for a line of a preamble, and for a byte of it while it is divided and put together again.
const OF_COMMENT: u64 = 2 * size_of::<Comment>() as u64;
const OF_BYTE: u64 = 4;

/// A line of a preamble.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Comment {
    pub line: u64,
    /// `key: value`, or the text of a comment.
    pub text: String,
}

/// Words for the sampling rate.
const RATES: [&str; 26] = [
    "sample rate",
    "sampling rate",
    "samplerate",
    "sampling frequency",
    "sample frequency",
    "scan rate",
    "acquisition rate",
    "data rate",
    "abtastrate",
    "abtastfrequenz",
    "messfrequenz",
    "messrate",
    "samplingrate",
    "fréquence d'échantillonnage",
    "fréquence d'acquisition",
    "frecuencia de muestreo",
    "frequenza di campionamento",
    "bemonsteringsfrequentie",
    "samplingsfrekvens",
    "częstotliwość próbkowania",
    "частота дискретизации",
    "采样频率",
    "采样率",
    "サンプリング周波数",
    "サンプリングレート",
    "fs",
];
/// Words for the time between samples.
const STEPS: [&str; 20] = [
    "sample interval",
    "sampling interval",
    "sample period",
    "sampling period",
    "sample time",
    "sampling time",
    "time step",
    "timestep",
    "time increment",
    "delta t",
    "delta_t",
    "dt",
    "abtastintervall",
    "abtastzeit",
    "période d'échantillonnage",
    "periodo de muestreo",
    "periodo di campionamento",
    "период дискретизации",
    "采样间隔",
    "サンプリング間隔",
];
/// Units of rates in Hz.
const HERTZ: [(&str, f64); 12] = [
    ("hz", 1.0),
    ("khz", 1e3),
    ("mhz", 1e6),
    ("s/s", 1.0),
    ("sa/s", 1.0),
    ("samples/s", 1.0),
    ("samples/sec", 1.0),
    ("samples per second", 1.0),
    ("sps", 1.0),
    ("1/s", 1.0),
    ("гц", 1.0),
    ("ks/s", 1e3),
];
/// Units of times in s.
const SECONDS: [(&str, f64); 9] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("msec", 1e-3),
    ("µs", 1e-6),
    ("μs", 1e-6),
    ("us", 1e-6),
    ("с", 1.0),
];

/// The statements of the rows above the header, or above the numbers at `first`.
///
/// # Errors
/// The budget has no room for them.
pub(super) fn of(
    rows: &[Row],
    header: Option<u64>,
    first: usize,
    separator: Separator,
    budget: &Budget,
) -> Result<Vec<Comment>, InputError> {
    const PART: &str = "its comments";
    let above = rows[..first]
        .iter()
        .take_while(|row| header.is_none_or(|line| row.line < line));
    let mut comments = Vec::new();
    for row in above {
        let mut room = Room::of(budget);
        room.more(OF_BYTE * row.text.len() as u64, PART)?;
        let said = match row.kind {
            RowKind::Blank => None,
            RowKind::Comment => Some(row.text.to_owned()),
            RowKind::Cells => {
                let mut cells = Cells::of(budget);
                declared(row.text, cells.split(separator, row.text)?, separator)
            }
        };
        let Some(said) = said else { continue };
        let mut text = String::with_capacity(said.len());
        for word in said.split_whitespace() {
            text.extend((!text.is_empty()).then_some(' '));
            text.push_str(word);
        }
        if !text.is_empty() {
            budget.hold(OF_COMMENT + text.len() as u64, PART)?;
            let line = row.line;
            comments.push(Comment { line, text });
        }
    }
    Ok(comments)
}

/// A key and its value, in separate cells or with a sign between them.
fn declared(text: &str, cells: &[&str], separator: Separator) -> Option<String> {
    let mut cells = cells.iter().copied().filter(|cell| !cell.is_empty());
    let is_key =
        |key: &str| key.chars().any(char::is_alphabetic) && (1..=60).contains(&key.chars().count());
    if separator != Separator::Blanks
        && let Some(key) = cells.next()
        && let Some(value) = cells.next()
    {
        let key = key.trim_end_matches([':', '=']).trim();
        if is_key(key) && !key.contains([':', '=']) {
            let mut said = format!("{key}: {value}");
            for more in cells {
                said.push(' ');
                said.push_str(more);
            }
            return Some(said);
        }
    }
    let text = text.trim().trim_matches('"');
    let (key, value) = text.split_once([':', '='])?;
    let (key, value) = (key.trim(), value.trim());
    (is_key(key) && !value.is_empty()).then(|| format!("{key}: {value}"))
}

/// Relative difference within which two rates are the same. Convention: steps are written to three digits at least.
const SAME: f64 = 1e-3;

/// The clock in the comments, with the unit of its number, and the comment that states it.
///
/// # Errors
/// Two comments with different rates.
pub(super) fn clock(
    name: &str,
    comments: &[Comment],
    numbers: Numbers,
) -> Result<Option<(Clock, String)>, InputError> {
    let given = comments
        .iter()
        .filter_map(|comment| Some((comment, step(&comment.text, numbers)?)));
    let given: Vec<(&Comment, f64)> = given.collect();
    let Some(&(comment, step)) = given.first() else {
        return Ok(None);
    };
    let is_other = |(_, other): &&(&Comment, f64)| (other / step - 1.0).abs() > SAME;
    if let Some((other, second)) = given.iter().find(is_other) {
        let rate = |step: f64| format!("--rate {}", (1e6 / step).round() / 1e6);
        return Err(InputError::new(
            name,
            format!(
                "no column has the times, and {} gives another rate than {} in line {}",
                quoted(&comment.text),
                quoted(&other.text),
                other.line
            ),
            format!(
                "say which one is the sampling rate: {} or {}",
                rate(step),
                rate(*second)
            ),
        )
        .at(Place::Line(comment.line)));
    }
    let said = format!(
        "no column has the times; the step of {step} s is from line {}, {}",
        comment.line,
        quoted(&comment.text)
    );
    Ok(Some((Clock { start: 0.0, step }, said)))
}

/// Seconds between samples, of `Sample Rate [Hz]: 1000` and the like.
fn step(comment: &str, numbers: Numbers) -> Option<f64> {
    let (key, value) = comment.split_once([':', '='])?;
    let key = key.trim().to_lowercase();
    let (bare, unit) = match key.find(['[', '(']) {
        Some(at) => (
            key[..at].trim(),
            Some(key[at..].trim_matches(|c| "[]() ".contains(c))),
        ),
        None => (key.as_str(), None),
    };
    let value = value.trim();
    let end = value
        .find(|c: char| !(c.is_ascii_digit() || "+-.,eE".contains(c)))
        .unwrap_or(value.len());
    let (number, behind) = value.split_at(end);
    let Cell::Number(number) = numbers.read(number) else {
        return None;
    };
    let behind = behind
        .trim()
        .trim_matches(|c| "[]()".contains(c))
        .to_lowercase();
    let unit = if behind.is_empty() { unit? } else { &behind };
    let of = |units: &[(&str, f64)]| {
        let known = units.iter().find(|(name, _)| *name == unit);
        known.map(|&(_, scale)| scale)
    };
    let step = if RATES.contains(&bare) {
        1.0 / (number * of(&HERTZ)?)
    } else if STEPS.contains(&bare) {
        number * of(&SECONDS)?
    } else {
        return None;
    };
    (step.is_finite() && step > 0.0).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_needs_its_unit() {
        for (comment, is) in [
            ("Sample Rate: 1000 Hz", Some(1e-3)),
            ("sampling rate [kHz]: 2", Some(5e-4)),
            ("Abtastrate: 500 Hz", Some(2e-3)),
            ("dt = 0.002 s", Some(2e-3)),
            ("Sample interval: 4 ms", Some(4e-3)),
            ("Sample Rate: 1000", None),
            ("Heart rate: 100 Hz", None),
            ("Sample Rate: 0 Hz", None),
            ("Time: 12:00", None),
        ] {
            let found = step(comment, Numbers::POINT);
            let is_same = match (found, is) {
                (Some(found), Some(is)) => (found / is - 1.0_f64).abs() < 1e-12,
                (found, is) => found == is,
            };
            assert!(is_same, "{comment}: {found:?}");
        }
    }

    #[test]
    fn keys_and_values_are_found_in_cells_and_in_text() {
        for (text, separator, is) in [
            ("Operator;Smith;", ';', Some("Operator: Smith")),
            ("Operator: Smith, John", ',', Some("Operator: Smith, John")),
            (
                "Data Acquisition\t\tTime:\t4\tSec",
                '\t',
                Some("Data Acquisition: Time: 4 Sec"),
            ),
            ("Specimen = ring 3", '\t', Some("Specimen: ring 3")),
            ("\"Rate\",\"10\"", ',', Some("Rate: 10")),
            ("a title", ';', None),
        ] {
            let separator = Separator::Sign(separator);
            let mut cells = Vec::new();
            separator.split(text, &mut cells);
            let found = declared(text, &cells, separator);
            assert_eq!(found.as_deref(), is, "{text}");
        }
    }
}
