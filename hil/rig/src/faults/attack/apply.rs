//! Effect of an attack on signals and plant.

use std::cell::Cell;
use std::f64::consts::TAU;

use super::kind::{AttackKind, Element};
use super::trial::Attack;
use crate::Plant;
use crate::actuator::ServoFault;
use crate::faults::damage::{Condition, Damaged};
use crate::faults::kind::HealthyMotion;
use crate::signals::{Begun, Interference, OnChannel, OnClock, OnOutput, OnTemperature};

/// Signals of a healthy rig.
#[derive(Clone, Copy, Debug)]
pub(super) struct Healthy {
    pub(super) motion: HealthyMotion,
    /// Amplitudes of displacement and force, V.
    pub(super) volts: [f64; 2],
    /// Limits of displacement and force, V.
    pub(super) limits: [f64; 2],
}

/// Full scale of the converter and one of its steps, V.
pub(super) const FULL_SCALE: f64 = 10.24;
const STEP: f64 = 2.0 * FULL_SCALE / 65536.0;
/// Final value of a drifting gain, and of breakage wire by wire.
const LAST_GAIN: f64 = 0.4;
const LAST_BROKEN: f64 = 0.4;
/// Largest half width of a gap, relative to the amplitude.
const LAST_GAP: f64 = 0.3;
/// Samples of a drop-out and of a burst.
const DROP_OUT: u32 = 2;
const BURST: u64 = 20;
/// Frequency of the mains, Hz.
const MAINS: f64 = 50.0;

/// An attack and its progress.
#[derive(Clone, Copy, Debug)]
pub(super) struct Running {
    pub(super) attack: Attack,
    /// Tick at which it begins, and tick at which it ends.
    pub(super) from: u64,
    pub(super) to: Option<u64>,
    begun: Option<Begun>,
}

impl Running {
    pub(super) fn new(attack: Attack, from: u64, to: Option<u64>) -> Self {
        Self {
            attack,
            from,
            to,
            begun: None,
        }
    }

    fn acts(&self, tick: u64) -> bool {
        tick >= self.from && self.to.is_none_or(|to| tick < to)
    }

    /// Begins it at its first tick, and ends it at its last.
    pub(super) fn at(&mut self, tick: u64, plant: &mut Plant<Damaged>, healthy: &Healthy) {
        let Attack { kind, size, .. } = self.attack;
        if tick == self.from {
            let what = kind.interference(size, healthy);
            self.begun = what.map(|what| plant.signals.begin(what));
            if kind == AttackKind::ServoDead {
                plant.servo.fault = ServoFault::Dead;
            }
        }
        if self.to == Some(tick) {
            if let Some(begun) = self.begun.take() {
                plant.signals.end(begun);
            }
            if kind == AttackKind::ServoDead {
                plant.servo.fault = ServoFault::None;
            }
        }
    }
}

/// Damage of the specimen by `attacks` at `tick`.
pub(super) fn damage(
    attacks: &[Running],
    tick: u64,
    healthy: &Healthy,
    condition: &Cell<Condition>,
) {
    let of_specimen = |one: &&Running| one.attack.kind.element() == Element::Specimen;
    if !attacks.iter().any(|one| of_specimen(&one)) {
        return;
    }
    let mut now = Condition::NEW;
    for one in attacks.iter().filter(of_specimen) {
        if one.acts(tick) {
            let motion = &healthy.motion;
            let cycles = (tick - one.from) as f64 * motion.tick * motion.frequency;
            one.attack
                .kind
                .damage(one.attack.size, cycles, motion, &mut now);
        }
    }
    condition.set(now);
}

