//! The injected changes, one list: of each what the monitor knows of it, its facts, its names and its action.

use std::f64::consts::TAU;

use mesh_damper::health::Channel::{self, Displacement, Force};
use mesh_damper::health::HealthCause as H;
use mesh_damper::rig::TripCause as T;
use serde::Serialize;

use super::action::Action::{self, Damage, Sensor, Servo};
use super::action::{
    FULL_SCALE, HealthyRig, STEP, breaks, breaks_wire_by_wire, loosens, preloads, vanishes, wears,
};
use super::facts::Begins::{AtCycleEnd, InShortBlock, WhileLearning};
use super::facts::Element::{
    ActuatorAndDac, Clock, ControlInput, DisplacementChannel, EnableLine, ForceChannel, Link,
    Settings, Specimen, Temperature,
};
use super::facts::Present::{After, Grown, GrownLater};
use super::facts::{Facts, LEARNING, RUN_IN, SIZE, on, on_channel};
use super::names::{
    Names, actuator, broken, gain, lost, outliers, reversed, stiffer, swapped, temperature,
};
use crate::actuator::{SensorFault, ServoFault};
use crate::signals::{Interference, OnChannel, OnClock, OnOutput, OnTemperature};

/// Sizes of a change without a size, and of one sample in this many.
const ONE: &[f64] = &[1.0];
const TENTH: &[f64] = &[10.0];
/// Ticks from one spike of a sensor to the next: a prime, so that spikes come at every position of a cycle.
const SPIKES_EVERY: u64 = 337;
/// Samples of a drop-out and of a burst.
const DROP_OUT: u32 = 2;
const BURST: u64 = 20;
/// Frequency of the mains, Hz.
const MAINS: f64 = 50.0;

const OWN_GAIN: &str =
    "one channel cannot show its own constant gain; only a law known beforehand would";
const SETTLES: &str = "the rig drives what the channel shows, so that a slow drift of its gain looks like a specimen that settles";
const NOT_YET: &str = "it changes nothing until a limit is exceeded";
const UNREAD: &str = "without a read-back a line that stays high shows only when it should drop";
const UNUSED: &str = "the law of the campaign has no control input, and nothing measures one twice";

