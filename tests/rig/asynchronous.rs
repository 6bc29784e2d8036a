//! The two converters over an asynchronous bus, and a controller that awaits them.

use std::cell::Cell;
use std::pin::pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};

use embedded_hal::spi::{ErrorKind, ErrorType, Operation};
use embedded_hal_async::spi::SpiDevice;
use mesh_damper::adc::{AdcError, Ads8688, INPUT_RANGE};
use mesh_damper::dac::{Ad5761, DacError};
use mesh_damper::effects::{AugmentedLaw, CONTROLS};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::rig::{
    AsyncSensors as _, Asynchronous, ClearRefused, Rig, RigController, RigSettings, SpiActuator,
    StartRefused, State, TripCause, WithControls,
};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::actuator::{AdcPins, DacPins, SimulatedAd5761, SimulatedAds8688, enable_line};

use crate::support::{Ticks, unit, units};

/// Polls until the future is ready; most polls may be unsuccessful.
pub fn run<F: Future>(future: F) -> F::Output {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    for _ in 0..1000 {
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return output;
        }
    }
    panic!("never ready");
}

/// The part on a bus that is sometimes busy, for up to three polls.
pub struct Busy<S> {
    part: S,
    turn: u32,
    /// Number of polls that found it busy.
    waited: Rc<Cell<u32>>,
}

impl<S> Busy<S> {
    pub fn new(part: S, waited: &Rc<Cell<u32>>) -> Self {
        Self {
            part,
            turn: 0,
            waited: waited.clone(),
        }
    }
}

impl<S: embedded_hal::spi::SpiDevice> ErrorType for Busy<S> {
    type Error = S::Error;
}

impl<S: embedded_hal::spi::SpiDevice> SpiDevice for Busy<S> {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), S::Error> {
        self.turn = self.turn.wrapping_mul(5).wrapping_add(3);
        let mut left = self.turn >> 3 & 3;
        std::future::poll_fn(|_| {
            if left == 0 {
                return Poll::Ready(());
            }
            left -= 1;
            self.waited.set(self.waited.get() + 1);
            Poll::Pending
        })
        .await;
        self.part.transaction(operations)
    }
}

fn controller() -> RigController<1, mesh_damper::sine::SineGenerator<2>> {
    let programme = Programme::new(1000.0, 1).unwrap();
    let programme = programme
        .with(Block::sine(0.2, 5.0, 4).unwrap())
        .unwrap()
        .with(Block::sine(0.1, 10.0, 4).unwrap())
        .unwrap();
    let settings = RigSettings {
        stop_ticks: 100,
        feedback: 1.0,
        ..RigSettings::default()
    };
    let law = AugmentedLaw::new(Law::new(1.0, 0.5, 0.05, 0.3).unwrap());
    let law = RunningLaw::new(FastLaw::new(law));
    RigController::new(&settings, &units(), programme, law).unwrap()
}

/// The pins of one rig. Its actuator follows the command at once, with a force in proportion.
#[derive(Default)]
struct Pins {
    adc: Rc<AdcPins>,
    dac: Rc<DacPins>,
}

impl Pins {
    fn follow(&self) {
        let volts = self.dac.volts.get() / 10.0 * INPUT_RANGE;
        self.adc.volts[0].set(volts);
        self.adc.volts[1].set(0.9 * volts);
    }
}

