//! The action of a change on signals and plant.

use std::cell::Cell;

use mesh_damper::health::Channel;

use super::damage::{Condition, Damaged};
use super::trial::Injected;
use crate::Plant;
use crate::actuator::{SensorFault, ServoFault};
use crate::signals::{Begun, Interference, OnChannel, OnClock, OnOutput, OnTemperature};

/// Motion and signals of a healthy rig.
#[derive(Clone, Copy, Debug)]
pub(super) struct HealthyRig {
    /// Amplitude, mm.
    pub(super) amplitude: f64,
    /// Frequency, Hz.
    pub(super) frequency: f64,
    /// Largest force, kN.
    pub(super) force: f64,
    /// Length of a tick, s.
    pub(super) tick: f64,
    /// Displacement in mm and force in kN per V.
    pub(super) units: [f64; 2],
    /// Limits of displacement in mm and of force in kN.
    pub(super) limits: [f64; 2],
}

impl HealthyRig {
    /// Amplitude of a channel, V.
    pub(super) fn volts(&self, of: Channel) -> f64 {
        match of {
            Channel::Displacement => self.amplitude / self.units[0],
            Channel::Force => self.force / self.units[1],
        }
    }

    /// Limit of a channel, V.
    pub(super) fn limit(&self, of: Channel) -> f64 {
        let place = usize::from(of == Channel::Force);
        self.limits[place] / self.units[place]
    }

    /// Ticks per cycle.
    pub(super) fn cycle(&self) -> f64 {
        1.0 / (self.frequency * self.tick)
    }
}

/// Full scale of the converter and one of its steps, V.
pub(super) const FULL_SCALE: f64 = 10.24;
pub(super) const STEP: f64 = 2.0 * FULL_SCALE / 65536.0;
/// Final value of a drifting gain, and of breakage wire by wire.
const LAST_GAIN: f64 = 0.4;
const LAST_BROKEN: f64 = 0.4;
/// Largest half width of a gap, relative to the amplitude.
const LAST_GAP: f64 = 0.3;

/// The action of a change.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    Signal(Interference),
    Sensor(Channel, SensorFault),
    Servo(ServoFault),
    /// Changes the condition of the specimen.
    Damage(fn(&mut Condition, &By)),
    /// The rig has the law of the specimen multiplied by this, from before its start.
    Law(f64),
}

/// The extent of a damage.
#[derive(Clone, Copy, Debug)]
pub(super) struct By<'a> {
    pub(super) size: f64,
    /// Cycles since its beginning.
    pub(super) cycles: f64,
    pub(super) rig: &'a HealthyRig,
}

impl Action {
    pub(super) fn channel(of: Channel, on: OnChannel) -> Self {
        Self::Signal(Interference::Channel(of, on))
    }

    pub(super) fn gain(of: Channel, factor: f64, ticks: f64) -> Self {
        Self::channel(of, OnChannel::Gain { factor, ticks })
    }

    /// The gain of a channel drifts by `size` per cycle.
    pub(super) fn drift(of: Channel, size: f64, rig: &HealthyRig) -> Self {
        let factor = 1.0 + LAST_GAIN.copysign(size);
        Self::gain(of, factor, LAST_GAIN / size.abs() * rig.cycle())
    }

    pub(super) fn temperature(on: OnTemperature) -> Self {
        Self::Signal(Interference::Temperature(on))
    }

    pub(super) fn output(on: OnOutput) -> Self {
        Self::Signal(Interference::Output(on))
    }

    pub(super) fn clock(on: OnClock) -> Self {
        Self::Signal(Interference::Clock(on))
    }
}

pub(super) fn breaks(now: &mut Condition, by: &By) {
    now.scale(1.0 - by.size, 1.0 - by.size);
}

/// The first wire at once, and one more with each cycle.
pub(super) fn breaks_wire_by_wire(now: &mut Condition, by: &By) {
    let left = 1.0 - (by.size * (1.0 + by.cycles.floor())).min(LAST_BROKEN);
    now.scale(left, left);
}

pub(super) fn wears(now: &mut Condition, by: &By) {
    now.scale(1.0, 1.0 - by.size);
}

pub(super) fn vanishes(now: &mut Condition, _: &By) {
    now.scale(0.0, 0.0);
}

pub(super) fn preloads(now: &mut Condition, by: &By) {
    now.preload += by.size * by.rig.force;
}

/// The gap grows with each cycle.
pub(super) fn loosens(now: &mut Condition, by: &By) {
    let half_width = (by.size * by.cycles).min(LAST_GAP) * by.rig.amplitude;
    now.gap = now.gap.max(half_width);
}

/// A change and its progress.
#[derive(Clone, Copy, Debug)]
pub(super) struct Running {
    size: f64,
    pub(super) action: Action,
    /// Tick at which it begins, and tick at which it ends.
    from: u64,
    to: Option<u64>,
    begun: Option<Begun>,
}

impl Running {
    pub(super) fn new(change: Injected, from: u64, to: Option<u64>, rig: &HealthyRig) -> Self {
        Self {
            size: change.size,
            action: change.kind.action(change.size, rig),
            from,
            to,
            begun: None,
        }
    }

    fn acts(&self, tick: u64) -> bool {
        tick >= self.from && self.to.is_none_or(|to| tick < to)
    }

    /// Begins it at its first tick, and ends it at its last.
    pub(super) fn at(&mut self, tick: u64, plant: &mut Plant<Damaged>) {
        if tick == self.from {
            match self.action {
                Action::Signal(what) => self.begun = Some(plant.signals.begin(what)),
                Action::Sensor(of, fault) => sensor(plant, of, fault),
                Action::Servo(fault) => plant.servo.fault = fault,
                Action::Damage(_) | Action::Law(_) => {}
            }
        }
        if self.to == Some(tick) {
            if let Some(begun) = self.begun.take() {
                plant.signals.end(begun);
            }
            match self.action {
                Action::Sensor(of, _) => sensor(plant, of, SensorFault::None),
                Action::Servo(_) => plant.servo.fault = ServoFault::None,
                Action::Signal(_) | Action::Damage(_) | Action::Law(_) => {}
            }
        }
    }
}

fn sensor(plant: &mut Plant<Damaged>, of: Channel, fault: SensorFault) {
    match of {
        Channel::Displacement => plant.displacement_sensor.fault = fault,
        Channel::Force => plant.force_sensor.fault = fault,
    }
}

/// Damage of the specimen by `changes` at `tick`.
pub(super) fn damage(
    changes: &[Running],
    tick: u64,
    rig: &HealthyRig,
    condition: &Cell<Condition>,
) {
    let mut now = Condition::NEW;
    for one in changes {
        if let Action::Damage(damage) = one.action
            && one.acts(tick)
        {
            let cycles = (tick - one.from) as f64 * rig.tick * rig.frequency;
            let size = one.size;
            damage(&mut now, &By { size, cycles, rig });
        }
    }
    condition.set(now);
}
