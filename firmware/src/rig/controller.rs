//! Carries out requests: one request, one answer.

use core::mem::MaybeUninit;
use core::sync::atomic::Ordering::Relaxed;

use mesh_damper::fast_law::RunningLaw;
use mesh_damper::frame::{Frame, FrameBuffer};
#[cfg(feature = "own-timer")]
use mesh_damper::message::About;
use mesh_damper::message::{
    MAX_BLOCKS, Refusal, Request, Sensors, Setup, Statistics, write_done, write_forces,
    write_outcome, write_refusal, write_statistics,
};
use mesh_damper::pack::{Expectation, Upload};
#[cfg(feature = "own-timer")]
use mesh_damper::pack::{Identity, Stamp};
use mesh_damper::rig::{
    AnyExciter, Blocking, RigController, State, Stream, StreamConfig, Telemetry, Wiring,
};
use mesh_damper::sine::{Programme, SineGenerator};

use super::log;
use crate::board::{Board, Converters, Harnessed};

/// Most effects of a law.
pub const EFFECTS: usize = 8;

type Wired<B> = <B as Board>::Converters;

/// The crate's controller.
pub type Excitation = RigController<
    EFFECTS,
    AnyExciter<MAX_BLOCKS, &'static Programme<MAX_BLOCKS>>,
    &'static mut RunningLaw<EFFECTS>,
>;

/// The crate's rig on the board.
pub type WiredRig<B> = Blocking<
    &'static mut Excitation,
    <Wired<B> as Converters>::Sensors,
    <Wired<B> as Converters>::Actuator,
>;

/// The parts of a rig: they belong to the image until there is a rig.
pub struct Parts<B: Board> {
    pub programme: &'static mut Programme<MAX_BLOCKS>,
    pub law: &'static mut RunningLaw<EFFECTS>,
    /// The stream to follow instead of the programme.
    pub stream: &'static mut Option<StreamConfig>,
    /// The place for the rig and its controller.
    pub rig: &'static mut MaybeUninit<WiredRig<B>>,
    pub controller: &'static mut MaybeUninit<Excitation>,
}

/// The state that requests act on.
pub struct Controller<B: Board> {
    /// Until there is a rig.
    parts: Option<Parts<B>>,
    rig: Option<&'static mut WiredRig<B>>,
    /// Tick rate of the rig, Hz. Until there is a rig: the rate of the law's pack, if it states one.
    rate: Option<f32>,
    /// Stamp of the last pack.
    #[cfg(feature = "own-timer")]
    stamp: Option<Stamp>,
    upload: &'static mut Upload,
    /// Block of the last tick, for the log.
    block: Option<usize>,
    state: State,
}

impl<B: Board<Converters: Harnessed>> Controller<B> {
    /// Carries out `frame` and writes the answer. Returns false and does nothing if the frame requires nothing.
    #[inline]
    pub fn answer(&mut self, frame: &Frame<'_>, answer: &mut FrameBuffer) -> bool {
        if let Some(sensors) = Sensors::read(frame)
            && self.rig.is_some()
        {
            self.tick(frame.header.sequence, sensors, answer);
            return true;
        }
        self.answer_others(frame, answer)
    }

    /// One tick of the rig. Not inlined, like [`Controller::answer_others`], so that the two do not share one stack frame.
    #[inline(never)]
    fn tick(&mut self, sequence: u32, sensors: Sensors, answer: &mut FrameBuffer) {
        let Some(rig) = &mut self.rig else {
            return;
        };
        Wired::<B>::sense(sensors.displacement, sensors.force);
        Wired::<B>::control(rig.sensors(), sensors.controls);
        Wired::<B>::trip(sensors.tripped);
        rig.exchange();
        rig.set_temperature(sensors.temperature);
        let telemetry = rig.tick(sensors.clock);
        self.log(&telemetry);
        let (code, enabled) = Wired::<B>::driven();
        write_outcome(sequence, code, enabled, &telemetry, answer);
    }
}

impl<B: Board> Controller<B> {
    pub fn new(parts: Parts<B>, upload: &'static mut Upload) -> Self {
        Self {
            parts: Some(parts),
            rig: None,
            rate: None,
            #[cfg(feature = "own-timer")]
            stamp: None,
            upload,
            block: None,
            state: State::Idle,
        }
    }

    /// One tick of the rig on its own timer, with the board's counter at `clock`; none without a rig.
    #[cfg(feature = "own-timer")]
    #[inline]
    pub fn own_tick(&mut self, clock: u32, temperature: f32) -> Option<Telemetry> {
        let rig = self.rig.as_mut()?;
        rig.set_temperature(temperature);
        let telemetry = rig.tick(clock);
        self.log(&telemetry);
        Some(telemetry)
    }

