//! Numbers stored next to arrays in a file: rates, which give arrays without times a clock, and factors that might have to be
//! applied.

use std::collections::HashSet;

use super::Reading;
use super::table::{Clock, StatedStep};

/// A statement next to arrays about those below a path.
#[derive(Clone, Debug)]
struct Stated<T> {
    path: Vec<String>,
    what: T,
    /// Whether it lies in a group without arrays, whose name does not say that it describes those around it.
    is_apart: bool,
}

impl<T> Stated<T> {
    fn of(path: &[String], what: T) -> Self {
        Self {
            path: path.to_vec(),
            what,
            is_apart: false,
        }
    }

    /// Makes it a statement about the nearest of the groups `around` it.
    fn spread(&mut self, around: &HashSet<&[String]>) {
        while !around.contains(&self.path[..]) {
            let Some(group) = self.path.pop() else { return };
            self.is_apart |= !ABOUT.contains(&group.to_lowercase().as_str());
        }
    }
}

/// The statements next to the arrays of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Beside {
    rates: Vec<Stated<StatedStep>>,
    notes: Vec<Stated<String>>,
    /// Whether the user states the source of the times.
    is_said: bool,
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

impl Beside {
    /// Applies the user's settings for the file: a rate or the column of times has precedence over stored statements.
    pub fn heed(&mut self, reading: &Reading) {
        let has_times = || reading.channels.iter().any(|(of, _)| of == "time");
        self.is_said = reading.rate.is_some() || has_times();
    }

    /// Takes a number called `name`, which is a statement about all below `path`; returns whether it is relevant for a recording.
    /// `of` is its name in messages: `attribute fs of force`.
    pub fn number(&mut self, path: &[String], name: &str, of: &str, value: f64) -> bool {
        let plain: String = (name.chars().filter(|c| c.is_alphanumeric()))
            .flat_map(char::to_lowercase)
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
            let what = StatedStep {
                step,
                taken: format!("{of} = {value} {unit}"),
            };
            self.rates.push(Stated::of(path, what));
            return true;
        }
        let words = words(name);
        let says = |known: &[&str]| words.iter().any(|word| known.contains(&word.as_str()));
        let is_neutral = value.is_nan() || (says(FACTORS) && value == 1.0) || value == 0.0;
        let is_one = says(FACTORS) || says(ADDENDS);
        if is_one && !is_neutral {
            self.note(path, format!("{of} = {value} is not applied"));
        }
        is_one
    }

    /// Stores a sentence about all below `path`.
    pub fn note(&mut self, path: &[String], what: String) {
        self.notes.push(Stated::of(path, what));
    }

    /// The same statements, where those in a group without arrays are about the arrays around it.
    pub fn spread(&self, arrays: &[Vec<String>]) -> Self {
        if self.rates.is_empty() && self.notes.is_empty() {
            return self.clone();
        }
        let mut around: HashSet<&[String]> = HashSet::new();
        for array in arrays {
            around.extend((0..=array.len()).map(|length| &array[..length]));
        }
        let mut all = self.clone();
        all.rates
            .iter_mut()
            .for_each(|stated| stated.spread(&around));
        all.notes
            .iter_mut()
            .for_each(|stated| stated.spread(&around));
        all
    }

    /// The rates nearest to an array.
    fn nearest(&self, array: &[String]) -> impl Iterator<Item = &StatedStep> {
        let about = (self.rates.iter())
            .filter(|stated| !stated.is_apart && array.starts_with(&stated.path));
        let most = about.clone().map(|stated| stated.path.len()).max();
        about
            .filter(move |stated| Some(stated.path.len()) == most)
            .map(|stated| &stated.what)
    }

    /// The steps stated for some arrays, by the rates nearest to each of them.
    pub fn steps(&self, arrays: &[Vec<String>]) -> Vec<StatedStep> {
        let mut steps: Vec<StatedStep> = Vec::new();
        for step in arrays.iter().flat_map(|array| self.nearest(array)) {
            if !steps.contains(step) {
                steps.push(step.clone());
            }
        }
        steps
    }

    fn of(&self, arrays: &[Vec<String>]) -> impl Iterator<Item = &Stated<StatedStep>> {
        let is_of = |stated: &&Stated<StatedStep>| {
            arrays.iter().any(|array| array.starts_with(&stated.path))
        };
        self.rates.iter().filter(is_of)
    }

    /// The sentences about some arrays, each given by its path.
    pub fn notes(&self, arrays: &[Vec<String>]) -> Vec<String> {
        let is_of =
            |stated: &&Stated<String>| arrays.iter().any(|array| array.starts_with(&stated.path));
        let mut notes: Vec<String> = Vec::new();
        for stated in self.notes.iter().filter(is_of) {
            if !notes.contains(&stated.what) {
                notes.push(stated.what.clone());
            }
        }
        notes
    }

    /// The rates stated for some arrays, in words, for recordings with other times.
    pub fn rates(&self, arrays: &[Vec<String>]) -> impl Iterator<Item = String> {
        self.of(arrays).map(|stated| stated.what.taken.clone())
    }

    /// The clock of arrays without times, by the rate nearest to each of them, and a sentence about it.
    pub fn clock(&self, arrays: &[Vec<String>]) -> (Option<Clock>, Option<String>) {
        if self.is_said {
            return (None, None);
        }
        let mut found: Vec<&StatedStep> = Vec::new();
        for array in arrays {
            let before = found.len();
            found.extend(self.nearest(array));
            if found.len() == before {
                return (None, None);
            }
        }
        let Some(first) = found.first() else {
            return (None, None);
        };
        // A rate and a step of the same clock differ in the last digits.
        let is_other = |rate: &&&StatedStep| (rate.step / first.step - 1.0).abs() > 1e-9;
        if let Some(other) = found.iter().find(is_other) {
            let note = format!(
                "{} and {} give different rates, so neither is used; give one with --rate",
                first.taken, other.taken
            );
            return (None, Some(note));
        }
        let clock = Clock {
            start: 0.0,
            step: first.step,
        };
        let note = format!(
            "there is no time column; the times are computed from {}",
            first.taken
        );
        (Some(clock), Some(note))
    }
}

