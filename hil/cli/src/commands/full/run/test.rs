//! The test of `hil run`, and its results.

use mesh_damper::sine::Programme;
use mesh_damper_link::lockstep::run_rig_on;
use mesh_damper_live::About;
use mesh_damper_model::MAX_EFFECTS;
use mesh_damper_model::extrapolation::{Extrapolation, percent};
use mesh_damper_output::Outputs;
use mesh_damper_recording::Recording;
use mesh_damper_rig::drive::limits::Demands;
use mesh_damper_rig::specimen::{CURRENT, Specimen};
use mesh_damper_rig::{Journal, RigSetup, run_rig};
use schemars::JsonSchema;
use serde::Serialize;

use super::super::cycles::{CycleRow, csv_of, print_blocks};
use super::super::drive::{Driven, Followed};
use super::super::events::EventRow;
use super::super::image::{Linked, Place};
use super::super::junit::Junit;
use super::super::live::{LiveRow, MqttRow};
use super::super::meant_for::FirstError;
use super::super::pace::{Pace, Speed};
use super::super::programme::MOST_BLOCKS;
use super::RunCommand;
use super::trip::Stop;
use super::watched::{Watched, broken_off, ended, with_journal};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, is_free_for_text, say, warn};

/// A test that was checked, and can begin.
pub(super) struct Test {
    /// The specimen, in words.
    pub(super) described: String,
    pub(super) is_controlled: bool,
    pub(super) programme: Option<Programme<MOST_BLOCKS>>,
    pub(super) driven: Option<Driven>,
    pub(super) asked: Option<Demands>,
    pub(super) setup: RigSetup<Specimen, MOST_BLOCKS, MAX_EFFECTS>,
    /// The part outside the operating range of the model.
    pub(super) beyond: Option<Extrapolation>,
    pub(super) warnings: Vec<String>,
}

/// A test on the rig.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Summary {
    /// The place where the crate ran.
    pub(super) on: Place,
    /// The specimen under test, in words.
    pub(super) specimen: String,
    /// Seed of the specimen and of the sensors' noise.
    pub(super) seed: u64,
    /// Tick rate of the crate, Hz.
    pub(super) tick_rate: f64,
    /// Number of ticks that the rig ran.
    pub(super) ticks: u64,
    /// Reasons why the model cannot belong to the specimen or the motion, as sentences.
    warnings: Vec<String>,
    /// The fraction of the blocks, or of the motion's knots, outside the operating range, as computed before the run; null without
    /// a model.
    asked_outside_operating_range: Option<Extrapolation>,
    /// Ticks outside the model's operating range; null without a model.
    outside_operating_range: Option<OutsideTicks>,
    /// The error of the model at the beginning; null without a model.
    first_error: Option<FirstError>,
    /// The motion that was followed; null for a programme.
    pub(super) drive: Option<Followed>,
    /// Per-cycle results; empty for a motion.
    pub(super) cycles: Vec<CycleRow>,
    /// Events of the monitor, once for each cause.
    events: Vec<EventRow>,
    /// The trip of the rig; null if it did not trip.
    pub(super) stopped: Option<Stop>,
    /// The live page; null without --live.
    live: Option<LiveRow>,
    /// The MQTT broker; null without --mqtt.
    mqtt: Option<MqttRow>,
}

/// Ticks that exceed the model's operating range by more than `RANGE_MARGIN`.
#[derive(Clone, Copy, JsonSchema, Serialize)]
struct OutsideTicks {
    /// Number of ticks.
    ticks: u64,
    /// Fraction of all ticks, 0…1.
    part: f64,
}