#[test]
fn awaited_it_gives_the_bits_of_the_blocking_rig() {
    let (pins, others) = (Pins::default(), Pins::default());
    let (line, level) = enable_line();
    let (other_line, other_level) = enable_line();
    let adc = Ads8688::new(SimulatedAds8688::new(pins.adc.clone()), unit(), unit()).unwrap();
    let dac = Ad5761::new(SimulatedAd5761::new(pins.dac.clone()), unit()).unwrap();
    let mut blocking = Rig::wire(controller(), adc, SpiActuator::new(dac, line));

    let waited = Rc::default();
    let bus = Busy::new(SimulatedAds8688::new(others.adc.clone()), &waited);
    let adc = run(Ads8688::new_async(bus, unit(), unit())).unwrap();
    let bus = Busy::new(SimulatedAd5761::new(others.dac.clone()), &waited);
    let dac = run(Ad5761::new_async(bus, unit())).unwrap();
    let actuator = SpiActuator::new(dac, other_line);
    let mut awaited = run(Asynchronous::wire(controller(), adc, actuator));
    assert_eq!(run(awaited.clear()), Err(ClearRefused::NoFault));

    // Complete, dropped halfway, late, and with failures of either bus for a while.
    let mut ticks = Ticks::default();
    let mut reports = 0;
    for (case, fails_at) in [None, Some(333), Some(334), Some(500), Some(720)]
        .into_iter()
        .enumerate()
    {
        blocking.start().unwrap();
        run(awaited.start()).unwrap();
        assert_eq!(run(awaited.start()), Err(StartRefused::Running));
        for tick in 0..2_500 {
            pins.follow();
            others.follow();
            for pins in [&pins, &others] {
                let failing = fails_at.is_some_and(|at| (at..at + 7).contains(&tick));
                pins.adc.bus_failing.set(failing && case == 1);
                pins.dac.bus_failing.set(failing && case == 2);
            }
            if fails_at == Some(tick) && case == 3 {
                blocking.overrun();
                run(awaited.overrun());
                assert!(!level.get() && !other_level.get());
            }
            if fails_at == Some(tick) && case == 4 {
                blocking.stop();
                run(awaited.stop());
                assert!(!level.get() && !other_level.get());
            }
            let clock = ticks.next();
            let (one, two) = (blocking.tick(clock), run(awaited.tick(clock)));
            assert_eq!(one, two, "case {case}, tick {tick}");
            reports += u32::from(one.report.is_some());
            assert_eq!(pins.dac.volts.get(), others.dac.volts.get());
            assert_eq!(level.get(), other_level.get());
            assert_eq!(level.get(), one.state == State::Running);
        }
        let expected = match case {
            0 => State::Done,
            1 => State::Faulted(TripCause::AdcBus),
            2 => State::Faulted(TripCause::DacBus),
            3 => State::Faulted(TripCause::TickOverrun),
            _ => State::Idle,
        };
        assert_eq!(awaited.state(), expected);
        assert_eq!(blocking.clear(), run(awaited.clear()));
    }
    assert!(reports > 10, "{reports}");
    assert!(waited.get() > 1000, "{}: the bus was busy", waited.get());
}

/// A line at a constant level is not a part; a bus that fails reports this.
#[test]
fn a_part_that_is_not_there_is_refused() {
    struct Held(Result<u8, ErrorKind>);

    impl ErrorType for Held {
        type Error = ErrorKind;
    }

    impl SpiDevice for Held {
        async fn transaction(
            &mut self,
            operations: &mut [Operation<'_, u8>],
        ) -> Result<(), ErrorKind> {
            let level = self.0?;
            for operation in operations {
                if let Operation::TransferInPlace(words) = operation {
                    words.fill(level);
                }
            }
            Ok(())
        }
    }

    for (level, read) in [(0, 0), (0xFF, 0x07FF)] {
        let refused = run(Ads8688::new_async(Held(Ok(level)), unit(), unit())).err();
        let register = AdcError::Register {
            address: 5,
            expected: 5,
            found: level,
        };
        assert_eq!(refused, Some(register));
        let refused = run(Ad5761::new_async(Held(Ok(level)), unit())).err();
        assert_eq!(refused, Some(DacError::Control { read }));
    }
    let failing = || Held(Err(ErrorKind::Overrun));
    let refused = run(Ads8688::new_async(failing(), unit(), unit())).err();
    assert_eq!(refused, Some(AdcError::Bus(ErrorKind::Overrun)));
    let refused = run(Ad5761::new_async(failing(), unit())).err();
    assert_eq!(refused, Some(DacError::Bus(ErrorKind::Overrun)));
}

/// A reading that was dropped halfway does not swap the channels or the control inputs.
#[test]
fn a_dropped_reading_is_as_one_that_failed() {
    let pins = Pins::default();
    pins.adc.volts[0].set(0.25 * INPUT_RANGE);
    pins.adc.volts[1].set(-0.5 * INPUT_RANGE);
    let waited = Rc::default();
    let bus = Busy::new(SimulatedAds8688::new(pins.adc), &waited);
    let sensors = run(Ads8688::new_async(bus, unit(), unit())).unwrap();
    let mut sensors = WithControls {
        sensors,
        controls: [1.0, 2.0, 3.0, 4.0],
    };
    let mut dropped = 0;
    for polls in 0..40 {
        {
            let mut reading = pin!(sensors.read());
            let mut context = Context::from_waker(Waker::noop());
            let ready = (0..polls % 5).any(|_| reading.as_mut().poll(&mut context).is_ready());
            dropped += u32::from(!ready);
        }
        let reading = run(sensors.read()).unwrap();
        assert_eq!(reading.displacement.value, 0.25, "after {polls} polls");
        assert_eq!(reading.force.value, -0.5, "after {polls} polls");
        assert_eq!(reading.controls, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(reading.controls.len(), CONTROLS);
    }
    assert!(dropped > 10, "{dropped}");
}
