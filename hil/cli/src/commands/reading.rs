//! The options of every command that reads files: the largest file, and the columns of recordings.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::error::InputError;
use mesh_damper_output::shell;
use mesh_damper_output::terminal::tell;
use mesh_damper_recording::Recording;
use mesh_damper_recording::notes::shared;
use mesh_damper_tables::files;
use mesh_damper_tables::read_limit::ReadLimit;

/// The limit on the size of a file.
#[derive(Args, Clone, Copy, Debug)]
pub struct Reading {
    /// Largest file to read, such as 800MB or 2GiB
    ///
    /// The size counts after unpacking. A JSON file that is no recording may take 1/64 of it.
    #[arg(long = "max-read", value_name = "SIZE", default_value_t)]
    pub limit: ReadLimit,
}

/// The columns of recordings. `hil inspect FILE` shows the contents of a file.
#[derive(Args, Clone, Debug)]
pub struct RecordingFiles {
    /// Column of a quantity, such as force='Axial Force'; give it once for each quantity
    ///
    /// Quantities are time, displacement, force, velocity and temperature, and a control input, such as current.
    #[arg(long = "channel", value_name = "QUANTITY=COLUMN", value_parser = pair)]
    channels: Vec<(String, String)>,
    /// Unit of a quantity's column, such as force=N; give it once for each quantity
    #[arg(long = "unit", value_name = "QUANTITY=UNIT", value_parser = pair)]
    units: Vec<(String, String)>,
    /// Sampling rate in Hz, above 0; it replaces a time column
    #[arg(long, value_name = "HZ", value_parser = rate)]
    rate: Option<f64>,
    /// Sheet, group or table to read, if the file has several
    #[arg(long, value_name = "NAME")]
    table: Option<String>,
    /// Decimal sign of the numbers in a text file, if both are possible
    #[arg(long, value_name = "SIGN", value_parser = ["point", "comma"])]
    decimal: Option<String>,
    #[command(flatten)]
    pub reading: Reading,
}

impl RecordingFiles {
    /// The user's statements about the files.
    pub fn stated(&self) -> files::Reading {
        files::Reading {
            limit: self.reading.limit,
            channels: self.channels.clone(),
            units: self.units.clone(),
            rate: self.rate,
            table: self.table.clone(),
            decimal: (self.decimal.as_deref()).map(|sign| if sign == "comma" { ',' } else { '.' }),
        }
    }

    /// The options as typed.
    pub fn as_options(&self) -> Vec<String> {
        let pairs = |option: &'static str, pairs: &[(String, String)]| -> Vec<String> {
            let each = pairs.iter();
            each.map(|(of, what)| format!("--{option} {of}={}", shell::word(what)))
                .collect()
        };
        let mut options = pairs("channel", &self.channels);
        options.extend(pairs("unit", &self.units));
        options.extend(self.rate.map(|rate| format!("--rate {rate}")));
        options.extend(
            self.table
                .iter()
                // A name may begin as an option does.
                .map(|name| format!("--table={}", shell::word(name))),
        );
        options.extend(self.decimal.iter().map(|sign| format!("--decimal {sign}")));
        options
    }

    /// Reads the channels of a recording, and prints the guesses.
    pub fn channels(&self, path: &Path) -> Result<Recording, InputError> {
        let recording = Recording::read_channels(path, &self.stated())?;
        say_guesses(recording.named_guesses());
        Ok(recording)
    }

    /// Reads the channels of recordings, and prints the guesses: one line for all recordings that share one.
    pub fn channels_of(&self, all: [&[PathBuf]; 2]) -> Result<[Vec<Recording>; 2], InputError> {
        let read = |paths: &[PathBuf]| -> Result<Vec<Recording>, InputError> {
            let each = paths.iter();
            each.map(|path| Recording::read_channels(path, &self.stated()))
                .collect()
        };
        let [first, second] = all;
        let read = [read(first)?, read(second)?];
        let each = || read.iter().flatten();
        let guesses = each().flat_map(Recording::named_guesses);
        say_guesses(shared(each().map(|one| one.name.as_str()), guesses));
        Ok(read)
    }
}

/// Prints the guesses about a file to standard error.
pub fn say_guesses(guesses: impl IntoIterator<Item = String>) {
    for guess in guesses {
        tell(&format!("note: {guess}"));
    }
}

fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((quantity, what)) if !quantity.trim().is_empty() && !what.is_empty() => {
            Ok((quantity.trim().to_owned(), what.to_owned()))
        }
        _ => Err("write QUANTITY=NAME, as in force=\"Axial Force\"".into()),
    }
}

fn rate(text: &str) -> Result<f64, String> {
    let rate: f64 = text
        .parse()
        .map_err(|_| "write a number of Hz".to_owned())?;
    if rate.is_finite() && rate > 0.0 {
        return Ok(rate);
    }
    Err("samples a second are a finite number above 0".into())
}
