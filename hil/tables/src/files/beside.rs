//! Numbers stored next to arrays in a file: rates, which give arrays without times a clock, and factors that might have to be
//! applied.

use super::Reading;
use super::groups::{Group, Groups};
use super::number::shown;
use super::table::StatedStep;
use crate::budget::{Budget, of_text};
use crate::columns::each_word;
use mesh_damper_output::error::InputError;

/// A statement next to arrays about those below a group, or about one of them.
#[derive(Clone, Debug)]
pub(super) struct Stated<T> {
    pub at: Group,
    pub what: T,
    /// Whether it lies in a group without arrays, whose name does not say that it describes those around it.
    pub is_apart: bool,
}

impl<T> Stated<T> {
    /// Makes it a statement about the nearest of the groups `around` it.
    pub fn spread(&mut self, groups: &Groups, around: &[bool]) {
        for group in groups.upward(self.at) {
            self.at = group;
            if group == Group::FILE || around[group.index()] {
                return;
            }
            let name = groups.name(group);
            self.is_apart |= !ABOUT.iter().any(|about| name.eq_ignore_ascii_case(about));
        }
    }
}

/// The statements next to the arrays of a file, as they are read.
#[derive(Clone, Debug, Default)]
pub(super) struct Beside {
    pub rates: Vec<Stated<StatedStep>>,
    pub notes: Vec<Stated<String>>,
    /// Whether the user states the source of the times.
    pub is_said: bool,
}

/// Words of a name for samples per second, and for the time between two, without signs and in lower case; a unit may follow.
const RATES: &[&str] = &[
    "fs",
    "samplerate",
    "samplingrate",
    "samplefrequency",
    "samplingfrequency",
    "samplefreq",
    "samplingfreq",
    "scanrate",
    "samplespersecond",
    "abtastrate",
    "abtastfrequenz",
];
const STEPS: &[&str] = &[
    "dt",
    "deltat",
    "timestep",
    "sampletime",
    "samplingtime",
    "sampleinterval",
    "samplinginterval",
    "sampleperiod",
    "samplingperiod",
    "abtastzeit",
];
/// MATLAB's usual name for the time between two samples. It is also that of a temperature, and of the step of a slow controller.
const TS: &str = "ts";
/// The steps that such a number may give, s. Convention: no damper is tested with so few samples, and few temperatures are so low.
const LONGEST_TS: f64 = 0.1;
/// Names of groups that describe what lies beside them.
const ABOUT: &[&str] = &[
    "meta",
    "metadata",
    "header",
    "info",
    "attributes",
    "attrs",
    "properties",
];
/// Units after them, the first if none is stated.
const OF_RATES: &[(&str, &str, f64)] = &[("", "Hz", 1.0), ("hz", "Hz", 1.0), ("khz", "kHz", 1e3)];
const OF_STEPS: &[(&str, &str, f64)] = &[
    ("", "s", 1.0),
    ("s", "s", 1.0),
    ("sec", "s", 1.0),
    ("ms", "ms", 1e-3),
    ("us", "us", 1e-6),
];
/// Letters of a name that are compared with these: more than the longest of them has with its unit.
const LONGEST: usize = 64;
/// Words of a name for a factor or an addend of measured values.
const FACTORS: &[&str] = &[
    "scale",
    "scaling",
    "gain",
    "factor",
    "multiplier",
    "slope",
    "sensitivity",
    "calibration",
];
const ADDENDS: &[&str] = &["offset", "bias", "intercept", "zero", "tare"];

const PART: &str = "what is stated beside its arrays";

impl Beside {
    /// Applies the user's settings for the file: a rate or the column of times has precedence over stored statements.
    pub fn heed(&mut self, reading: &Reading) {
        let has_times = || reading.channels.iter().any(|(of, _)| of == "time");
        self.is_said = reading.rate.is_some() || has_times();
    }

