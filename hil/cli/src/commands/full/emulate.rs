//! `hil emulate`: a board in software.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper_link::own_timer::EmulatedBoard;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_output::shell;
use mesh_damper_rig::{Plant, RigSetup, TICK_RATE};
use mesh_damper_sources::Sources;
use schemars::JsonSchema;
use serde::Serialize;

use super::image::{IMAGES, say_where};
use super::law::PublishedLaw;
use super::programme;
use super::run::refused;
use super::specimen::{SPECIMEN_AMPLITUDE, SpecimenOptions};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::{Failure, say};

/// Emulate a board that runs on its own timer, connected to a simulated specimen, until you stop it
///
/// The board's serial port is a pseudo-terminal. The command prints its name; `hil record` and `hil upload` connect to it. The board's
/// time runs on even if no command is connected. Actuator, sensors and specimen are the same as in `hil run`. Ctrl-C stops it.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil emulate --effect stick_slip:stiffness=1.2,slip_limit=0.03\n  \
    hil emulate --drawn --seed 7 --blocks 0.1:1:6,0.2:5:10 --ends-after 60"
)]
pub struct EmulateCommand {
    #[command(flatten)]
    specimen: SpecimenOptions,
    /// Blocks that you will run, as amplitude:frequency:cycles in mm and Hz; the range of the load cell follows from them
    #[arg(long, value_name = "BLOCKS", default_value = programme::DEFAULT_BLOCKS)]
    blocks: String,
    /// Tick rate that the board will be set to, Hz
    #[arg(long, value_name = "HZ", default_value_t = TICK_RATE)]
    tick_rate: f64,
    /// Highest speed of the board's time relative to real time, 0.001 to 1000
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    speed: f64,
    /// Stop after this time, in s, 0.001 to 1000000
    #[arg(long, value_name = "S")]
    ends_after: Option<f64>,
    /// Write the port and the channel ranges as JSON to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// An emulated board, as a harness needs to know it.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Emulated {
    /// Serial port at which the board answers.
    port: PathBuf,
    /// The specimen under test, in words.
    specimen: String,
    /// Density of the specimen, g/cm³.
    density_g_cm3: f64,
    /// Displacement at full scale of its channel, mm.
    displacement_range_mm: f64,
    /// Force at full scale of the force channel, kN.
    force_range_kn: f64,
    /// Displacement at full scale of the command, mm.
    command_range_mm: f64,
}

impl EmulateCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new().writes(&self.json).begin()?;
        for (field, value, high) in [
            ("--speed", Some(self.speed), 1e3),
            ("--ends-after", self.ends_after, 1e6),
        ] {
            if value.is_some_and(|value| !(1e-3..=high).contains(&value)) {
                return Err(InputError::new(
                    field,
                    format!("{} is outside its range", value.unwrap_or_default()),
                    format!("give 0.001 to {high}"),
                )
                .into());
            }
        }
        let programme = programme::parse(&self.blocks, self.tick_rate)?;
        let (specimen, density, described) = self.specimen.specimen()?;
        // The board has its own law; nothing of this one is used.
        let law = AugmentedLaw::<f32, 1>::new(PublishedLaw::Tables.at(density, SPECIMEN_AMPLITUDE));
        let setup = RigSetup::new(specimen, law, programme, self.specimen.seed);
        let plant = Plant::new(&setup).map_err(refused)?;
        say_where(&Sources::find()?, "the board's image", IMAGES);
        let progress = Progress::of(1);
        progress.step("building the board's image");
        let mut board = EmulatedBoard::start(plant, self.speed, &[])?;
        drop(progress);
        let emulated = Emulated {
            port: board.port().to_owned(),
            specimen: described,
            density_g_cm3: density,
            displacement_range_mm: setup.displacement_sensor.full_scale,
            force_range_kn: setup.force_sensor.full_scale,
            command_range_mm: setup.command_range,
        };
        outputs.add_document_if(&self.json, &emulated)?;
        outputs.write()?;
        let port = emulated.port.display();
        let range = emulated.force_range_kn;
        say(&format!(
            "The board is at {port}; the range of its load cell is ±{range} kN"
        ));
        say(&format!(
            "hil record --from serial:{} --density {density} --force-range {range} --blocks {} --out recording.csv.gz",
            shell::word(&emulated.port),
            shell::word(&self.blocks)
        ));
        match self.ends_after {
            Some(seconds) => std::thread::sleep(Duration::from_secs_f64(seconds)),
            None => board.wait().map_err(|error| {
                InputError::new("the emulator", error.to_string(), "run it again")
            })?,
        }
        Ok(())
    }
}
