//! `hil study size`: time and memory of a trace.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_output::error::InputError;
use mesh_damper_output::scratch::Scratch;
use mesh_damper_output::{Labelled, Plan};
use mesh_damper_report::size::picture;
use mesh_damper_trials::size::{Measured, Motion, measure, table};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};

use super::schema::Whole;
use crate::commands::document::{AddDocument as _, Document as _};
use crate::commands::progress::Progress;
use crate::commands::{Failure, say};

/// Measure time and memory of a trace over the number of rows
///
/// Simulates recordings of blocks of sines and of a random motion, and traces each in its own process. Needs Linux: the command reads
/// the memory from /proc. Other work on the machine makes the times longer.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil study size --rows 1e4\n  hil study size --rows 5e6 --json size.json --check"
)]
pub struct SizeCommand {
    /// Numbers of rows, 1e4 to 1e7 each, separated by commas
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "1e4,1e5,1e6", value_parser = rows)]
    rows: Vec<usize>,
    /// Write the measurements as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// File for the picture, SVG
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Fail with exit code 1 if a trace needs too much memory or time
    ///
    /// Limits: 400 bytes per row plus 64 MiB, and the longer of 1/20 of the test's duration and 2 s.
    #[arg(long)]
    check: bool,
}

/// The cost of the traces, one after another.
///
/// The JSON is an array from the start, so that each element can state its document.
pub(in crate::commands) struct Sizes<'a>(&'a [Measured]);

impl Serialize for Sizes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(
            self.0
                .iter()
                .map(|each| Labelled::new(Measured::LABEL, each)),
        )
    }
}

impl JsonSchema for Sizes<'_> {
    fn schema_name() -> Cow<'static, str> {
        "Sizes".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": "array",
            "description": "What traces took, one after another.",
            "items": generator.subschema_for::<Whole<Measured>>(),
        })
    }
}

impl SizeCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .writes(&self.json)
            .writes(&self.picture)
            .begin()?;
        let all = self.measure()?;
        outputs.add_document_if(&self.json, &Sizes(&all))?;
        if let Some(path) = &self.picture {
            outputs.add(path, picture(&all));
        }
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            table(&all).lines().for_each(say);
        }
        let beyond = all.iter().filter(|one| !one.is_within_limits()).count();
        if self.check && beyond > 0 {
            return Err(Failure::Check(format!(
                "{beyond} of {} traces exceeded the limits of time or memory",
                all.len()
            )));
        }
        Ok(())
    }

    fn measure(&self) -> Result<Vec<Measured>, InputError> {
        let folder = Scratch::new()
            .map_err(|error| InputError::io(&std::env::temp_dir(), "write to", &error))?;
        let hil = std::env::current_exe()
            .map_err(|error| InputError::io(Path::new("hil"), "run", &error))?;
        let works = Motion::ALL.iter().flat_map(|&motion| {
            let rows = self.rows.iter();
            rows.map(move |&rows| (motion, rows))
        });
        // Most of the time goes to the longest recordings, and grows in proportion to the rows.
        let total = Motion::ALL.len() * self.rows.iter().sum::<usize>();
        let progress = Progress::of(total as u64);
        let mut done = 0;
        let each = works.map(|(motion, rows)| {
            progress.step(&format!("tracing {rows} rows, {}", motion.in_words()));
            let measured = measure(&hil, folder.path(), motion, rows);
            done += rows as u64;
            progress.done(done);
            measured
        });
        each.collect()
    }
}

/// A number of rows, with or without an exponent.
fn rows(text: &str) -> Result<usize, String> {
    let rows: f64 = text
        .parse()
        .map_err(|_| "write a number such as 100000 or 1e5")?;
    // Fewer rows give less than one cycle to each block. More rows exceed the read limit.
    if (1e4..=1e7).contains(&rows) {
        Ok(rows as usize)
    } else {
        Err("1e4 to 1e7 rows can be simulated".into())
    }
}
