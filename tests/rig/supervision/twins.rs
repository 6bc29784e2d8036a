//! One rig on simulated parts, driven by blocking calls and by awaited calls.

use std::cell::Cell;
use std::rc::Rc;

use embedded_hal::digital::{ErrorKind, ErrorType, InputPin, OutputPin};
use mesh_damper::adc::{Ads8688, INPUT_RANGE};
use mesh_damper::converter::Scale;
use mesh_damper::dac::{Ad5761, OUTPUT_RANGE};
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::rig::{
    Asynchronous, Blocking, ClearRefused, Controller as _, RigController, RigSettings, SpiActuator,
    StartRefused, State, Telemetry, Wiring, WithAlive, WithReadBack, WithTrip,
};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper_rig::actuator::{AdcPins, DacPins, SimulatedAd5761, SimulatedAds8688, dac_volts};

use crate::asynchronous::{Busy, run};

/// A line with both of its ends, whose calls fail on demand, and which may stick.
#[derive(Clone, Default)]
pub struct Line {
    pub level: Rc<Cell<bool>>,
    /// Number of times that it was set from low to high.
    pub rises: Rc<Cell<u32>>,
    pub stuck: Rc<Cell<bool>>,
    pub fails: Rc<Cell<bool>>,
}

impl Line {
    fn set(&self, high: bool) -> Result<(), ErrorKind> {
        self.check()?;
        if !self.stuck.get() {
            let rises = !self.level.replace(high) && high;
            self.rises.set(self.rises.get() + u32::from(rises));
        }
        Ok(())
    }

    fn check(&self) -> Result<(), ErrorKind> {
        if self.fails.get() {
            Err(ErrorKind::Other)
        } else {
            Ok(())
        }
    }
}

impl ErrorType for Line {
    type Error = ErrorKind;
}

impl OutputPin for Line {
    fn set_low(&mut self) -> Result<(), ErrorKind> {
        self.set(false)
    }
    fn set_high(&mut self) -> Result<(), ErrorKind> {
        self.set(true)
    }
}

impl InputPin for Line {
    fn is_high(&mut self) -> Result<bool, ErrorKind> {
        self.check()?;
        Ok(self.level.get())
    }
    fn is_low(&mut self) -> Result<bool, ErrorKind> {
        Ok(!self.is_high()?)
    }
}

type Sensors<A> = WithTrip<Ads8688<A>, Line>;
type Actuator<D> = WithAlive<WithReadBack<SpiActuator<D, Line>, Line>, Line>;
type Excitation = RigController<1, SineGenerator<2>>;

/// The operations of both rigs.
pub trait Supervised {
    fn new(controller: Excitation, wiring: &Wiring, pins: &Pins) -> Self;
    fn start(&mut self) -> Result<(), StartRefused>;
    fn stop(&mut self);
    fn clear(&mut self) -> Result<(), ClearRefused>;
    fn overrun(&mut self);
    fn external_trip(&mut self);
    fn tick(&mut self, clock: u32) -> Telemetry;
    fn state(&self) -> State;
    fn late_ticks(&self) -> u32;
    fn driven(&self) -> f32;
}

/// The wires of the parts.
#[derive(Clone, Default)]
pub struct Pins {
    pub adc: Rc<AdcPins>,
    pub dac: Rc<DacPins>,
    pub line: Line,
    pub trip: Line,
    pub signal: Line,
}

fn sensors<A>(adc: Ads8688<A>, pins: &Pins) -> Sensors<A> {
    WithTrip::new(adc, pins.trip.clone())
}

fn actuator<D>(dac: Ad5761<D>, pins: &Pins) -> Actuator<D> {
    let actuator = SpiActuator::new(dac, pins.line.clone());
    let actuator = WithReadBack::new(actuator, pins.line.clone());
    WithAlive::new(actuator, pins.signal.clone())
}

/// By blocking calls.
pub struct Waiting(Blocking<Excitation, Sensors<SimulatedAds8688>, Actuator<SimulatedAd5761>>);

impl Supervised for Waiting {
    fn new(controller: Excitation, wiring: &Wiring, pins: &Pins) -> Self {
        let adc = SimulatedAds8688::new(pins.adc.clone());
        let adc = Ads8688::new(adc, wiring.displacement, wiring.force).unwrap();
        let dac = SimulatedAd5761::new(pins.dac.clone());
        let dac = Ad5761::new(dac, wiring.command).unwrap();
        let (sensors, actuator) = (sensors(adc, pins), actuator(dac, pins));
        Self(Blocking::wire(controller, sensors, actuator))
    }
    fn start(&mut self) -> Result<(), StartRefused> {
        self.0.start()
    }
    fn stop(&mut self) {
        self.0.stop();
    }
    fn clear(&mut self) -> Result<(), ClearRefused> {
        self.0.clear()
    }
    fn overrun(&mut self) {
        self.0.overrun();
    }
    fn external_trip(&mut self) {
        self.0.external_trip();
    }
    fn tick(&mut self, clock: u32) -> Telemetry {
        self.0.tick(clock)
    }
    fn state(&self) -> State {
        self.0.state()
    }
    fn late_ticks(&self) -> u32 {
        self.0.late_ticks()
    }
    fn driven(&self) -> f32 {
        self.0.driven()
    }
}

/// By awaited calls, on a bus that is sometimes busy.
pub struct Awaited(
    Asynchronous<Excitation, Sensors<Busy<SimulatedAds8688>>, Actuator<Busy<SimulatedAd5761>>>,
);