impl RunCommand {
    /// Runs the test, and writes the recording as `name` and the cycles as `table` into the folder of results.
    pub(super) fn test(
        &self,
        test: Test,
        (name, table): (&str, Option<&str>),
        junit: Junit,
        outputs: &mut Outputs,
    ) -> Result<(), Failure> {
        let linked = Linked::at(&self.on, self.log, self.tick_rate)?;
        let mut comments = vec![
            format!("specimen: {}", test.described),
            format!("run: simulated rig, seed = {}", self.specimen.seed),
        ];
        comments.extend(test.driven.as_ref().map(Driven::comment));
        let mut watched = self.watched(&test, comments.clone())?;
        let run = match linked {
            None => run_rig(test.setup, &mut watched),
            Some(Linked::Image(mut image)) => run_rig_on(&mut *image, test.setup, &mut watched),
            Some(Linked::Board(mut board)) => run_rig_on(&mut *board, test.setup, &mut watched),
        };
        let (journal, mut live) = watched.over();
        let run = run.map_err(|error| broken_off(error, &journal));
        live.end(&ended(run.as_ref()));
        let run = run?;

        let followed = test.driven.as_ref().zip(test.asked);
        let summary = Summary {
            on: self.on.clone(),
            specimen: test.described,
            seed: self.specimen.seed,
            tick_rate: self.tick_rate,
            ticks: run.ticks,
            warnings: test.warnings,
            asked_outside_operating_range: test.beyond,
            first_error: self.model.as_ref().and_then(|_| FirstError::of(&run)),
            outside_operating_range: run.outside.map(|ticks| OutsideTicks {
                ticks,
                part: ticks as f64 / run.ticks as f64,
            }),
            drive: followed.map(|(driven, asked)| driven.followed(&run, asked)),
            cycles: run.cycles.iter().map(CycleRow::from).collect(),
            events: run.events.iter().map(EventRow::new).collect(),
            stopped: run.faults.first().map(|fault| Stop::new(*fault)),
            live: live.page_row(),
            mqtt: live.mqtt_row(),
        };
        let summary = self.warned(summary);
        let junit = summary.checked(junit, test.programme.as_ref());
        junit.add(outputs, self.junit.as_deref())?;
        let recording = self.out.join(name);
        let recorded = match (
            run.recording(recording.display().to_string()),
            &summary.stopped,
        ) {
            // A rig that trips at once has recorded nothing. The message then is the trip cause.
            (Err(_), Some(stop)) => {
                journal.remove();
                if self.junit.is_some() {
                    outputs.write()?;
                }
                return Err(stop.failure());
            }
            (recorded, _) => recorded?,
        };
        let recorded = comments.into_iter().fold(recorded, Recording::with_comment);
        let bytes = recorded.to_file(&recording);
        outputs.add(
            &recording,
            bytes.map_err(|error| with_journal(error, &journal))?,
        );
        if let Some(table) = table {
            outputs.add(self.out.join(table), csv_of(&summary.cycles)?);
        }
        outputs.add_document_if(&self.json, &summary)?;
        outputs
            .write()
            .map_err(|error| with_journal(error, &journal))?;
        if is_free_for_text([&self.json, &self.junit]) {
            self.print(&summary, test.programme.as_ref());
            say(&format!("The recording is {}", recording.display()));
        }
        live.close();
        summary.stopped.map_or(Ok(()), |stop| Err(stop.failure()))
    }

    /// What accompanies the test: progress, the recording so far with `comments`, the live page, and the pace.
    fn watched(&self, test: &Test, comments: Vec<String>) -> Result<Watched, Failure> {
        let setup = &test.setup;
        let live = self.live.start(
            About {
                title: format!("hil run on {}", self.on),
                specimen: test.described.clone(),
                law: self.law_in_words(),
                sample_rate: self.tick_rate,
                duration: Some(match &setup.drive {
                    Some(motion) => motion.duration(),
                    None => setup.programme.duration(),
                }),
                has_cycles: setup.drive.is_none(),
            },
            self.tick_rate,
        )?;
        let controls = test.is_controlled.then(|| CURRENT.to_owned());
        let progress = Progress::of(100);
        progress.step("running the rig");
        Ok(Watched {
            progress,
            journal: Journal::new(&self.out, comments)
                .with_controls(controls.into_iter().collect()),
            live,
            pace: Pace::new(self.speed.unwrap_or(match self.live.has_page() {
                true => Speed::Factor(1.0),
                false => Speed::Max,
            })),
        })
    }

    /// Warns of a model that does not match what was measured, and adds the sentence about its error to the summary.
    fn warned(&self, mut summary: Summary) -> Summary {
        let Some(path) = &self.model else {
            return summary;
        };
        if let Some(words) = summary.first_error.and_then(|error| error.in_words(path)) {
            warn(&words);
            summary.warnings.push(words);
        }
        if let Some(outside) = summary.outside_operating_range
            && outside.ticks > 0
        {
            warn(&format!(
                "{} of the ticks, {} of {}, lie outside the operating range of {}",
                percent(outside.part),
                outside.ticks,
                summary.ticks,
                path.display()
            ));
        }
        summary
    }

    fn print(&self, summary: &Summary, programme: Option<&Programme<MOST_BLOCKS>>) {
        if let Some(programme) = programme {
            print_blocks(&summary.cycles, Some(programme), self.tick_rate);
        }
        if let Some(followed) = &summary.drive {
            followed.print();
        }
        if self.follow > 0.0
            && let Some(last) = summary.cycles.last()
        {
            say(&last.followed_in_words());
        }
        for event in &summary.events {
            say(&event.in_words());
        }
    }
}
