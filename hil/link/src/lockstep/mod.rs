//! The crate as an image in an emulator, in lockstep with the simulated rig.

mod bench;
mod emulator;
mod exchange;
mod log;
mod memory;
mod pin;
mod run;
mod serial;
mod watchdog;

pub use bench::{ImageBench, described};
pub use emulator::{Emulator, Wire};
pub use exchange::{Exchange, Sent};
pub use log::{LogDecoder, LogLevel, LogLine, LogSink};
pub use run::{run_rig_on, run_trial_on};
pub use serial::Serial;

use std::path::Path;

use mesh_damper::effects::Motion;
use mesh_damper::frame::{PAYLOAD, VERSION};
use mesh_damper::message::{
    About, Answer, Knots, MAX_BLOCKS, MOTIONS, Motions, Outcome, PART, Refusal, Request, Sensors,
    Setup, Statistics, TelemetryConfig,
};
use mesh_damper::rig::{ClearRefused, Knot, StartRefused, StreamConfig};
use mesh_damper::sine::Programme;
use mesh_damper_output::error::InputError;
use mesh_damper_rig::SetupError;

use crate::image::{Board, FIRMWARE, build};

/// Advice for errors that the user cannot correct.
const REPORT: &str = "run it again; if it stays, run it on the host and report this";

/// An error of the link to an image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// The emulator has ended.
    #[error("the emulator ended ({status}){}", if said.is_empty() { String::new() } else { format!(": {said}") })]
    Ended {
        /// Its exit status.
        status: String,
        /// Its output before.
        said: String,
    },
    /// The emulator is there, but the image does not answer.
    #[error("the image in the emulator does not answer")]
    Silent,
    /// The board at a serial port does not answer.
    #[error(
        "the board at {0} does not answer: check its supply, the cable, and that no other program has the port open"
    )]
    SilentBoard(String),
    /// The serial port is gone, or cannot be read or written.
    #[error("the serial port {port} is gone ({problem}): check the cable and the board's supply")]
    PortGone {
        /// Its path.
        port: String,
        /// The system's error.
        problem: String,
    },
    /// The board speaks another version of the link.
    #[error(
        "the board speaks version {0} of the link, and this harness {VERSION}: flash it with the firmware of this version"
    )]
    OtherVersion(u8),
    /// The board has restarted since the harness joined it.
    #[error("the board restarted during the command: check its supply and its watchdog")]
    Restarted,
    /// The board has no timer and waits for ticks.
    #[error(
        "the board has no timer of its own: flash it with an image that has one, or run it in lockstep by `hil run --on serial:PORT`"
    )]
    NoTimer,
    /// The board has its own timer.
    #[error(
        "the board has a timer of its own: record a test on it by `hil record --from serial:PORT`, or flash it with an image for lockstep"
    )]
    OwnTimer,
    /// The image gave an answer that does not match the request.
    #[error("the image's answer does not belong to the request")]
    OtherAnswer,
    /// The image refused the request.
    #[error("the image refused it: {reason}")]
    Refused {
        /// The reason.
        reason: String,
        /// Advice.
        remedy: &'static str,
    },
    /// The rig on the image does not start.
    #[error("the image's rig does not start: {0}")]
    Start(StartRefused),
    /// The rig on the image does not clear its trip.
    #[error("the image's rig does not clear its trip: {0}")]
    Clear(ClearRefused),
    /// The programme has more blocks than the image holds.
    #[error("the image holds {MAX_BLOCKS} blocks, and the programme has {0}")]
    TooManyBlocks(usize),
}