impl Supervised for Awaited {
    fn new(controller: Excitation, wiring: &Wiring, pins: &Pins) -> Self {
        let waited = Rc::default();
        let adc = Busy::new(SimulatedAds8688::new(pins.adc.clone()), &waited);
        let adc = run(Ads8688::new_async(adc, wiring.displacement, wiring.force)).unwrap();
        let dac = Busy::new(SimulatedAd5761::new(pins.dac.clone()), &waited);
        let dac = run(Ad5761::new_async(dac, wiring.command)).unwrap();
        let (sensors, actuator) = (sensors(adc, pins), actuator(dac, pins));
        Self(run(Asynchronous::wire(controller, sensors, actuator)))
    }
    fn start(&mut self) -> Result<(), StartRefused> {
        run(self.0.start())
    }
    fn stop(&mut self) {
        run(self.0.stop());
    }
    fn clear(&mut self) -> Result<(), ClearRefused> {
        run(self.0.clear())
    }
    fn overrun(&mut self) {
        run(self.0.overrun());
    }
    fn external_trip(&mut self) {
        run(self.0.external_trip());
    }
    fn tick(&mut self, clock: u32) -> Telemetry {
        run(self.0.tick(clock))
    }
    fn state(&self) -> State {
        self.0.state()
    }
    fn late_ticks(&self) -> u32 {
        self.0.late_ticks()
    }
    fn driven(&self) -> f32 {
        self.0.driven()
    }
}

/// A rig with an actuator that follows the DAC at once, with a force in proportion.
pub struct Fixture<R> {
    pub rig: R,
    pub clock: u32,
    counts: u32,
    ticks: u32,
    /// Output of the DAC at a command of 0, V.
    zero: f64,
    pins: Pins,
}

impl<R> std::ops::Deref for Fixture<R> {
    type Target = Pins;

    fn deref(&self) -> &Pins {
        &self.pins
    }
}

const TICK_RATE: f64 = 1000.0;

pub fn elastic() -> AugmentedLaw<f32, 1> {
    AugmentedLaw::new(Law::new(0.9, 0.0, 0.0, 0.0).unwrap())
}

/// 0.2 mm at 5 Hz, for longer than any test takes.
pub fn programme(tick_rate: f64) -> Programme<2> {
    let programme = Programme::new(tick_rate, 1).unwrap();
    programme
        .with(Block::sine(0.2, 5.0, 1000).unwrap())
        .unwrap()
}

impl<R: Supervised> Fixture<R> {
    fn made(command: Scale, change: impl Fn(&mut RigSettings)) -> Self {
        let unit = Scale::new(1.0, 0.0).unwrap();
        let wiring = Wiring {
            displacement: unit,
            force: unit,
            command,
        };
        let mut settings = RigSettings {
            stop_ticks: 50,
            feedback: 1.0,
            ..RigSettings::default()
        };
        change(&mut settings);
        let law = RunningLaw::new(FastLaw::new(elastic()));
        let programme = programme(TICK_RATE);
        let controller = RigController::new(&settings, &wiring, programme, law).unwrap();
        let pins = Pins::default();
        pins.trip.level.set(true);
        Self {
            rig: R::new(controller, &wiring, &pins),
            clock: 0,
            counts: (settings.clock_rate / TICK_RATE).max(1.0) as u32,
            ticks: 0,
            zero: dac_volts(command.encode(0.0).code),
            pins,
        }
    }

    /// Running.
    pub fn with(change: impl Fn(&mut RigSettings)) -> Self {
        let mut fixture = Self::made(Scale::new(1.0, 0.0).unwrap(), change);
        fixture.rig.start().unwrap();
        fixture
    }

    /// At rest, with another scale of the command.
    pub fn scaled(command: Scale) -> Self {
        Self::made(command, |_| {})
    }

    /// A tick, `counts` of the clock after the one before.
    pub fn tick_after(&mut self, counts: u32) -> Telemetry {
        self.clock = self.clock.wrapping_add(counts);
        // The actuator has a small offset, and its sensor flickers by a step: a channel that reads exactly 0 counts as lost.
        let step = INPUT_RANGE / 32_768.0;
        let off = step * f64::from(20 + self.ticks % 2);
        self.ticks += 1;
        let volts = (self.dac.volts.get() - self.zero) / OUTPUT_RANGE * INPUT_RANGE + off;
        self.adc.volts[0].set(volts);
        self.adc.volts[1].set(0.9 * volts);
        self.rig.tick(self.clock)
    }

    /// A tick in time.
    pub fn tick(&mut self) -> Telemetry {
        self.tick_after(self.counts)
    }

    /// Asserts that it runs for this number of ticks.
    pub fn runs(&mut self, ticks: u32) {
        for tick in 0..ticks {
            assert_eq!(self.tick().state, State::Running, "tick {tick}");
            assert!(self.line.level.get());
        }
    }

    /// Runs for longer than the return to 0 takes.
    pub fn comes_to_rest(&mut self) {
        for _ in 0..60 {
            self.tick();
        }
        assert_eq!(self.rig.driven(), 0.0);
    }

    /// Number of level changes of the alive signal in `ticks` ticks.
    pub fn alive_in(&mut self, ticks: u32) -> u32 {
        (0..ticks)
            .map(|_| {
                let before = self.signal.level.get();
                self.tick();
                u32::from(self.signal.level.get() != before)
            })
            .sum()
    }
}
