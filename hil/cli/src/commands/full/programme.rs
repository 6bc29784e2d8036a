//! The programme of a rig test as text: `0.1:1:6,0.2:5:10`, or a JSON file.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper::error::ConfigError;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_output::error::{InputError, Place, quoted};
use mesh_damper_tables::read_limit::{ReadLimit, read_json};
use serde::Deserialize;

/// Largest number of blocks in a programme.
pub const MOST_BLOCKS: usize = 64;
/// Longest duration of a programme, s: 36 million ticks at 10 kHz.
pub const LONGEST: f64 = 3600.0;
/// Default number of cycles of each ramp.
pub const RAMP_CYCLES: u32 = 2;

/// Default blocks: two amplitudes, each at a slow and a faster frequency.
pub const DEFAULT_BLOCKS: &str = "0.1:1:6,0.1:5:10,0.2:1:6,0.2:5:10";

/// The blocks of a test.
#[derive(Args, Debug)]
pub struct ProgrammeOptions {
    /// Blocks of sines as amplitude:frequency:cycles in mm and Hz; 0.1:1-20:50 is a sweep from 1 to 20 Hz
    #[arg(long, value_name = "BLOCKS", default_value = DEFAULT_BLOCKS)]
    blocks: String,
    /// Read the blocks from this JSON file
    #[arg(long, value_name = "FILE", conflicts_with = "blocks")]
    programme: Option<PathBuf>,
}

impl ProgrammeOptions {
    /// The file of the blocks, if they are given in one.
    pub fn file(&self) -> &Option<PathBuf> {
        &self.programme
    }

    /// The programme at `tick_rate` Hz.
    ///
    /// # Errors
    /// As for [`parse`] and [`read_file`].
    pub fn read(
        &self,
        limit: ReadLimit,
        tick_rate: f64,
    ) -> Result<Programme<MOST_BLOCKS>, InputError> {
        match &self.programme {
            Some(path) => read_file(path, limit, tick_rate),
            None => parse(&self.blocks, tick_rate),
        }
    }
}

/// The option with which blocks are given as text.
const OPTION: &str = "--blocks";
const BLOCK_FORM: &str = "write amplitude in mm, frequency in Hz and cycles, as in 0.1:1:6,0.2:5:10, \
    or 0.1:1-20:50 for a sweep";

/// A programme as a JSON file:
///
/// ```json
/// { "ramp_cycles": 2,
///   "blocks": [ { "amplitude": 0.1, "frequency": 1, "cycles": 6 },
///               { "amplitude": 0.1, "from": 1, "to": 20, "cycles": 50 } ] }
/// ```
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProgrammeFile {
    #[serde(default = "default_ramp_cycles")]
    ramp_cycles: u32,
    blocks: Vec<BlockFields>,
}

fn default_ramp_cycles() -> u32 {
    RAMP_CYCLES
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct BlockFields {
    amplitude: f64,
    frequency: Option<f64>,
    from: Option<f64>,
    to: Option<f64>,
    cycles: u32,
}

/// Parses a programme of blocks `amplitude:frequency:cycles` (mm, Hz), at `tick_rate` Hz.
///
/// # Errors
/// The first block that is not of this form or that the crate rejects, by its number from 1; a programme without blocks, with too
/// many, or longer than [`LONGEST`].
pub fn parse(text: &str, tick_rate: f64) -> Result<Programme<MOST_BLOCKS>, InputError> {
    let blocks = text.split(',').enumerate().map(|(index, block)| {
        let place = format!("block {}", index + 1);
        let refused = |problem: String| {
            InputError::new(OPTION, problem, BLOCK_FORM).at(Place::Field(place.clone()))
        };
        let fields: Vec<&str> = block.split(':').map(str::trim).collect();
        let [amplitude, frequency, cycles] = fields[..] else {
            return Err(refused(format!(
                "{} does not have three fields",
                quoted(block.trim())
            )));
        };
        let number = |field: &str| -> Result<f64, InputError> {
            let parsed = field.parse();
            parsed.map_err(|_| refused(format!("{} is not a number", quoted(field))))
        };
        let cycles = cycles
            .parse()
            .map_err(|_| refused(format!("{} is not a number of cycles", quoted(cycles))))?;
        let amplitude = number(amplitude)?;
        // A minus sign belongs to an exponent if the text is a number, otherwise to a sweep.
        let block = match (frequency.parse::<f64>(), frequency.split_once('-')) {
            (Err(_), Some((from, to))) => {
                Block::sweep(amplitude, number(from)?, number(to)?, cycles)
            }
            _ => Block::sine(amplitude, number(frequency)?, cycles),
        };
        Ok((
            place.clone(),
            block.map_err(|error| refused(error.to_string()))?,
        ))
    });
    let blocks = blocks.collect::<Result<Vec<_>, _>>()?;
    build(OPTION, RAMP_CYCLES, blocks, tick_rate)
}

/// Reads the programme from a JSON file, at `tick_rate` Hz.
///
/// # Errors
/// As for [`parse`], with the file and the field; a file beyond the limit.
fn read_file(
    path: &Path,
    limit: ReadLimit,
    tick_rate: f64,
) -> Result<Programme<MOST_BLOCKS>, InputError> {
    let name = path.display().to_string();
    let bytes = read_json(path, limit)?;
    let remedy = "write {\"blocks\": [{\"amplitude\": 0.1, \"frequency\": 1, \"cycles\": 6}]}";
    let mut json = serde_json::Deserializer::from_slice(&bytes);
    let file: ProgrammeFile = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let place = Place::Field(error.path().to_string());
        InputError::new(&name, error.inner().to_string(), remedy).at(place)
    })?;
    let blocks = file.blocks.into_iter().enumerate().map(|(index, fields)| {
        let place = format!("blocks[{index}]");
        let BlockFields {
            amplitude, cycles, ..
        } = fields;
        let block = match (fields.frequency, fields.from, fields.to) {
            (Some(frequency), None, None) => Block::sine(amplitude, frequency, cycles),
            (None, Some(from), Some(to)) => Block::sweep(amplitude, from, to, cycles),
            _ => {
                let problem = "needs either a frequency, or from and to";
                return Err(InputError::new(&name, problem, remedy).at(Place::Field(place)));
            }
        };
        match block {
            Ok(block) => Ok((place, block)),
            Err(error) => {
                Err(InputError::new(&name, error.to_string(), remedy).at(Place::Field(place)))
            }
        }
    });
    let blocks = blocks.collect::<Result<Vec<_>, _>>()?;
    build(&name, file.ramp_cycles, blocks, tick_rate)
}

