//! `hil stop`: stops a rig that runs on a board's own timer.

use clap::Args;
use mesh_damper::rig::State;
use mesh_damper_link::lockstep::Image;
use mesh_damper_output::error::InputError;

use super::board::Port;
use super::run::in_words;
use crate::commands::{Failure, say};

/// Stop a rig that runs on a board's own timer
///
/// The enable line drops at once. Use it for a rig that `hil record --keep-running` left running. It is no emergency stop.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  hil stop --at serial:/dev/ttyACM0")]
pub struct StopCommand {
    /// The board's serial port, such as serial:/dev/ttyACM0; its firmware runs on its own timer
    #[arg(long, value_name = "serial:PORT")]
    at: Port,
}

impl StopCommand {
    pub fn run(self) -> Result<(), Failure> {
        let (mut board, before) = Image::join(self.at.path())?;
        if before.tick_rate == 0.0 {
            say("There is no rig on the board");
            return Ok(());
        }
        board.stop_rig().map_err(InputError::from)?;
        let state = board.about().map_err(InputError::from)?.state;
        say(&match state {
            State::Running => {
                let remedy = "switch off the actuator's power, then report this";
                return Err(
                    InputError::new(self.at.to_string(), "the rig does not stop", remedy).into(),
                );
            }
            State::Idle if before.state == State::Running => "The rig has stopped".to_owned(),
            State::Idle | State::Done => "The rig did not run".to_owned(),
            State::Faulted(fault) => format!("The rig had already tripped: {}", in_words(fault)),
        });
        Ok(())
    }
}
