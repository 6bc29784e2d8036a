//! `hil inspect`: the contents of a file, their interpretation, and the questions that remain.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_recording::cycles::Cycles;
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::faults::ChannelFaultKind;
use mesh_damper_recording::{Recording, Uniform};
use mesh_damper_tables::columns::{Chosen, Meanings, Rank};
use mesh_damper_tables::files::{self, Column, Needs, Reading, Table, Tables, Wanted};
use serde::Serialize;

use super::inspect_questions::{asked, command, most_like_one};
use super::inspect_words as words;
use crate::commands::document::AddDocument as _;
use crate::commands::reading::RecordingFiles;
use crate::commands::{Failure, say};

/// Show what files hold: columns, units and rate, how they are read, and the command to run next
///
/// If you must state something first, the command prints the question with the option that answers it. The exit code is then still 0.
/// It is 2 for a file that no option makes readable; its contents are printed all the same. The command fits nothing.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil demo --seed 4\n  hil inspect demo-out/recording.csv.gz\n  \
    hil inspect demo-out/recording.csv.gz --channel force=force_kN"
)]
pub struct InspectCommand {
    /// Files to show
    #[arg(required = true, value_name = "FILE")]
    paths: Vec<PathBuf>,
    /// Write the same as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    files: RecordingFiles,
}

/// Contents of files and their interpretation.
#[derive(Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub(in crate::commands) struct Report<'a> {
    /// One entry per file.
    files: &'a [Inspected],
}

/// Contents of a file.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub struct Inspected {
    /// Its path as given.
    pub file: PathBuf,
    /// The file's format.
    pub file_format: &'static str,
    /// Its tables.
    pub tables: Vec<InspectedTable>,
    /// Texts that the recording keeps as its comments.
    pub comments: Vec<String>,
    /// The recording in it; null if a question is open.
    pub recording: Option<InspectedRecording>,
    /// Open questions, each with the option that answers it.
    pub questions: Vec<String>,
    /// The defect of its samples, because of which no recording is read; null if there is none, or if a question is open.
    pub problem: Option<String>,
    /// Guesses, in words.
    pub notes: Vec<String>,
    /// The command that traces it. A word in capitals stands for an answer.
    pub command: String,
}

/// A table of a file.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub struct InspectedTable {
    /// Its name; empty if it has none.
    pub name: String,
    /// Number of samples; null if unknown.
    pub rows: Option<u64>,
    /// Its columns.
    pub columns: Vec<InspectedColumn>,
    /// Contents that are not read, in words.
    pub skipped: Vec<String>,
}

/// A column of a table.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub struct InspectedColumn {
    /// Its name in the file.
    pub name: String,
    /// Its unit, if the file states it apart from the name.
    pub unit: Option<String>,
    /// Whether it contains numbers.
    pub numeric: bool,
    /// Its use, a channel or a control input; null if it is not used, or if a question is open.
    pub used_as: Option<String>,
    /// Its probable meaning, or the reason why it is not used.
    pub taken_for: Cow<'static, str>,
    /// Its first values, in the file's unit.
    pub first: Vec<Option<f64>>,
    /// Smallest and largest value, in the file's unit; null if not all were read.
    pub range: Option<[f64; 2]>,
}

/// Properties of a recording.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "full", derive(schemars::JsonSchema))]
pub struct InspectedRecording {
    /// Number of samples.
    pub samples: usize,
    /// Time of the first and of the last one, s.
    pub time_s: [f64; 2],
    /// Sampling rate, Hz; null if it is not constant.
    pub rate_hz: Option<f64>,
    /// RMS deviation of the times from a constant rate, as a fraction of a step; null if it is due to rounding.
    pub jitter_steps: Option<f64>,
    /// Number of samples in a fast cycle: 19 of 20 cycles have at least as many. Null if the motion has no whole cycle, or if the rate is
    /// not constant.
    pub samples_per_cycle: Option<f64>,
    /// Smallest and largest displacement, mm.
    pub displacement_mm: [f64; 2],
    /// Smallest and largest force, kN.
    pub force_kn: [f64; 2],
    /// Names of the control inputs.
    pub controls: Vec<String>,
    /// Channel faults, in words.
    pub faults: Vec<String>,
}

/// Number of first values shown for a column.
const FIRST: usize = 5;
/// Largest number of columns whose values are all read to count them, if no recording is read.
const MOST_READ: usize = 64;
/// Largest number of samples that are examined as a trace would. Convention: it bounds memory and time for any file, and is more than
/// eight minutes at 1 kHz.
const MOST_EXAMINED: usize = 1 << 19;