    /// Takes a number called `name`, which is a statement about all below `at`; returns whether it is relevant for a recording. `of`
    /// is its name in messages: `attribute fs of force`.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn number(
        &mut self,
        at: Group,
        name: &str,
        of: &str,
        value: f64,
        budget: &Budget,
    ) -> Result<bool, InputError> {
        let plain: String = (name.chars().filter(|c| c.is_alphanumeric()))
            .flat_map(char::to_lowercase)
            .take(LONGEST)
            .collect();
        let unit = |words: &[&str], units: &[(&str, &'static str, f64)]| {
            let rest = words.iter().find_map(|word| {
                let rest = plain.strip_prefix(word)?;
                units.iter().find(|(unit, ..)| *unit == rest)
            })?;
            Some((rest.1, rest.2))
        };
        let is_usable = value.is_finite() && value > 0.0;
        let rate = unit(RATES, OF_RATES).map(|(unit, scale)| (unit, 1.0 / (value * scale)));
        let step = || unit(STEPS, OF_STEPS).map(|(unit, scale)| (unit, value * scale));
        let short = || {
            let begins = name.get(..TS.len())?.eq_ignore_ascii_case(TS);
            let (unit, scale) = unit(&[TS], OF_STEPS).filter(|_| begins)?;
            Some((unit, value * scale)).filter(|(_, step)| *step <= LONGEST_TS)
        };
        let found = rate.or_else(step).or_else(short);
        if let Some((unit, step)) = found.filter(|_| is_usable) {
            let taken = [of, " = ", &shown(value), " ", unit].concat();
            budget.hold(of_text(taken.len()), PART)?;
            let stated = Stated {
                at,
                what: StatedStep { step, taken },
                is_apart: false,
            };
            budget.push(&mut self.rates, stated, PART)?;
            return Ok(true);
        }
        let (mut is_factor, mut is_addend) = (false, false);
        each_word(name, |word| {
            is_factor |= FACTORS.contains(&word);
            is_addend |= ADDENDS.contains(&word);
        });
        let is_neutral = value.is_nan() || (is_factor && value == 1.0) || value == 0.0;
        let is_one = is_factor || is_addend;
        if is_one && !is_neutral {
            let said = [of, " = ", &shown(value), " is not applied"];
            self.note(at, said.concat(), budget)?;
        }
        Ok(is_one)
    }

    /// Stores a sentence about all below `at`.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn note(&mut self, at: Group, what: String, budget: &Budget) -> Result<(), InputError> {
        budget.hold(of_text(what.len()), PART)?;
        let stated = Stated {
            at,
            what,
            is_apart: false,
        };
        budget.push(&mut self.notes, stated, PART)
    }
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use super::*;
    use crate::budget::Budget;
    use crate::files::about::About;
    use crate::read_limit::ReadLimit;

    fn groups() -> Groups {
        Groups::new(Rc::new(Budget::new("a.h5", ReadLimit::default())))
    }

    #[test]
    fn a_rate_counts_by_its_name_and_its_unit() {
        for (name, value, step) in [
            ("fs", 80.0, Some(0.0125)),
            ("Fs", 80.0, Some(0.0125)),
            ("sample_rate", 80.0, Some(0.0125)),
            ("Sampling rate [kHz]", 2.0, Some(5e-4)),
            ("dt", 0.0125, Some(0.0125)),
            ("dt_ms", 12.5, Some(0.0125)),
            ("Ts", 0.005, Some(0.005)),
            ("TS", 0.005, Some(0.005)),
            ("Ts_ms", 5.0, Some(0.005)),
            // Temperatures, and the time of a sample.
            ("Ts", 293.15, None),
            ("Ts_C", 0.05, None),
            ("t_s", 0.005, None),
            ("Sample interval (s)", 0.5, Some(0.5)),
            // Words that say only that it is a rate, and words for other numbers.
            ("rate", 80.0, None),
            ("offset", 80.0, None),
            ("fsr", 80.0, None),
            ("fs", 0.0, None),
            ("fs", f64::NAN, None),
        ] {
            let groups = groups();
            let mut beside = Beside::default();
            let budget = groups.budget();
            (beside.number(Group::FILE, name, name, value, budget)).unwrap();
            let arrays = [(Group::FILE, "force")];
            let mut about = About::of(beside, &groups, arrays.into_iter());
            let clock = about.clock(&arrays).unwrap().0;
            assert_eq!(clock.map(|clock| clock.step), step, "{name}");
        }
    }

    #[test]
    fn what_is_not_applied_is_said() {
        let said = |name: &str, value: f64| {
            let groups = groups();
            let mut beside = Beside::default();
            let is_one = beside.number(Group::FILE, name, name, value, groups.budget());
            let arrays = [(Group::FILE, "force")];
            let about = About::of(beside, &groups, arrays.into_iter());
            (is_one.unwrap(), about.notes(&arrays).unwrap())
        };
        for name in ["gain", "scale", "force_scale", "forceOffset", "Cal factor"] {
            assert_eq!(
                said(name, 2.5),
                (true, vec![format!("{name} = 2.5 is not applied")])
            );
        }
        assert_eq!(said("gain", 1.0), (true, Vec::new()));
        assert_eq!(said("offset", 0.0), (true, Vec::new()));
        assert_eq!(said("mass", 2.5), (false, Vec::new()));
    }
}