    /// Records that the other end of the link is alive.
    #[cfg(feature = "own-timer")]
    pub fn exchange(&mut self) {
        if let Some(rig) = &mut self.rig {
            rig.exchange();
        }
    }

    /// No tick was requested for too long: a running rig stops.
    pub fn silent(&mut self) {
        if let Some(rig) = &mut self.rig
            && rig.state() == State::Running
        {
            rig.overrun();
            defmt::error!("nobody asks for a tick any more");
        }
    }

    /// Tick rate of the rig, or of the described rig, if known, Hz.
    #[cfg(feature = "own-timer")]
    pub fn rate(&self) -> Option<f32> {
        match &self.parts {
            None => self.rate,
            Some(parts) => match &*parts.stream {
                Some(config) => Some(config.tick_rate()),
                None => Some(parts.programme.tick_rate() as f32).filter(|rate| *rate > 0.0),
            },
        }
    }

    /// Whether there is a rig.
    #[cfg(feature = "own-timer")]
    pub fn has_rig(&self) -> bool {
        self.rig.is_some()
    }

    /// The board's description.
    #[cfg(feature = "own-timer")]
    pub fn about(&self, clock: u32) -> About {
        let rig = self.rig.as_ref();
        About {
            own_timer: true,
            clock,
            tick_rate: rig.and(self.rate).unwrap_or_default(),
            state: rig.map_or(State::Idle, |rig| rig.state()),
            law_waits: rig.is_some_and(|rig| rig.law_waits()),
            late_ticks: rig.map_or(0, |rig| rig.late_ticks()),
            identity: self.stamp.map_or(Identity([0; 8]), |stamp| stamp.identity),
            revision: self.stamp.map_or(0, |stamp| stamp.revision),
        }
    }

    /// Carries out a `frame` other than a tick and writes the answer. Returns false and does nothing if the frame requires nothing.
    #[inline(never)]
    pub fn answer_others(&mut self, frame: &Frame<'_>, answer: &mut FrameBuffer) -> bool {
        let sequence = frame.header.sequence;
        // Borrowed as received: a copy would be on the stack as well.
        let request = Request::read(frame);
        let Some(request) = &request else {
            return false;
        };
        let done = match (request, &mut self.parts) {
            (Request::Motions(motions), Some(parts)) => {
                write_forces(sequence, *motions, |motion| parts.law.force(motion), answer);
                return true;
            }
            (Request::Statistics, _) => {
                let statistics = Statistics {
                    stack: crate::stack::used(),
                    log_lost: log::LOST.load(Relaxed),
                };
                write_statistics(sequence, &statistics, answer);
                return true;
            }
            _ => self.act(request),
        };
        match done {
            Ok(done) => write_done(sequence, done, answer),
            Err(refusal) => write_refusal(sequence, &refusal, answer),
        }
        true
    }