/// Makes the enumeration and its functions from the list.
macro_rules! changes {
    (
        ($size:ident, $rig:ident)
        known { $($known:ident: $cause:expr, $known_facts:expr, $known_action:expr;)* }
        channel($of:ident) { $($channel:ident: $channel_facts:expr, $channel_names:expr, $channel_action:expr;)* }
        other { $($other:ident: $other_facts:expr, $other_names:expr, $other_action:expr;)* }
    ) => {
        /// A change that is injected into the rig's signals, its actuator or its specimen. [`Change::sizes`] describes its size.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(rename = "AttackKind", rename_all = "snake_case")]
        #[expect(missing_docs, reason = "each is what its name says")]
        pub enum Change {
            $($known,)*
            $($channel(#[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel),)*
            $($other,)*
        }

        impl Change {
            /// Every change: those that the monitor knows, those of each channel, and the others.
            pub fn all() -> Vec<Self> {
                let mut all = vec![$(Self::$known,)*];
                for of in [Displacement, Force] {
                    all.extend([$(Self::$channel(of),)*]);
                }
                all.extend([$(Self::$other,)*]);
                all
            }

            pub(super) fn facts(self) -> Facts {
                match self {
                    $(Self::$known => $known_facts.known($cause),)*
                    $(Self::$channel($of) => $channel_facts,)*
                    $(Self::$other => $other_facts,)*
                }
            }

            /// Its correct names at this size: for a change that the monitor knows its cause, for another all causes that the rig's
            /// signals cannot distinguish from it in principle.
            #[expect(unused_variables, reason = "not every name of a channel's change depends on the channel")]
            pub(super) fn names(self, $size: f64) -> Names {
                match self {
                    $(Self::$known => Names::of(&[$cause], &[]),)*
                    $(Self::$channel($of) => $channel_names,)*
                    $(Self::$other => $other_names,)*
                }
            }

            /// Its action at this size on a rig that is healthy without it.
            pub(super) fn action(self, $size: f64, $rig: &HealthyRig) -> Action {
                match self {
                    $(Self::$known => $known_action,)*
                    $(Self::$channel($of) => $channel_action,)*
                    $(Self::$other => $other_action,)*
                }
            }
        }
    };
}

changes! {
    (size, rig)
    // The monitor has a name for each of these: its cause, facts, action.
    known {
        WireBreakage: H::WireBreakage, on(Specimen, &[0.05, 0.1, 0.2]).harmless(), Damage(breaks);
        FrictionWear: H::FrictionWear, on(Specimen, &[0.05, 0.1, 0.2]).harmless(), Damage(wears);
        Loosening: H::Loosening, on(Specimen, &[0.05, 0.1, 0.2]).harmless(),
            Damage(|now, by| now.gap = by.size * by.rig.amplitude);
        PreloadShift: H::PreloadShift, on(Specimen, &[0.05, 0.1, 0.2]), Damage(preloads);
        DisplacementStuck: H::SensorStuck(Displacement), on(DisplacementChannel, ONE), Sensor(Displacement, SensorFault::Stuck);
        ForceStuck: H::SensorStuck(Force), on(ForceChannel, ONE), Sensor(Force, SensorFault::Stuck);
        DisplacementDroppedOut: H::SensorDroppedOut(Displacement), on(DisplacementChannel, ONE),
            Sensor(Displacement, SensorFault::DroppedOut);
        ForceDroppedOut: H::SensorDroppedOut(Force), on(ForceChannel, ONE), Sensor(Force, SensorFault::DroppedOut);
        DisplacementOpen: H::SensorClipped(Displacement), on(DisplacementChannel, ONE), Sensor(Displacement, SensorFault::Open);
        ForceOpen: H::SensorClipped(Force), on(ForceChannel, ONE), Sensor(Force, SensorFault::Open);
        DisplacementClipped: H::SensorClipped(Displacement), on(DisplacementChannel, &[0.85, 0.7]),
            Sensor(Displacement, SensorFault::Clipped(size * rig.amplitude));
        ForceClipped: H::SensorClipped(Force), on(ForceChannel, &[0.85, 0.7]),
            Sensor(Force, SensorFault::Clipped(size * rig.force));
        DisplacementSpiking: H::SensorSpiking(Displacement), on(DisplacementChannel, &[0.2, 0.5]),
            Sensor(Displacement, SensorFault::Spiking { size: size * rig.amplitude, every: SPIKES_EVERY });
        ForceSpiking: H::SensorSpiking(Force), on(ForceChannel, &[0.2, 0.5]),
            Sensor(Force, SensorFault::Spiking { size: size * rig.force, every: SPIKES_EVERY });
        DisplacementDrifting: H::SensorDrifting(Displacement), on(DisplacementChannel, &[0.002, 0.004, 0.008]).present(Grown(SIZE)),
            Sensor(Displacement, SensorFault::Drifting(size * rig.amplitude * rig.frequency * rig.tick));
        ForceDrifting: H::SensorDrifting(Force), on(ForceChannel, &[0.002, 0.004, 0.008]).present(Grown(SIZE)),
            Sensor(Force, SensorFault::Drifting(size * rig.force * rig.frequency * rig.tick));
        ActuatorSaturated: H::ActuatorSaturated, on(ActuatorAndDac, &[0.7, 0.5]),
            Servo(ServoFault::Saturated(size * TAU * rig.frequency * rig.amplitude));
        ActuatorLagging: H::ActuatorLagging, on(ActuatorAndDac, &[0.1, 0.2, 0.3]),
            Servo(ServoFault::Lagging((size / (TAU * rig.frequency * rig.tick)).round() as usize));
        ActuatorDead: H::ActuatorDead, on(ActuatorAndDac, ONE), Servo(ServoFault::Dead);
    }
    // These are defined without knowledge of what the monitor detects: facts, names, action.
    channel(of) {
        GainStep: on_channel(of, &[-0.1, 0.1, -0.4]).in_cycles(), gain(of, size), Action::gain(of, 1.0 + size, 0.0);
        GainDrift: on_channel(of, &[-0.005, 0.005]).in_cycles().present(GrownLater).hidden_if(of == Displacement, SETTLES),
            gain(of, size), Action::drift(of, size, rig);
        GainDriftInRunIn: on_channel(of, &[-0.01]).in_cycles().present(Grown(RUN_IN)).hidden_if(of == Displacement, SETTLES),
            gain(of, size), Action::drift(of, size, rig);
        GainFromStart: on_channel(of, &[-0.1, -0.4]).at_start().hidden(OWN_GAIN), gain(of, size).or(&[H::LawMismatch], &[]),
            Action::gain(of, 1.0 + size, 0.0);
        DropOuts: on_channel(of, &[0.002, 0.01]), outliers(of),
            Action::channel(of, OnChannel::DropOuts { every: 1.0 / size, samples: DROP_OUT });
        Open: on_channel(of, &[0.001, 0.005]).loses(of), lost(of), Action::channel(of, OnChannel::Open(size * FULL_SCALE));
        Frozen: on_channel(of, ONE).loses(of), lost(of), Action::channel(of, OnChannel::Frozen(size * STEP));
        NeverConnected: on_channel(of, &[0.005]).at_start().loses(of), lost(of),
            Action::channel(of, OnChannel::Open(size * FULL_SCALE));
        Bursts: on_channel(of, &[0.2, 0.5]), outliers(of),
            Action::channel(of, OnChannel::Bursts { volts: size * rig.volts(of), every: (0.5 * rig.cycle()) as u64, samples: BURST });
        Hum: on_channel(of, &[0.02, 0.05, 0.2]).in_cycles(), Names::of(&[H::SensorNoisy(of)], &[]),
            Action::channel(of, OnChannel::Hum { volts: size * rig.volts(of), frequency: MAINS });
        Reversed: on_channel(of, ONE), reversed(of), Action::gain(of, -1.0, 0.0);
        ReversedFromStart: on_channel(of, ONE).at_start(), reversed(of), Action::gain(of, -1.0, 0.0);
        StuckBit: on_channel(of, &[11.0, 13.0]).counted(6, 15), outliers(of),
            Action::channel(of, OnChannel::StuckBit { bit: size as u32, high: false });
        ZeroOneInTen: on_channel(of, TENTH).counted(2, 20), outliers(of), Action::channel(of, OnChannel::ZeroOneIn(size as u64));
        GoodOneInTen: on_channel(of, TENTH).counted(2, 20).loses(of), outliers(of),
            Action::channel(of, OnChannel::GoodOneIn(size as u64));
        Spike: on_channel(of, &[0.5]), outliers(of), Action::channel(of, OnChannel::Spike(size * rig.volts(of)));
        // One sample in ten is clamped to 0.9 of its limit, which is really exceeded.
        Ringing: on_channel(of, TENTH).counted(2, 20).hidden(NOT_YET).only_with_others(),
            Names::of(&[], &[T::ForceLimit, T::DisplacementLimit]),
            Action::channel(of, OnChannel::ClampedOneIn { volts: 0.9 * rig.limit(of), every: size as u64 });
    }
    other {
        // The displacement controls the motion of the piston.
        Swapped: on(DisplacementChannel, ONE), swapped(), Action::Signal(Interference::Swapped);
        SwappedFromStart: on(DisplacementChannel, ONE).at_start(), swapped(), Action::Signal(Interference::Swapped);
        Break: on(Specimen, &[0.1, 0.2, 0.3]).harmless(), broken(), Damage(breaks);
        WiresOneByOne: on(Specimen, &[0.01]).harmless().present(GrownLater), broken(), Damage(breaks_wire_by_wire);
        WiresInRunIn: on(Specimen, &[0.01]).harmless().present(Grown(RUN_IN)), broken(), Damage(breaks_wire_by_wire);
        BreakWhileLearning: on(Specimen, &[0.2, 0.4]).harmless().begins(WhileLearning).present(After(LEARNING.1 - LEARNING.0)),
            broken().or(&[H::LawMismatch], &[]), Damage(breaks);
        BreakInShortBlocks: on(Specimen, &[0.3]).harmless().begins(InShortBlock), broken().or(&[H::LawMismatch], &[]),
            Damage(breaks);
        Wear: on(Specimen, &[0.2]).harmless(), Names::of(&[H::FrictionWear], &[]), Damage(wears);
        Preload: on(Specimen, &[0.1]), Names::of(&[H::PreloadShift, H::SensorDrifting(Force)], &[]), Damage(preloads);
        Backlash: on(Specimen, &[0.005]).harmless().present(GrownLater), Names::of(&[H::Loosening], &[]), Damage(loosens);
        // A gap of a tenth of the amplitude removes about as much of the force as a break.
        BacklashInRunIn: on(Specimen, &[0.005]).harmless().present(Grown(0.5 * RUN_IN)), Names::of(&[H::Loosening], &[]),
            Damage(loosens);
        Seized: on(Specimen, &[20.0]), stiffer(), Damage(|now, by| now.added_stiffness += by.size);
        Removed: on(Specimen, ONE).harmless(), lost(Force).or(&[H::WireBreakage], &[]), Damage(vanishes);
        AbsentFromStart: on(Specimen, ONE).harmless().at_start(), lost(Force).or(&[H::WireBreakage], &[]), Damage(vanishes);
        FrictionRise: on(Specimen, &[0.2, 0.5]), Names::of(&[H::FrictionRise], &[]), Damage(|now, by| now.scale(1.0, 1.0 + by.size));
        // A specimen that is stiffer only does not look like a gain of the force. If friction hardly depends on velocity, it may look
        // like a gain of the displacement.
        Stiffer: on(Specimen, &[0.2]), Names::of(&[H::Stiffening, H::SensorGain(Displacement)], &[]),
            Damage(|now, by| now.scale(1.0 + by.size, 1.0));
        Stiffened: on(Specimen, &[2.0, 4.0]), stiffer(), Damage(|now, by| now.scale(1.0 + by.size, 1.0 + by.size));
        NegativeDamping: on(Specimen, &[0.5]), Names::of(&[H::FrictionWear], &[]), Damage(|now, by| {
            now.added_damping -= by.size * by.rig.force / (TAU * by.rig.frequency * by.rig.amplitude);
        });
        LawWrong: on(Settings, &[0.5, 2.0]).in_cycles().at_start(),
            Names::of(&[H::LawMismatch, H::SensorGain(Force), H::SensorGain(Displacement)], &[]), Action::Law(size);
        TemperatureNan: on(Temperature, ONE), temperature(), Action::temperature(OnTemperature::Reads(f32::NAN));
        TemperatureNanAtCycleEnd: on(Temperature, ONE).begins(AtCycleEnd), temperature(),
            Action::temperature(OnTemperature::Reads(f32::NAN));
        TemperatureOpen: on(Temperature, &[1372.0]), temperature(), Action::temperature(OnTemperature::Reads(size as f32));
        TemperatureJump: on(Temperature, &[30.0]), temperature(), Action::temperature(OnTemperature::Added(size as f32));
        TemperatureNoise: on(Temperature, &[15.0]).in_cycles(), temperature(),
            Action::temperature(OnTemperature::Noise(size as f32));
        TemperatureInfinite: on(Temperature, ONE), temperature(), Action::temperature(OnTemperature::Reads(f32::INFINITY));
        ControlsLost: on(ControlInput, ONE).hidden(UNUSED).only_with_others(), Names::of(&[], &[T::NotFinite]),
            Action::Signal(Interference::Controls(f32::NAN));
        DacBrownOut: on(ActuatorAndDac, ONE), actuator(), Action::output(OnOutput::BrownOut);
        DacHolds: on(ActuatorAndDac, ONE), actuator(), Action::output(OnOutput::Holds);
        // A sudden motion of half the size also looks like a displacement channel of half the gain.
        DacGain: on(ActuatorAndDac, &[0.5]),
            actuator().or(&[H::SensorGain(Displacement), H::ActuatorLagging], &[T::CorrectionLimit]),
            Action::output(OnOutput::Gain(size));
        ServoDead: on(ActuatorAndDac, ONE), actuator(), Servo(ServoFault::Dead);
        EnableStuckLow: on(EnableLine, ONE).harmless(), actuator(), Action::output(OnOutput::Enable(false));
        EnableStuckHigh: on(EnableLine, ONE).hidden(UNREAD), actuator(), Action::output(OnOutput::Enable(true));
        HalfRate: on(Clock, ONE), Names::of(&[], &[T::TickOverrun]), Action::clock(OnClock::HalfRate);
        Stall: on(Clock, &[500.0]), Names::of(&[], &[T::TickOverrun]), Action::clock(OnClock::Stall(size as u32));
        LostTicks: on(Clock, &[2.0]).counted(1, 20), Names::of(&[], &[T::TickOverrun]), Action::clock(OnClock::Loses(size as u64));
        LinkSilent: on(Link, ONE), Names::of(&[], &[T::LinkLost]), Action::Signal(Interference::Silence);
    }
}

impl Change {
    /// The changes that the monitor knows.
    pub fn known() -> Vec<Self> {
        Self::those(|facts| facts.known.is_some())
    }

    /// The name that the monitor has for it, if it knows it.
    pub fn cause(self) -> Option<H> {
        self.facts().known
    }

    /// The changes that are defined without knowledge of the monitor.
    pub(super) fn attacks() -> Vec<Self> {
        Self::those(|facts| facts.known.is_none())
    }

    /// Those of them that make a trial alone.
    pub(super) fn singles() -> Vec<Self> {
        Self::those(|facts| facts.known.is_none() && facts.is_single)
    }

    fn those(are: fn(&Facts) -> bool) -> Vec<Self> {
        let all = Self::all().into_iter();
        all.filter(|change| are(&change.facts())).collect()
    }

    /// Sizes to try, with a meaning that depends on the change:
    ///
    /// - specimen: the part of force or friction that is lost or added, per cycle if it grows; a gap's half width and a preload over
    ///   the amplitudes of displacement and force; kN/mm of a seized one; the force of a wrong law over that of the specimen;
    /// - channel: the change of its gain, per cycle if it drifts; its clipping level, spikes, bursts, hum and drift per cycle over its
    ///   amplitude; probability that a sample begins a drop-out; RMS of an open one's noise over full scale; dither in steps of the
    ///   converter; number of a stuck bit; one sample in this many;
    /// - the others: the largest speed over the demanded one; a lag in rad; °C; the remaining part of the DAC's voltage; ticks of a
    ///   stall; the number of ticks after which one is lost. 1 for a change without a size.
    pub fn sizes(self) -> &'static [f64] {
        self.facts().sizes
    }

    /// Cycles from its beginning until it counts as present, for a law whose adaptation to slow changes is limited to `follow`.
    pub(super) fn lead(self, size: f64, follow: f64) -> f64 {
        match self.facts().present {
            After(cycles) => cycles,
            Grown(amount) => amount / size.abs(),
            GrownLater => SIZE.max(follow) / size.abs(),
        }
    }
}