/// The words of a name, in lower case: `forceScale`, `force_scale`.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for c in name.chars() {
        let begins = c.is_uppercase() && before.is_lowercase();
        if !c.is_alphabetic() || begins {
            words.push(String::new());
        }
        if c.is_alphabetic()
            && let Some(word) = words.last_mut()
        {
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> Vec<String> {
        let parts = text.split('/').filter(|part| !part.is_empty());
        parts.map(str::to_owned).collect()
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
            let mut beside = Beside::default();
            beside.number(&[], name, name, value);
            let clock = beside.clock(&[path("force")]).0;
            assert_eq!(clock.map(|clock| clock.step), step, "{name}");
        }
    }

    #[test]
    fn the_nearest_rate_counts_and_two_that_differ_are_said() {
        let mut beside = Beside::default();
        beside.number(&[], "fs", "fs", 100.0);
        beside.number(&path("run"), "fs", "run/fs", 50.0);
        let step = |arrays: &[&str]| {
            let arrays: Vec<Vec<String>> = arrays.iter().map(|array| path(array)).collect();
            let (clock, said) = beside.clock(&arrays);
            (clock.map(|clock| clock.step), said.unwrap_or_default())
        };
        assert_eq!(step(&["force", "disp"]).0, Some(0.01));
        assert_eq!(step(&["run/force", "run/disp"]).0, Some(0.02));
        let (none, said) = step(&["run/force", "disp"]);
        assert!(none.is_none() && said.contains("different rates"), "{said}");
        // The user's setting has precedence.
        let rate = Reading {
            rate: Some(10.0),
            ..Reading::default()
        };
        let channel = Reading {
            channels: vec![("time".into(), "t".into())],
            ..Reading::default()
        };
        for reading in [rate, channel] {
            beside.heed(&reading);
            assert_eq!(beside.clock(&[path("force")]), (None, None));
        }
    }

    #[test]
    fn a_description_beside_the_arrays_is_about_them() {
        let arrays = [path("data/force"), path("data/disp")];
        for (group, step) in [
            ("", Some(0.005)),
            ("data", Some(0.005)),
            ("meta", Some(0.005)),
            ("data/Info", Some(0.005)),
            // The rate of a controller need not be that of the samples.
            ("controller", None),
            ("meta/controller", None),
        ] {
            let mut beside = Beside::default();
            beside.number(&path(group), "fs", "fs", 200.0);
            let beside = beside.spread(&arrays);
            let clock = beside.clock(&arrays).0;
            assert_eq!(clock.map(|clock| clock.step), step, "{group}");
            assert_eq!(beside.rates(&arrays).collect::<Vec<_>>(), ["fs = 200 Hz"]);
        }
    }

    #[test]
    fn the_steps_of_some_arrays_are_those_of_the_nearest_rates() {
        let mut beside = Beside::default();
        beside.number(&[], "fs", "fs", 100.0);
        beside.number(&path("run"), "fs", "run/fs", 50.0);
        let taken = |arrays: &[&str]| -> Vec<String> {
            let arrays: Vec<Vec<String>> = arrays.iter().map(|array| path(array)).collect();
            let steps = beside.steps(&arrays).into_iter();
            steps.map(|step| step.taken).collect()
        };
        assert_eq!(taken(&["run/time", "run/force"]), ["run/fs = 50 Hz"]);
        assert_eq!(taken(&["time", "force"]), ["fs = 100 Hz"]);
        assert_eq!(
            taken(&["run/force", "time"]),
            ["run/fs = 50 Hz", "fs = 100 Hz"]
        );
    }

    #[test]
    fn what_is_not_applied_is_said() {
        let said = |name: &str, value: f64| {
            let mut beside = Beside::default();
            let is_one = beside.number(&[], name, name, value);
            (is_one, beside.notes(&[path("force")]))
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
