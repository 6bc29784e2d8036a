//! The recording that all dialects hold, and the expected outcome of reading each of them.

use std::f64::consts::TAU;
use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_tables::files::Reading;

use super::other;

/// Samples of the recording.
pub const SAMPLES: usize = 48;

/// Time of a sample, s.
pub fn time(index: usize) -> f64 {
    0.25 + 0.0125 * index as f64
}

/// Displacement of a sample, mm.
pub fn displacement(index: usize) -> f64 {
    2.75 * (TAU * 2.3 * time(index)).sin() + 0.125
}

/// Force of a sample, kN. It is not proportional to the displacement, and its sign differs.
pub fn force(index: usize) -> f64 {
    -1.625 * (TAU * 2.3 * time(index) + 0.4).sin() - 0.75
}

/// A column: a channel in a unit, with a number of decimals.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    pub values: fn(usize) -> f64,
    /// Size of the file's unit in s, mm or kN.
    pub scale: f64,
    pub decimals: usize,
}

pub const S: Column = Column {
    values: time,
    scale: 1.0,
    decimals: 4,
};
pub const MM: Column = Column {
    values: displacement,
    scale: 1.0,
    decimals: 5,
};
pub const KN: Column = Column {
    values: force,
    scale: 1.0,
    decimals: 5,
};
pub const N: Column = Column {
    values: force,
    scale: 1e-3,
    decimals: 2,
};

impl Column {
    pub const fn of(self, scale: f64, decimals: usize) -> Self {
        Self {
            scale,
            decimals,
            ..self
        }
    }

    /// A cell with this decimal sign.
    pub fn cell(self, index: usize, decimal: char) -> String {
        let value = (self.values)(index) / self.scale;
        let text = format!("{value:.*}", self.decimals);
        text.replace('.', &decimal.to_string())
    }

    /// Half of the last digit, in s, mm or kN.
    pub fn rounding(self) -> f64 {
        0.5 * 10_f64.powi(-(self.decimals as i32)) * self.scale
    }
}

/// Time, displacement and force in the units of our own files.
pub const OWN: [Column; 3] = [S, MM, KN];
/// The same with the force in N.
pub const NEWTONS: [Column; 3] = [S, MM, N];

/// Rows of these columns, each with a line end.
pub fn rows(columns: &[Column], separator: &str, decimal: char, end: &str) -> String {
    let row = |index: usize| {
        let cells: Vec<String> = columns
            .iter()
            .map(|column| column.cell(index, decimal))
            .collect();
        cells.join(separator) + end
    };
    (0..SAMPLES).map(row).collect()
}