impl InspectCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new().reads(&self.paths).writes(&self.json).begin()?;
        let stated = self.files.stated();
        let options = self.files.as_options();
        let mut inspected = Vec::new();
        let mut failed = None;
        for path in &self.paths {
            match inspect(path, &stated, &options) {
                Ok((file, problem)) => {
                    inspected.push(file);
                    failed = failed.or(problem);
                }
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        if let Some(json) = &self.json {
            let report = Report { files: &inspected };
            outputs.add_document(json, &report)?;
        }
        if self.json.as_deref() != Some(Path::new("-")) {
            for file in &inspected {
                words::of(file, &mut |line| say(line));
            }
        }
        outputs.write()?;
        // One unreadable file makes the command fail, whatever the others are.
        failed.map_or(Ok(()), |error| Err(error.into()))
    }
}

/// Inspects one file, and returns the defect of its samples. An open question is no error.
fn inspect(
    path: &Path,
    stated: &Reading,
    options: &[String],
) -> Result<(Inspected, Option<InputError>), InputError> {
    let name = path.display().to_string();
    let mut stated = stated.clone();
    let mut questions = Vec::new();
    let (format, opened) = match files::open(path, &stated) {
        Ok(opened) => opened,
        Err(error) => {
            // This question comes before the columns are known.
            if stated.decimal.is_some() {
                return Err(error);
            }
            stated.decimal = Some('.');
            let opened = files::open(path, &stated).map_err(|_| error.clone())?;
            questions.push(error);
            opened
        }
    };
    let tables = opened.tables();
    let meanings = Meanings::of(tables);
    let chosen = meanings.choose(&name, &stated, &Needs::default());
    if let Err(question) = &chosen {
        questions.extend(asked(&name, tables, &meanings, &stated, question));
    }
    // No option makes the file right.
    let mut problem = (questions
        .iter()
        .find(|question| question.answer().is_none()))
    .cloned();
    questions.retain(|question| question.answer().is_some());
    let mut file = Inspected {
        file: path.to_owned(),
        file_format: format.name(),
        notes: notes(tables, chosen.as_ref().ok()),
        tables: Vec::new(),
        comments: Vec::new(),
        recording: None,
        problem: None,
        command: command(path, options, &questions),
        questions: questions.iter().map(words::question).collect(),
    };
    for (index, table) in tables.iter().enumerate() {
        let described = |column| meanings.described(index, column);
        file.tables.push(match &chosen {
            Ok(chosen) => {
                let chosen = Some(chosen).filter(|chosen| chosen.table == index);
                of(table, &described, chosen)
            }
            Err(_) => open(table, &described, &stated),
        });
    }
    let index = chosen.as_ref().map_or_else(
        |_| *most_like_one(tables, &meanings).1.first().unwrap_or(&0),
        |chosen| chosen.table,
    );
    let counted = count(opened, index, &mut file);
    if questions.is_empty() && problem.is_none() {
        match Recording::read_channels(path, &stated) {
            Ok(recording) => {
                file.notes = recording.guesses().to_vec();
                if recording.len() > MOST_EXAMINED {
                    file.notes.push(format!(
                        "its rate, its cycles and its faults are those of its first {MOST_EXAMINED} samples; whether a trace would \
                        refuse it is not examined"
                    ));
                }
                let (like, untraceable) = like(recording);
                file.recording = Some(like);
                problem = untraceable;
            }
            Err(error) => problem = Some(error),
        }
    }
    match counted {
        Ok(notes) if file.recording.is_none() => file.notes.extend(notes),
        Ok(_) => {}
        // Values that cannot be read are the problem if there is no other.
        Err(error) => problem = problem.or(Some(error)),
    }
    file.problem = problem.as_ref().map(words::question);
    Ok((file, problem))
}

fn notes(tables: &[Table], chosen: Option<&Chosen>) -> Vec<String> {
    match chosen {
        Some(chosen) => chosen.guesses.clone(),
        // A note about the whole file is one of each table.
        None => {
            let mut seen = HashSet::new();
            let notes = tables.iter().flat_map(|table| &table.guesses);
            notes.filter(|note| seen.insert(*note)).cloned().collect()
        }
    }
}

/// The probable meaning of a column of a table.
type Described<'d> = dyn Fn(usize) -> Option<String> + 'd;

/// A table, with the columns `chosen` from it.
fn of(table: &Table, described: &Described<'_>, chosen: Option<&Chosen>) -> InspectedTable {
    let mut uses = chosen.map_or_else(HashMap::new, uses);
    table_with(table, |index, column| match uses.remove(&index) {
        Some(used_as) => (Some(used_as.clone()), used_as.into()),
        None => (None, words::why_not(column, described(index), false)),
    })
}

/// A table while a question is open: nothing is used yet.
fn open(table: &Table, described: &Described<'_>, stated: &Reading) -> InspectedTable {
    table_with(table, |index, column| {
        let column_of = (stated.channels.iter()).find(|(_, name)| *name == column.name);
        let taken_for = match column_of {
            Some((quantity, _)) => format!("{quantity}, as you stated").into(),
            None => words::why_not(column, described(index), true),
        };
        (None, taken_for)
    })
}

