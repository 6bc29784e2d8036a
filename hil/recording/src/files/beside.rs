//! Numbers stored next to arrays in a file: rates, which give arrays without times a clock, and factors that might have to be
//! applied.

use super::Reading;
use super::table::Clock;

/// Statement of a number next to arrays about those below a path.
#[derive(Clone, Debug)]
struct Said<T> {
    path: Vec<String>,
    what: T,
}

/// Samples per second or the time between two, as stated in a file.
#[derive(Clone, Debug)]
struct Rate {
    step: f64,
    /// Its interpretation, in words.
    taken: String,
}

/// The statements next to the arrays of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Beside {
    rates: Vec<Said<Rate>>,
    notes: Vec<Said<String>>,
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
        if let Some((unit, step)) = rate.or_else(step).filter(|_| is_usable) {
            let what = Rate {
                step,
                taken: format!("{of} = {value} {unit}"),
            };
            let path = path.to_vec();
            self.rates.push(Said { path, what });
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
        let path = path.to_vec();
        self.notes.push(Said { path, what });
    }

    /// The sentences about some arrays, each given by its path.
    pub fn notes(&self, arrays: &[Vec<String>]) -> Vec<String> {
        let is_of = |said: &&Said<String>| arrays.iter().any(|array| array.starts_with(&said.path));
        let mut notes: Vec<String> = Vec::new();
        for said in self.notes.iter().filter(is_of) {
            if !notes.contains(&said.what) {
                notes.push(said.what.clone());
            }
        }
        notes
    }

    /// The rates stated for some arrays, in words, for recordings with other times.
    pub fn rates(&self, arrays: &[Vec<String>]) -> impl Iterator<Item = String> {
        let is_of = |said: &&Said<Rate>| arrays.iter().any(|array| array.starts_with(&said.path));
        let each = self.rates.iter().filter(is_of);
        each.map(|said| said.what.taken.clone())
    }

    /// The clock of arrays without times, by the rate nearest to each of them, and a sentence about it.
    pub fn clock(&self, arrays: &[Vec<String>]) -> (Option<Clock>, Option<String>) {
        if self.is_said {
            return (None, None);
        }
        let mut found: Vec<&Rate> = Vec::new();
        for array in arrays {
            let of_array = || {
                let all = self.rates.iter();
                all.filter(|said| array.starts_with(&said.path))
            };
            let Some(most) = of_array().map(|said| said.path.len()).max() else {
                return (None, None);
            };
            let near = of_array().filter(|said| said.path.len() == most);
            found.extend(near.map(|said| &said.what));
        }
        let Some(first) = found.first() else {
            return (None, None);
        };
        // A rate and a step of the same clock differ in the last digits.
        let is_other = |rate: &&&Rate| (rate.step / first.step - 1.0).abs() > 1e-9;
        if let Some(other) = found.iter().find(is_other) {
            let said = format!(
                "{} and {} give different rates, so neither is used; give one with --rate",
                first.taken, other.taken
            );
            return (None, Some(said));
        }
        let clock = Clock {
            start: 0.0,
            step: first.step,
        };
        let said = format!(
            "there is no time column; the times are computed from {}",
            first.taken
        );
        (Some(clock), Some(said))
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
