//! Compares the times of a recording with the rates that its file states.

use mesh_damper_output::error::quoted;
use mesh_damper_tables::files::table::StatedStep;
use mesh_damper_tables::units::{self, Unit};

/// Relative difference of two steps of the same clock. Convention: a nominal rate is met to a percent.
const SAME: f64 = 0.01;

/// The source of a recording's times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Times<'a> {
    /// A column with this name, in this unit.
    Column(&'a str, Unit, Certain),
    /// A rate that the user gives.
    Given,
    /// A clock of the file.
    File,
}

/// What makes the unit of a column of times certain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Certain {
    /// Nothing: `--unit` may give another.
    No,
    /// A name of our own form, which `--unit` may not contradict: `time_s`.
    Name,
    /// It holds dates or times of day.
    Dates,
}

/// A sentence about a stated step that differs from that of the times in `time`, s. Both are stated about the same samples, so one of
/// them is wrong; the sentence says which is used, and the unit of time with which both would agree, if there is one.
pub(super) fn contradiction(
    stated: &[StatedStep],
    time: &[f64],
    source: Times<'_>,
) -> Option<String> {
    if stated.is_empty() || source == Times::File {
        return None;
    }
    let usual = usual_step(time)?;
    let is_same = |step: f64, other: f64| (step / other - 1.0).abs() <= SAME;
    let other = stated.iter().find(|other| !is_same(usual, other.step))?;
    let (taken, stated) = (&other.taken, other.step);
    match source {
        Times::Column(name, unit, certain) => {
            let agrees = |other: &&Unit| is_same(usual / unit.scale * other.scale, stated);
            let other = units::TIME.iter().find(agrees).map(|unit| unit.symbol);
            let how = other.and_then(|symbol| match certain {
                Certain::No => Some(format!("{symbol}: --unit time={symbol}")),
                Certain::Name => Some(format!("{symbol}: rename the column to time_{symbol}")),
                Certain::Dates => None,
            });
            let remedy = how.map_or_else(String::new, |how| {
                format!("; they would agree if the times were in {how}")
            });
            let (name, unit) = (quoted(name), unit.symbol);
            Some(format!(
                "the times are those of column {name} in {unit}; {taken} contradicts them and is not used{remedy}"
            ))
        }
        _ => Some(format!(
            "the times are computed from --rate; {taken} contradicts it and is not used"
        )),
    }
}

/// The median of the steps from one time to the next.
fn usual_step(time: &[f64]) -> Option<f64> {
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    Some(*steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(time: &[f64], source: Times<'_>) -> Option<String> {
        let taken = "fs = 200 Hz".to_owned();
        contradiction(&[StatedStep { step: 0.005, taken }], time, source)
    }

    fn times(step: f64) -> Vec<f64> {
        (0..50).map(|n| step * f64::from(n)).collect()
    }

    #[test]
    fn a_stated_rate_is_compared_with_times_in_their_unit() {
        let seconds = Times::Column("t", units::TIME[0], Certain::No);
        for step in [0.005, 0.00501] {
            assert_eq!(said(&times(step), seconds), None, "{step}");
        }
        for step in [0.002, 0.0051] {
            let said = said(&times(step), seconds).unwrap();
            let end = "column \"t\" in s; fs = 200 Hz contradicts them and is not used";
            assert!(said.ends_with(end), "{said}");
        }
        assert_eq!(said(&[], seconds), None);
        assert_eq!(said(&[0.0], seconds), None);
    }

    #[test]
    fn a_ratio_of_two_units_of_time_names_the_other_unit() {
        let symbol = |unit: &str| *units::TIME.iter().find(|each| each.symbol == unit).unwrap();
        for (taken, step, other) in [("s", 5.0, "ms"), ("ms", 5e-6, "s"), ("s", 5000.0, "us")] {
            let of =
                |certain| said(&times(step), Times::Column("t", symbol(taken), certain)).unwrap();
            let (free, named, dates) = (of(Certain::No), of(Certain::Name), of(Certain::Dates));
            assert!(free.ends_with(&format!(": --unit time={other}")), "{free}");
            let rename = format!(": rename the column to time_{other}");
            assert!(named.ends_with(&rename), "{named}");
            assert!(dates.ends_with("is not used"), "{dates}");
        }
    }

    #[test]
    fn a_rate_that_is_given_is_compared_too() {
        assert_eq!(said(&times(0.005), Times::Given), None);
        let said_of = said(&times(0.001), Times::Given).unwrap();
        assert!(
            said_of.contains("--rate; fs = 200 Hz contradicts it"),
            "{said_of}"
        );
        // A clock of the file is made of its statements.
        assert_eq!(said(&times(0.001), Times::File), None);
    }
}