/// A table, with the use and the interpretation of each column.
fn table_with(
    table: &Table,
    mut meaning: impl FnMut(usize, &Column) -> (Option<String>, Cow<'static, str>),
) -> InspectedTable {
    let column = |(index, column): (usize, &Column)| {
        let (used_as, taken_for) = meaning(index, column);
        InspectedColumn {
            name: column.name.clone(),
            unit: column.unit.clone(),
            numeric: column.is_numeric,
            taken_for,
            used_as,
            first: column
                .first
                .iter()
                .take(FIRST)
                .map(|value| value.is_finite().then_some(*value))
                .collect(),
            range: None,
        }
    };
    InspectedTable {
        name: table.name.clone(),
        rows: table.rows,
        columns: table.columns.iter().enumerate().map(column).collect(),
        skipped: table.skipped.clone(),
    }
}

/// The uses of columns, and the certainty of the choices.
fn uses(chosen: &Chosen) -> HashMap<usize, String> {
    let used = chosen.used.iter().map(|used| {
        let how = match used.rank {
            Rank::Unit => ", by its unit alone",
            Rank::Weak => ", by a short word with its unit",
            Rank::Stated => ", as you stated",
            Rank::Word | Rank::Own => "",
        };
        let (channel, unit) = (used.channel.name(), used.unit.symbol);
        (used.column, format!("{channel} in {unit}{how}"))
    });
    let controls = chosen.controls.iter();
    let controls = controls.map(|each| {
        let how = match each.length {
            Some(_) => ", if it stays the same",
            None => "",
        };
        (each.column, format!("control input {}{how}", each.name))
    });
    let mut uses: HashMap<usize, String> = controls.collect();
    // The first use of a column counts.
    used.rev().for_each(|(column, how)| {
        uses.insert(column, how);
    });
    uses
}

/// Counts the values of the numeric columns, finds their ranges, and returns notes on them.
fn count(
    opened: Box<dyn Tables + '_>,
    index: usize,
    file: &mut Inspected,
) -> Result<Vec<String>, InputError> {
    let Some(table) = opened.tables().get(index) else {
        return Ok(Vec::new());
    };
    let numeric = (0..table.columns.len()).filter(|&column| table.columns[column].is_numeric);
    let wanted: Vec<Wanted> = numeric
        .take(MOST_READ)
        .map(|column| Wanted {
            column,
            must_be_numeric: false,
        })
        .collect();
    if wanted.is_empty() {
        return Ok(Vec::new());
    }
    let table = &mut file.tables[index];
    let values = opened.look(index, &wanted, &mut |column, values| {
        table.rows = table.rows.or(Some(values.len() as u64));
        table.columns[column].range = range(values);
    })?;
    file.comments = values.comments;
    Ok(values.notes)
}

fn range(values: &[f64]) -> Option<[f64; 2]> {
    let (least, most) = least_and_largest(values.iter().filter(|value| value.is_finite()));
    (least <= most).then_some([least, most])
}

/// What a recording is like, and why a trace would refuse it.
fn like(mut recording: Recording) -> (InspectedRecording, Option<InputError>) {
    let ends = |values: &[f64]| range(values).unwrap_or_default();
    let (samples, time_s) = (recording.len(), ends(&recording.time));
    let [displacement_mm, force_kn] = [&recording.displacement, &recording.force].map(|v| ends(v));
    let controls = std::mem::take(&mut recording.controls);
    // The first samples may be at rest, and a trace take the whole.
    let checked = match samples > MOST_EXAMINED {
        true => recording.check_force(),
        false => recording.check_traceable(),
    };
    let recording = recording.first(MOST_EXAMINED);
    let repaired = recording.repaired();
    let uniform = repaired.uniform().ok();
    let of_times = uniform.as_ref().map_or_else(Vec::new, Uniform::faults);
    let jitter = of_times.iter().find_map(|fault| match fault.kind {
        ChannelFaultKind::Jitter { rms, .. } => Some(rms),
        _ => None,
    });
    let like = InspectedRecording {
        samples,
        time_s,
        rate_hz: uniform.as_ref().map(|uniform| 1.0 / uniform.period),
        jitter_steps: jitter,
        samples_per_cycle: uniform.as_ref().and_then(samples_per_cycle),
        displacement_mm,
        force_kn,
        controls: controls.into_iter().map(|control| control.name).collect(),
        faults: repaired
            .faults()
            .iter()
            .chain(&of_times)
            .map(ToString::to_string)
            .collect(),
    };
    (like, checked.err())
}

/// Of 20 cycles one may be shorter: noise can cross the mid level too.
fn samples_per_cycle(uniform: &Uniform) -> Option<f64> {
    let cycles = Cycles::of(&uniform.displacement, uniform.period).cycles;
    let mut periods: Vec<f64> = cycles.iter().map(|cycle| cycle.period).collect();
    periods.sort_by(f64::total_cmp);
    let short = periods.get(periods.len() / 20)?;
    Some(short / uniform.period)
}