impl LinkError {
    fn refused(refusal: &Refusal<'_>) -> Self {
        const AGAIN: &str = "send the pack again";
        const EXPORT: &str = "send a pack that `hil export` of this version wrote";
        let (reason, remedy) = match refusal {
            Refusal::Field(field) => {
                return Self::Refused {
                    reason: format!("{field} has a value that the rig does not accept"),
                    remedy: "set it within the range that its documentation gives",
                };
            }
            Refusal::PackActive(field) => {
                return Self::Refused {
                    reason: format!(
                        "{field}: with it the law of the coefficient pack can give more energy than it takes"
                    ),
                    remedy: "send a law whose damping and friction are not below 0",
                };
            }
            Refusal::Removed(what) => {
                return Self::Refused {
                    reason: format!("there is no {what} any more"),
                    remedy: EXPORT,
                };
            }
            Refusal::Start(refused) => return Self::Start(*refused),
            Refusal::Clear(refused) => return Self::Clear(*refused),
            Refusal::Restarted => return Self::Restarted,
            Refusal::Order => ("the request came in the wrong order", REPORT),
            Refusal::Converter => (
                "a converter did not answer its driver",
                "check the converters' supply, their bus and their chip selects, and try again",
            ),
            Refusal::PackMagic => ("these bytes are not a coefficient pack", EXPORT),
            Refusal::PackVersion => ("the coefficient pack is of another version", EXPORT),
            Refusal::PackLength => (
                "the length of the coefficient pack is not the stated one, or is too large",
                AGAIN,
            ),
            Refusal::PackOrder => ("a part of the coefficient pack is missing", AGAIN),
            Refusal::PackChecksum => ("the coefficient pack's checksum does not match", AGAIN),
            Refusal::PackBody => ("the coefficient pack's body cannot be read", EXPORT),
            Refusal::PackTickRate => (
                "tick_rate: the coefficient pack is for a rate other than the rig's, or does not state one",
                "export the model with the rig's --tick-rate",
            ),
            Refusal::PackIdentity => (
                "identity: the coefficient pack is of another model",
                "send the pack of the model that is expected",
            ),
            Refusal::PackRevision => (
                "revision: the coefficient pack is no newer than the one before",
                "export the model with a higher --revision",
            ),
        };
        Self::Refused {
            reason: reason.into(),
            remedy,
        }
    }
}

impl From<LinkError> for SetupError {
    fn from(error: LinkError) -> Self {
        Self::Link(error.into())
    }
}

impl From<LinkError> for InputError {
    fn from(error: LinkError) -> Self {
        let remedy = match error {
            LinkError::TooManyBlocks(_) => "split the programme, or run it on the host",
            LinkError::Start(_) | LinkError::Clear(_) => "correct that on the rig, then try again",
            LinkError::Refused { remedy, .. } => remedy,
            LinkError::SilentBoard(_) | LinkError::PortGone { .. } | LinkError::Restarted => {
                "correct that, then run it again"
            }
            LinkError::OtherVersion(_) | LinkError::NoTimer | LinkError::OwnTimer => {
                "flash the board, then run it again"
            }
            LinkError::Ended { .. } | LinkError::Silent | LinkError::OtherAnswer => REPORT,
        };
        Self::new("the image", error.to_string(), remedy)
    }
}

/// An image that waits for requests.
#[derive(Debug)]
pub struct Image<W> {
    exchange: Exchange<W>,
}

impl Image<Emulator> {
    /// Builds the firmware if it is not up to date, and starts it in the emulator as `board`. Its log goes to `sink`.
    ///
    /// # Errors
    /// A compiler's target or an emulator that is not installed, or the error of one of them.
    pub fn start(board: Board, sink: LogSink) -> Result<Self, InputError> {
        board.check()?;
        let elf = build(&FIRMWARE, board)?;
        let bytes = std::fs::read(&elf).map_err(|error| InputError::io(&elf, "read", &error))?;
        let log = LogDecoder::new(&bytes, sink)?;
        Ok(Self::on(Emulator::start(&elf, board, log)?))
    }
}

impl Image<Serial> {
    /// The board at the serial port `path`, which this restarts.
    ///
    /// # Errors
    /// No such port, or one that cannot be opened; [`LinkError::SilentBoard`], [`LinkError::OtherVersion`].
    pub fn at(path: &Path) -> Result<Self, InputError> {
        let mut image = Self::on(Serial::open(path)?);
        image.done(&Request::Hello)?;
        Ok(image)
    }
}