    fn act(&mut self, request: &Request<'_>) -> Result<bool, Refusal<'static>> {
        match (request, &mut self.parts, &mut self.rig) {
            (Request::PackPart(offset, bytes), ..) => {
                self.upload.part(usize::from(*offset), bytes)?;
            }
            (Request::PackEnd, ..) => return self.take_pack(),
            (Request::Programme(head), Some(parts), _) => parts.programme.begin_planned(head),
            (Request::Block(block), Some(parts), _) => parts.programme.push_planned(block)?,
            (Request::Hello, ..) => {}
            (Request::Rest, Some(parts), _) => parts.law.rest(),
            (Request::Stream(config), Some(parts), _) => *parts.stream = Some(*config),
            (Request::Setup(setup), ..) => return self.set_up(setup),
            (Request::Start, _, Some(rig)) => {
                let started = rig.start();
                self.state = rig.state();
                defmt::info!("start: {=bool}", started.is_ok());
                started?;
            }
            (Request::Stop, _, Some(rig)) => {
                rig.stop();
                defmt::info!("stop");
            }
            (Request::Clear, _, Some(rig)) => {
                let cleared = rig.clear();
                defmt::info!("clear: {=bool}", cleared.is_ok());
                cleared?;
            }
            (Request::Knots(knots), _, Some(rig)) => {
                let Some(stream) = rig.exciter().stream() else {
                    return Err(Refusal::Order);
                };
                if knots.is_empty() {
                    stream.complete();
                }
                let mut knots = *knots;
                return Ok(knots.all(|knot| stream.push(knot)));
            }
            _ => return Err(Refusal::Order),
        }
        Ok(true)
    }

    /// Takes the law of the received pack. Without a rig it does so at once. With a rig, a request runs one slice of the check, and
    /// the answer is no as long as there are more: a tick may be due in between. The law is then taken at the end of the cycle.
    #[inline(never)]
    fn take_pack(&mut self) -> Result<bool, Refusal<'static>> {
        let upload = &mut *self.upload;
        let expected = match &self.rig {
            Some(_) => Expectation {
                tick_rate: self.rate,
                ..Expectation::default()
            },
            None => Expectation::default(),
        };
        let taken = match (&mut self.parts, &mut self.rig) {
            (Some(parts), _) => loop {
                let slice = |slot: &mut _| upload.finish_slice(slot, &expected);
                match parts.law.swap_in_slices(slice) {
                    Ok(None) => {}
                    Ok(Some(stamp)) => {
                        if parts.law.boundary() {
                            self.rate = stamp.map(|stamp| stamp.tick_rate);
                        }
                        #[cfg(feature = "own-timer")]
                        {
                            self.stamp = stamp;
                        }
                        break Ok(true);
                    }
                    Err(error) => break Err(error),
                }
            },
            (_, Some(rig)) => rig
                .swap_law_in_slices(|slot| upload.finish_slice(slot, &expected))
                .map(|stamp| {
                    #[cfg(feature = "own-timer")]
                    if let Some(stamp) = stamp {
                        self.stamp = stamp;
                    }
                    stamp.is_some()
                }),
            // A rig that could not be made.
            _ => return Err(Refusal::Order),
        };
        match taken {
            Ok(done) => {
                if done {
                    defmt::info!("coefficient pack accepted");
                }
                Ok(done)
            }
            Err(error) => {
                let refusal = Refusal::from(error);
                defmt::warn!("coefficient pack refused: {}", refusal);
                Err(refusal)
            }
        }
    }

    /// Whether the law is for the tick rate of the rig to set up: it arrived before that rate was known. Not inlined: its stack is
    /// free again before the rig is made.
    #[inline(never)]
    fn check_rate(&mut self) -> Result<(), Refusal<'static>> {
        let Some(parts) = &self.parts else {
            return Err(Refusal::Order);
        };
        let rate = match &*parts.stream {
            Some(config) => config.tick_rate(),
            None => parts.programme.tick_rate() as f32,
        };
        Expectation::at(rate).check_tick_rate(self.rate)?;
        self.rate = Some(rate);
        Ok(())
    }

    #[inline(never)]
    fn set_up(&mut self, setup: &Setup) -> Result<bool, Refusal<'static>> {
        self.check_rate()?;
        let Some(parts) = self.parts.take() else {
            return Err(Refusal::Order);
        };
        let wiring = Wiring {
            displacement: setup.displacement,
            force: setup.force,
            command: setup.command,
        };
        let Some((sensors, actuator)) = Wired::<B>::open(&wiring) else {
            return Err(Refusal::Converter);
        };
        let exciter = match *parts.stream {
            Some(config) => AnyExciter::Stream(Stream::new(config)),
            None => AnyExciter::Programme(SineGenerator::new(&*parts.programme)?),
        };
        let controller = parts.controller.write(RigController::with_exciter(
            &setup.config,
            &wiring,
            exciter,
            parts.law,
        ));
        let rig = Blocking::wire(controller, sensors, actuator);
        self.rig = Some(parts.rig.write(rig));
        Ok(true)
    }

    /// Logs blocks, cycles, and the reason and time of a stop.
    #[inline]
    fn log(&mut self, telemetry: &Telemetry) {
        log::TICKS.store(telemetry.tick as u32, Relaxed);
        if self.block != Some(telemetry.block) {
            self.block = Some(telemetry.block);
            defmt::info!("block {=usize}", telemetry.block);
        }
        if let Some(report) = &telemetry.report {
            defmt::info!(
                "cycle {=u32}: stiffness {=f32} kN/mm, loss factor {=f32}, error of the law {=f32}",
                report.cycle,
                report.measured.stiffness,
                report.measured.loss_factor,
                report.nrmse
            );
        }
        if let Some(event) = &telemetry.event {
            defmt::warn!("{}", event);
        }
        if self.state != telemetry.state {
            self.state = telemetry.state;
            match telemetry.state {
                State::Faulted(fault) => defmt::error!("stopped: {}", fault),
                state => defmt::info!("{}", state),
            }
        }
    }
}