impl AttackKind {
    /// Its interference with a signal; `None` for an attack on the plant.
    pub(super) fn interference(self, size: f64, healthy: &Healthy) -> Option<Interference> {
        let cycle = 1.0 / (healthy.motion.frequency * healthy.motion.tick);
        let at =
            |channel| healthy.volts[usize::from(channel == mesh_damper::health::Channel::Force)];
        let limit =
            |channel| healthy.limits[usize::from(channel == mesh_damper::health::Channel::Force)];
        let gain = |factor, ticks| OnChannel::Gain { factor, ticks };
        let channel = |of, on| Some(Interference::Channel(of, on));
        let temperature = |on| Some(Interference::Temperature(on));
        let output = |on| Some(Interference::Output(on));
        let clock = |on| Some(Interference::Clock(on));
        match self {
            Self::GainStep(of) | Self::GainFromStart(of) => channel(of, gain(1.0 + size, 0.0)),
            Self::GainDrift(of) | Self::GainDriftInRunIn(of) => {
                let factor = 1.0 + LAST_GAIN.copysign(size);
                channel(of, gain(factor, LAST_GAIN / size.abs() * cycle))
            }
            Self::DropOuts(of) => channel(
                of,
                OnChannel::DropOuts {
                    every: 1.0 / size,
                    samples: DROP_OUT,
                },
            ),
            Self::Open(of) | Self::NeverConnected(of) => {
                channel(of, OnChannel::Open(size * FULL_SCALE))
            }
            Self::Frozen(of) => channel(of, OnChannel::Frozen(size * STEP)),
            Self::Bursts(of) => channel(
                of,
                OnChannel::Bursts {
                    volts: size * at(of),
                    every: (0.5 * cycle) as u64,
                    samples: BURST,
                },
            ),
            Self::Hum(of) => channel(
                of,
                OnChannel::Hum {
                    volts: size * at(of),
                    frequency: MAINS,
                },
            ),
            Self::Reversed(of) | Self::ReversedFromStart(of) => channel(of, gain(-1.0, 0.0)),
            Self::StuckBit(of) => channel(
                of,
                OnChannel::StuckBit {
                    bit: size as u32,
                    high: false,
                },
            ),
            Self::ZeroOneInTen(of) => channel(of, OnChannel::ZeroOneIn(size as u64)),
            Self::GoodOneInTen(of) => channel(of, OnChannel::GoodOneIn(size as u64)),
            Self::Spike(of) => channel(of, OnChannel::Spike(size * at(of))),
            Self::Ringing(of) => channel(
                of,
                OnChannel::ClampedOneIn {
                    volts: 0.9 * limit(of),
                    every: size as u64,
                },
            ),
            Self::Swapped | Self::SwappedFromStart => Some(Interference::Swapped),
            Self::TemperatureNan | Self::TemperatureNanAtCycleEnd => {
                temperature(OnTemperature::Reads(f32::NAN))
            }
            Self::TemperatureOpen => temperature(OnTemperature::Reads(size as f32)),
            Self::TemperatureJump => temperature(OnTemperature::Added(size as f32)),
            Self::TemperatureNoise => temperature(OnTemperature::Noise(size as f32)),
            Self::TemperatureInfinite => temperature(OnTemperature::Reads(f32::INFINITY)),
            Self::ControlsLost => Some(Interference::Controls(f32::NAN)),
            Self::DacBrownOut => output(OnOutput::BrownOut),
            Self::DacHolds => output(OnOutput::Holds),
            Self::DacGain => output(OnOutput::Gain(size)),
            Self::EnableStuckLow => output(OnOutput::Enable(false)),
            Self::EnableStuckHigh => output(OnOutput::Enable(true)),
            Self::HalfRate => clock(OnClock::HalfRate),
            Self::Stall => clock(OnClock::Stall(size as u32)),
            Self::LostTicks => clock(OnClock::Loses(size as u64)),
            Self::LinkSilent => Some(Interference::Silence),
            _ => None,
        }
    }

    /// Condition of a specimen after this number of `cycles`, starting from `now`.
    pub(super) fn damage(
        self,
        size: f64,
        cycles: f64,
        motion: &HealthyMotion,
        now: &mut Condition,
    ) {
        let mut scale = |stiffness: f64, friction: f64| {
            now.stiffness *= stiffness;
            now.friction *= friction;
        };
        match self {
            Self::Break | Self::BreakWhileLearning | Self::BreakInShortBlocks => {
                scale(1.0 - size, 1.0 - size);
            }
            Self::WiresOneByOne | Self::WiresInRunIn => {
                // The first at once, and one more with each cycle.
                let left = 1.0 - (size * (1.0 + cycles.floor())).min(LAST_BROKEN);
                scale(left, left);
            }
            Self::Wear => scale(1.0, 1.0 - size),
            Self::FrictionRise => scale(1.0, 1.0 + size),
            Self::Stiffer => scale(1.0 + size, 1.0),
            Self::Stiffened => scale(1.0 + size, 1.0 + size),
            Self::Removed | Self::AbsentFromStart => scale(0.0, 0.0),
            Self::Preload => now.preload += size * motion.force,
            Self::Backlash | Self::BacklashInRunIn => {
                now.gap = now
                    .gap
                    .max((size * cycles).min(LAST_GAP) * motion.amplitude);
            }
            Self::Seized => now.added_stiffness += size,
            Self::NegativeDamping => {
                now.added_damping -=
                    size * motion.force / (TAU * motion.frequency * motion.amplitude);
            }
            _ => {}
        }
    }
}
