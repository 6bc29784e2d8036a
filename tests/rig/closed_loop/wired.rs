//! A rig on the pins of its converters, without a specimen; an enable line that fails.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::rig::{Rig, RigSettings, SpiRig, StartRefused, State, TripCause};
use mesh_damper::sine::Programme;
use mesh_damper_rig::actuator::{AdcPins, DacPins, SimulatedAd5761, SimulatedAds8688};

use super::programme;
use crate::support::{Ticks, elastic, unit};

/// A line whose calls fail while `fails` is set.
#[derive(Clone, Default)]
pub struct FailingLine {
    pub fails: Rc<Cell<bool>>,
    pub high: Rc<Cell<bool>>,
}

impl FailingLine {
    fn set(&self, high: bool) -> Result<(), embedded_hal::digital::ErrorKind> {
        if self.fails.get() {
            return Err(embedded_hal::digital::ErrorKind::Other);
        }
        self.high.set(high);
        Ok(())
    }
}

impl embedded_hal::digital::ErrorType for FailingLine {
    type Error = embedded_hal::digital::ErrorKind;
}

impl embedded_hal::digital::OutputPin for FailingLine {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        self.set(false)
    }
    fn set_high(&mut self) -> Result<(), Self::Error> {
        self.set(true)
    }
}

pub type WiredRig = SpiRig<SimulatedAds8688, SimulatedAd5761, FailingLine, 8, 1>;

/// Both converters' full scales are 1 mm and 1 kN.
pub fn wired(
    (adc, dac): (&Rc<AdcPins>, &Rc<DacPins>),
    line: FailingLine,
    settings: &RigSettings,
    programme: Programme<8>,
    law: AugmentedLaw<f32, 1>,
) -> WiredRig {
    Rig::new(
        Ads8688::new(SimulatedAds8688::new(adc.clone()), unit(), unit()).unwrap(),
        Ad5761::new(SimulatedAd5761::new(dac.clone()), unit()).unwrap(),
        line,
        settings,
        programme,
        RunningLaw::new(FastLaw::new(law)),
    )
    .unwrap()
}

/// A rig on `line` whose sensors always read 0.
fn rig_on(line: FailingLine) -> WiredRig {
    wired(
        (&Rc::default(), &Rc::default()),
        line,
        &RigSettings::default(),
        programme(&[(0.1, 1.0, 1)]),
        elastic(),
    )
}

#[test]
fn a_line_that_cannot_be_raised_is_a_fault() {
    let line = FailingLine::default();
    let mut rig = rig_on(line.clone());
    line.fails.set(true);
    let refused = StartRefused::Faulted(TripCause::EnableLine);
    assert_eq!(rig.start(), Err(refused));
    assert_eq!(rig.state(), State::Faulted(TripCause::EnableLine));
    assert_eq!(rig.tick(0).command, 0.0);
}

#[test]
fn a_line_that_does_not_drop_is_tried_until_it_does() {
    let line = FailingLine::default();
    let mut rig = rig_on(line.clone());
    rig.start().unwrap();
    let mut ticks = Ticks::default();
    rig.tick(ticks.next());
    line.fails.set(true);
    rig.stop();
    for _ in 0..3 {
        let state = rig.tick(ticks.next()).state;
        assert_eq!(state, State::Faulted(TripCause::EnableLine));
        assert!(line.high.get());
    }
    line.fails.set(false);
    rig.tick(ticks.next());
    assert!(!line.high.get());
}