fn build(
    source: &str,
    ramp_cycles: u32,
    blocks: Vec<(String, Block)>,
    tick_rate: f64,
) -> Result<Programme<MOST_BLOCKS>, InputError> {
    let refused =
        |error: ConfigError| InputError::new(source, error.to_string(), "correct the programme");
    if blocks.is_empty() {
        return Err(InputError::new(source, "there are no blocks", BLOCK_FORM));
    }
    let mut programme = Programme::new(tick_rate, ramp_cycles).map_err(refused)?;
    for (place, block) in blocks {
        programme = programme
            .with(block)
            .map_err(|error| refused(error).at(Place::Field(place)))?;
    }
    if programme.duration() > LONGEST {
        return Err(InputError::new(
            source,
            format!("the programme lasts {:.0} s", programme.duration()),
            format!("keep it below {LONGEST} s, or split it"),
        ));
    }
    Ok(programme)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_file_say_the_same() {
        let text = parse("0.1:1:6, 0.2:1-20:50", 1e4).unwrap();
        let file = tempfile::NamedTempFile::new().unwrap();
        let json = r#"{"blocks": [{"amplitude": 0.1, "frequency": 1, "cycles": 6},
            {"amplitude": 0.2, "from": 1, "to": 20, "cycles": 50}]}"#;
        std::fs::write(file.path(), json).unwrap();
        assert_eq!(
            read_file(file.path(), ReadLimit::default(), 1e4).unwrap(),
            text
        );
        let blocks: Vec<&Block> = text.blocks().collect();
        assert_eq!(*blocks[0], Block::sine(0.1, 1.0, 6).unwrap());
        let slow = parse("0.1:1e-1:6", 1e4).unwrap();
        assert_eq!(slow.blocks().next().unwrap().from(), 0.1);
        assert_eq!(*blocks[1], Block::sweep(0.2, 1.0, 20.0, 50).unwrap());
    }

    #[test]
    fn refuses_naming_the_block() {
        for (text, said) in [
            (
                "",
                "--blocks: field block 1: \"\" does not have three fields",
            ),
            (
                "0.1:1",
                "field block 1: \"0.1:1\" does not have three fields",
            ),
            ("0.1:1:6,x:1:6", "field block 2: \"x\" is not a number"),
            ("0.1:1:2.5", "\"2.5\" is not a number of cycles"),
            ("0.1:1:0", "field block 1: cycles = 0 is outside"),
            ("-0.1:1:6", "field block 1: amplitude = -0.1 is outside"),
            ("nan:1:6", "field block 1: amplitude is not a finite number"),
            ("0.1:4000:6", "field block 1: frequency = 4000 is outside"),
            ("0.1:0.01:600", "the programme lasts 60400 s"),
            (
                &["0.1:1:1"; 65].join(","),
                "field block 65: blocks holds at most 64",
            ),
        ] {
            let error = parse(text, 1e4).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
        let file = tempfile::NamedTempFile::new().unwrap();
        for (json, said) in [
            ("", "EOF"),
            ("{\"blocks\": []}", "there are no blocks"),
            (
                "{\"blocks\": [{\"amplitude\": 0.1, \"cycles\": 6}]}",
                "field blocks[0]: needs either",
            ),
            (
                "{\"blocks\": [{\"amplitude\": 0.1, \"frequency\": \"1\", \"cycles\": 6}]}",
                "field blocks[0].frequency: invalid type",
            ),
            (
                "{\"blocks\": [{\"amplitude\": 1e9, \"frequency\": 1, \"cycles\": 6}]}",
                "field blocks[0]: amplitude = 1000000000 is outside",
            ),
        ] {
            std::fs::write(file.path(), json).unwrap();
            let error = read_file(file.path(), ReadLimit::default(), 1e4)
                .unwrap_err()
                .to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