impl Image<Serial> {
    /// The board at the serial port `path`, which this restarts, for ticks on request.
    ///
    /// # Errors
    /// As [`Image::at`]; a board with its own timer, which would drive its actuator without requests.
    pub fn in_lockstep(path: &Path) -> Result<Self, InputError> {
        let mut image = Self::at(path)?;
        match image.about() {
            Err(LinkError::NoTimer) => Ok(image),
            Err(error) => Err(error.into()),
            Ok(_) => Err(LinkError::OwnTimer.into()),
        }
    }

    /// The board at the serial port `path`, which continues its work, and its description of itself. A board without its own timer
    /// answers that it cannot.
    ///
    /// # Errors
    /// As [`Image::at`].
    pub fn join(path: &Path) -> Result<(Self, About), InputError> {
        let mut image = Self {
            exchange: Exchange::joined(Serial::open(path)?),
        };
        let about = image.about()?;
        Ok((image, about))
    }
}

impl<W: Wire> Image<W> {
    /// The image at the other end of `wire`.
    pub fn on(wire: W) -> Self {
        Self {
            exchange: Exchange::new(wire),
        }
    }

    /// Description of a board on its own timer.
    ///
    /// # Errors
    /// An error of the link; a board without its own timer.
    pub fn about(&mut self) -> Result<About, LinkError> {
        match self.exchange.ask(&Request::Join, |answer| match answer {
            Answer::About(about) => Some(about),
            _ => None,
        }) {
            // A board that takes ticks on request knows no other way.
            Err(LinkError::Refused { .. }) => Err(LinkError::NoTimer),
            about => about,
        }
    }

    /// Requests telemetry from a board on its own timer, from now on.
    ///
    /// # Errors
    /// An error of the link.
    pub fn send_telemetry(&mut self, config: TelemetryConfig) -> Result<(), LinkError> {
        self.done(&Request::Telemetry(config)).map(|_| ())
    }

    /// The next telemetry with its frame's number; `None` if nothing arrives for a while.
    ///
    /// # Errors
    /// An error of the link.
    pub fn telemetry(&mut self) -> Result<Option<(u32, Sent)>, LinkError> {
        self.exchange.telemetry()
    }

    fn done(&mut self, request: &Request<'_>) -> Result<bool, LinkError> {
        self.exchange.ask(request, |answer| match answer {
            Answer::Done(done) => Some(done),
            _ => None,
        })
    }

    /// Sends a coefficient pack, whose law is used from the next end of a cycle on, or at once without a rig. No tick comes in
    /// between.
    ///
    /// # Errors
    /// A pack that the image refuses: the running law then stays.
    pub fn send_pack(&mut self, pack: &[u8]) -> Result<(), LinkError> {
        self.send_parts(pack)?;
        while !self.check_pack()? {}
        Ok(())
    }

    /// Sends the parts of a coefficient pack, which is not checked yet.
    ///
    /// # Errors
    /// An error of the link; a pack that is too long.
    pub fn send_parts(&mut self, pack: &[u8]) -> Result<(), LinkError> {
        for (index, part) in pack.chunks(PART).enumerate() {
            self.done(&Request::PackPart((index * PART) as u16, part))?;
        }
        Ok(())
    }

    /// Runs a slice of the check of the pack whose parts were sent, or the whole check without a rig. Returns whether its law now
    /// waits.
    ///
    /// # Errors
    /// As [`Image::send_pack`].
    pub fn check_pack(&mut self) -> Result<bool, LinkError> {
        self.done(&Request::PackEnd)
    }

    /// Wires up a rig for `programme`.
    ///
    /// # Errors
    /// The image's refusal.
    pub fn set_up<const B: usize>(
        &mut self,
        programme: &Programme<B>,
        setup: &Setup,
    ) -> Result<(), LinkError> {
        if programme.blocks().len() > MAX_BLOCKS {
            return Err(LinkError::TooManyBlocks(programme.blocks().len()));
        }
        self.done(&Request::Programme(programme.head()))?;
        for block in programme.planned() {
            self.done(&Request::Block(block))?;
        }
        self.done(&Request::Setup(*setup)).map(|_| ())
    }