/// The outcome of reading a dialect.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// It is read, and the guesses contain all of this.
    Read(Vec<&'static str>),
    /// The reader asks, until the user has given these options one after the other.
    Asked(Vec<&'static str>),
    /// It is refused, and the message contains all of this.
    Refused(Vec<&'static str>),
}

impl Outcome {
    pub fn word(&self) -> &'static str {
        match self {
            Self::Read(_) => "read",
            Self::Asked(_) => "asked",
            Self::Refused(_) => "refused",
        }
    }
}

/// The recording in one dialect.
pub struct Dialect {
    pub family: &'static str,
    pub name: &'static str,
    pub bytes: Vec<u8>,
    /// As in the file: they set the digits.
    pub columns: [Column; 3],
    pub outcome: Outcome,
}

impl Dialect {
    /// Whether the outcome is the expected one.
    pub fn check(&self) -> Result<(), String> {
        let said = Reading::default();
        match &self.outcome {
            Outcome::Read(expected) => {
                let recording = read(&self.bytes, &said)?;
                is_true(&recording, self.columns)?;
                let guesses = recording.guesses().join("; ");
                let missing = expected.iter().find(|part| !guesses.contains(**part));
                match missing {
                    Some(missing) => Err(format!("{missing:?} is not said in {guesses:?}")),
                    None if expected.is_empty() && !guesses.is_empty() => {
                        Err(format!("said: {guesses}"))
                    }
                    None => Ok(()),
                }
            }
            Outcome::Asked(options) => self.ask(options),
            Outcome::Refused(expected) => {
                let Err(error) = read(&self.bytes, &said) else {
                    return Err("is read".into());
                };
                match expected.iter().find(|part| !error.contains(**part)) {
                    Some(missing) => Err(format!("{missing:?} is not said in {error:?}")),
                    None => Ok(()),
                }
            }
        }
    }

    /// How the dialect is misread: as a recording that is not the true one, either without an option or with any of the right ones.
    pub fn misread(&self) -> Option<String> {
        let mut said = Reading::default();
        let options = match &self.outcome {
            Outcome::Asked(options) => &options[..],
            Outcome::Read(_) | Outcome::Refused(_) => &[],
        };
        let wrong = |said: &Reading| {
            let recording = read(&self.bytes, said).ok()?;
            is_true(&recording, self.columns).err()
        };
        let by_nobody = wrong(&said);
        let by_options = options.iter().filter_map(|option| {
            say(&mut said, option);
            wrong(&said)
        });
        by_nobody.into_iter().chain(by_options).next()
    }

    /// Gives the options that the messages offer, one after the other.
    fn ask(&self, options: &[&'static str]) -> Result<(), String> {
        let mut said = Reading::default();
        for option in options {
            let Err(error) = read(&self.bytes, &said) else {
                return Err(format!("is read before {option} is said"));
            };
            if !offers(&error, option) {
                return Err(format!("{option} is not offered by {error:?}"));
            }
            for other in other::offered(&error) {
                other::check(self, &said, options, &other)?;
            }
            say(&mut said, option);
        }
        is_true(&read(&self.bytes, &said)?, self.columns)
    }
}

/// Whether a message offers this option to type. For a unit it offers two and lists the others.
fn offers(error: &str, option: &str) -> bool {
    if error.contains(option) {
        return true;
    }
    if option.starts_with("--rate") {
        return error.contains("--rate");
    }
    let Some((head, unit)) = option.split_once('=') else {
        return false;
    };
    let listed = error
        .rsplit_once("units are ")
        .map_or("", |(_, units)| units);
    option.starts_with("--unit")
        && error.contains(head)
        && listed.split(", ").any(|each| each == unit)
}

/// Applies an option as the command line would.
pub fn say(said: &mut Reading, option: &str) {
    let (option, value) = option.split_once(' ').expect("an option and its value");
    let pair = || {
        let (quantity, name) = value.split_once('=').expect("QUANTITY=NAME");
        (quantity.to_owned(), name.trim_matches('\'').to_owned())
    };
    match option {
        "--channel" => said.channels.push(pair()),
        "--unit" => said.units.push(pair()),
        "--rate" => said.rate = value.parse().ok(),
        "--decimal" => said.decimal = Some(if value == "comma" { ',' } else { '.' }),
        other => panic!("{other} is not an option"),
    }
}

/// Reads the bytes as a file would be read.
pub fn read(bytes: &[u8], said: &Reading) -> Result<Recording, String> {
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), bytes).expect("written");
    read_file(file.path(), said)
}

fn read_file(path: &Path, said: &Reading) -> Result<Recording, String> {
    Recording::read_as(path, said).map_err(|error| error.to_string())
}

/// Whether a recording has all of the true values, to the digits that were written.
pub fn is_true(recording: &Recording, columns: [Column; 3]) -> Result<(), String> {
    if recording.len() != SAMPLES {
        return Err(format!("{} samples of {SAMPLES}", recording.len()));
    }
    let mut each = channels(recording).into_iter().zip(columns);
    each.try_for_each(|((name, values), column)| is_channel_true(name, values, column))
}

/// The channels that every dialect has, as they were read.
pub fn channels(recording: &Recording) -> [(&'static str, &[f64]); 3] {
    [
        ("time", &recording.time),
        ("displacement", &recording.displacement),
        ("force", &recording.force),
    ]
}

/// Whether the values of a channel are the true ones.
pub fn is_channel_true(name: &str, values: &[f64], column: Column) -> Result<(), String> {
    // Times may count from the first sample.
    let shift = if name == "time" {
        values[0] - (column.values)(0)
    } else {
        0.0
    };
    let is_shift = shift.abs() <= column.rounding() || (values[0] == 0.0 && name == "time");
    for (index, value) in values.iter().enumerate() {
        let truth = (column.values)(index) + shift;
        let allowed = 2.001 * column.rounding() + 1e-9;
        if !is_shift || (value - truth).abs() > allowed {
            return Err(format!("{name} {index} is {value}, and {truth} is true"));
        }
    }
    Ok(())
}