    /// Wires up a rig for a stream.
    ///
    /// # Errors
    /// The image's refusal.
    pub fn set_up_stream(&mut self, config: StreamConfig, setup: &Setup) -> Result<(), LinkError> {
        self.done(&Request::Stream(config))?;
        self.done(&Request::Setup(*setup)).map(|_| ())
    }

    /// Sends the next knots of a stream, or its end if there are none. Returns whether there was room for all of them.
    ///
    /// # Errors
    /// An error of the link; a rig that follows no stream.
    pub fn knots(&mut self, knots: &[Knot]) -> Result<bool, LinkError> {
        let mut buffer = [0; PAYLOAD];
        self.done(&Request::Knots(Knots::new(knots, &mut buffer)))
    }

    /// [`mesh_damper::rig::Controller::start`].
    ///
    /// # Errors
    /// An error of the link; [`LinkError::Start`].
    pub fn start_rig(&mut self) -> Result<(), LinkError> {
        self.done(&Request::Start).map(|_| ())
    }

    /// [`mesh_damper::rig::Controller::stop`].
    ///
    /// # Errors
    /// An error of the link.
    pub fn stop_rig(&mut self) -> Result<(), LinkError> {
        self.done(&Request::Stop).map(|_| ())
    }

    /// One tick of the rig.
    ///
    /// # Errors
    /// An error of the link.
    pub fn tick(&mut self, sensors: Sensors) -> Result<Outcome, LinkError> {
        self.exchange
            .ask(&Request::Tick(sensors), |answer| match answer {
                Answer::Outcome(outcome) => Some(outcome),
                _ => None,
            })
    }

    /// Puts the law's effects at rest, for the motions to come.
    ///
    /// # Errors
    /// An error of the link.
    pub fn rest(&mut self) -> Result<(), LinkError> {
        self.done(&Request::Rest).map(|_| ())
    }

    /// Adds the law's force in kN at each of `motions`, one per tick, to `forces`.
    ///
    /// # Errors
    /// An error of the link; a rig that has been wired up, because it has taken the law.
    pub fn forces(
        &mut self,
        motions: &[Motion<f32>],
        forces: &mut Vec<f32>,
    ) -> Result<(), LinkError> {
        let mut buffer = [0; PAYLOAD];
        for motions in motions.chunks(MOTIONS) {
            let request = Request::Motions(Motions::new(motions, &mut buffer));
            self.exchange.ask(&request, |answer| match answer {
                Answer::Forces(given) => {
                    let before = forces.len();
                    forces.extend(given);
                    (forces.len() - before == motions.len()).then_some(())
                }
                _ => None,
            })?;
        }
        Ok(())
    }

    /// Resources used by the image so far.
    ///
    /// # Errors
    /// An error of the link.
    pub fn statistics(&mut self) -> Result<Statistics, LinkError> {
        self.exchange
            .ask(&Request::Statistics, |answer| match answer {
                Answer::Statistics(statistics) => Some(statistics),
                _ => None,
            })
    }

    /// Number of repeated requests.
    pub fn repeated(&self) -> u64 {
        self.exchange.repeated
    }

    /// Largest number of times that a single request was sent.
    pub fn most_tries(&self) -> u32 {
        self.exchange.most_tries
    }

    /// The wire.
    pub fn wire(&mut self) -> &mut W {
        self.exchange.wire()
    }
}

#[cfg(test)]
mod tests {
    use mesh_damper::error::ConfigError;

    use super::*;

    #[test]
    fn what_was_removed_is_said_as_the_crate_says_it() {
        let removed = ConfigError::Removed("residual table over cycles");
        assert_eq!(
            LinkError::refused(&removed.into()).to_string(),
            format!("the image refused it: {removed}")
        );
    }
}
