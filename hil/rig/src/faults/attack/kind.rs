//! The kinds of attacks: the element on which each acts, its sizes, and how soon it must be found.

use mesh_damper::health::Channel;
use serde::Serialize;

use Channel::{Displacement, Force};

/// The element of the rig that fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each is what its name says")]
pub enum Element {
    DisplacementChannel,
    ForceChannel,
    Temperature,
    ControlInput,
    ActuatorAndDac,
    EnableLine,
    Clock,
    Link,
    Specimen,
    Settings,
}

impl Element {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::DisplacementChannel,
        Self::ForceChannel,
        Self::Temperature,
        Self::ControlInput,
        Self::ActuatorAndDac,
        Self::EnableLine,
        Self::Clock,
        Self::Link,
        Self::Specimen,
        Self::Settings,
    ];
}

/// A kind of attack on the signals or the plant. It is defined without knowledge of what the monitor detects. [`AttackKind::sizes`]
/// describes its size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each is what its name says")]
pub enum AttackKind {
    GainStep(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    GainDrift(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    GainDriftInRunIn(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    GainFromStart(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    DropOuts(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    Open(#[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel),
    Frozen(#[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel),
    NeverConnected(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    Bursts(#[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel),
    Hum(#[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel),
    Reversed(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    ReversedFromStart(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    StuckBit(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    ZeroOneInTen(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    GoodOneInTen(
        #[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel,
    ),
    Spike(#[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel),
    /// One sample in ten is clamped to 0.9 of its limit.
    Ringing(#[cfg_attr(feature = "schema", schemars(with = "crate::schema::ChannelName"))] Channel),
    Swapped,
    SwappedFromStart,
    Break,
    WiresOneByOne,
    WiresInRunIn,
    BreakWhileLearning,
    BreakInShortBlocks,
    Wear,
    Preload,
    Backlash,
    BacklashInRunIn,
    Seized,
    Removed,
    AbsentFromStart,
    FrictionRise,
    Stiffer,
    Stiffened,
    NegativeDamping,
    LawWrong,
    TemperatureNan,
    TemperatureNanAtCycleEnd,
    TemperatureOpen,
    TemperatureJump,
    TemperatureNoise,
    TemperatureInfinite,
    ControlsLost,
    DacBrownOut,
    DacHolds,
    DacGain,
    ServoDead,
    EnableStuckLow,
    EnableStuckHigh,
    HalfRate,
    Stall,
    LostTicks,
    LinkSilent,
}

/// When an attack begins in its own trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    /// Before the rig is started.
    AtStart,
    /// While the monitor learns.
    WhileLearning,
    /// After learning, at a given moment of a cycle.
    Later,
    /// After learning, at the end of a cycle.
    AtCycleEnd,
    /// In the third of four short blocks.
    InShortBlock,
}

/// Cycles within which a fault must be found. The first is for channels with a limit and for the actuator. The second is for the
/// specimen, and for a channel that still follows its quantity, which shows only in the results of whole cycles.
const SOON: f64 = 1.0;
const IN_CYCLES: f64 = 5.0;

/// Cycles of the ramp into the first block: before its end little can be seen.
const RAMP: f64 = 1.0;
/// The monitor's size: the amount at which a slow change counts as a fault.
const SIZE: f64 = 0.05;
/// The amount at which a slow change counts as a fault while the specimen settles, beyond any run-in.
const RUN_IN: f64 = 0.25;
/// Cycle, from the end of the first ramp, in which a specimen breaks while the monitor learns, and the cycle at whose end it has
/// learned.
pub(super) const LEARNING: (f64, f64) = (10.0, 17.0);

impl AttackKind {
    /// Every kind.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for channel in [Displacement, Force] {
            all.extend([
                Self::GainStep(channel),
                Self::GainDrift(channel),
                Self::GainDriftInRunIn(channel),
                Self::GainFromStart(channel),
                Self::DropOuts(channel),
                Self::Open(channel),
                Self::Frozen(channel),
                Self::NeverConnected(channel),
                Self::Bursts(channel),
                Self::Hum(channel),
                Self::Reversed(channel),
                Self::ReversedFromStart(channel),
                Self::StuckBit(channel),
                Self::ZeroOneInTen(channel),
                Self::GoodOneInTen(channel),
                Self::Spike(channel),
                Self::Ringing(channel),
            ]);
        }
        all.extend([
            Self::Swapped,
            Self::SwappedFromStart,
            Self::Break,
            Self::WiresOneByOne,
            Self::WiresInRunIn,
            Self::BreakWhileLearning,
            Self::BreakInShortBlocks,
            Self::Wear,
            Self::Preload,
            Self::Backlash,
            Self::BacklashInRunIn,
            Self::Seized,
            Self::Removed,
            Self::AbsentFromStart,
            Self::FrictionRise,
            Self::Stiffer,
            Self::Stiffened,
            Self::NegativeDamping,
            Self::LawWrong,
            Self::TemperatureNan,
            Self::TemperatureNanAtCycleEnd,
            Self::TemperatureOpen,
            Self::TemperatureJump,
            Self::TemperatureNoise,
            Self::TemperatureInfinite,
            Self::ControlsLost,
            Self::DacBrownOut,
            Self::DacHolds,
            Self::DacGain,
            Self::ServoDead,
            Self::EnableStuckLow,
            Self::EnableStuckHigh,
            Self::HalfRate,
            Self::Stall,
            Self::LostTicks,
            Self::LinkSilent,
        ]);
        all
    }

    /// Sizes to try, with a meaning that depends on the kind:
    ///
    /// Gain: its relative change, per cycle if it drifts. Drop-outs: probability that a sample begins one. Open channel: RMS of the
    /// noise relative to full scale. Dither: steps of the converter. Bursts, hum and spikes: their size relative to the channel's
    /// amplitude. Stuck bit: its number. Outliers at fixed distance: one sample in this many.
    ///
    /// Specimen: the part of force or friction that is lost or added, per cycle if the change is gradual. Gap: its half width
    /// relative to the amplitude, per cycle if gradual. Seized specimen: kN/mm. Wrong law: its force relative to the specimen's.
    ///
    /// Temperature: °C. DAC: the remaining part of its voltage. Stall: ticks. Lost ticks: the number of ticks after which one is
    /// lost. 1 for a kind without a size.
    pub fn sizes(self) -> &'static [f64] {
        match self {
            Self::GainStep(_) => &[-0.1, 0.1, -0.4],
            Self::GainDrift(_) => &[-0.005, 0.005],
            Self::GainDriftInRunIn(_) => &[-0.01],
            Self::GainFromStart(_) => &[-0.1, -0.4],
            Self::DropOuts(_) => &[0.002, 0.01],
            Self::Open(_) => &[0.001, 0.005],
            Self::NeverConnected(_) => &[0.005],
            Self::Bursts(_) => &[0.2, 0.5],
            Self::Hum(_) => &[0.02, 0.05, 0.2],
            Self::StuckBit(_) => &[11.0, 13.0],
            Self::ZeroOneInTen(_) | Self::GoodOneInTen(_) | Self::Ringing(_) => &[10.0],
            Self::Spike(_) => &[0.5],
            Self::Break => &[0.1, 0.2, 0.3],
            Self::WiresOneByOne => &[0.01],
            Self::WiresInRunIn => &[0.01],
            Self::BreakWhileLearning => &[0.2, 0.4],
            Self::BreakInShortBlocks => &[0.3],
            Self::Wear => &[0.2],
            Self::Preload => &[0.1],
            Self::Backlash | Self::BacklashInRunIn => &[0.005],
            Self::Seized => &[20.0],
            Self::FrictionRise => &[0.2, 0.5],
            Self::Stiffer => &[0.2],
            Self::Stiffened => &[2.0, 4.0],
            Self::NegativeDamping => &[0.5],
            Self::LawWrong => &[0.5, 2.0],
            Self::TemperatureOpen => &[1372.0],
            Self::TemperatureJump => &[30.0],
            Self::TemperatureNoise => &[15.0],
            Self::DacGain => &[0.5],
            Self::Stall => &[500.0],
            Self::LostTicks => &[2.0],
            _ => &[1.0],
        }
    }

    /// The element that fails.
    pub fn element(self) -> Element {
        match self {
            Self::GainStep(of)
            | Self::GainDrift(of)
            | Self::GainDriftInRunIn(of)
            | Self::GainFromStart(of)
            | Self::DropOuts(of)
            | Self::Open(of)
            | Self::Frozen(of)
            | Self::NeverConnected(of)
            | Self::Bursts(of)
            | Self::Hum(of)
            | Self::Reversed(of)
            | Self::ReversedFromStart(of)
            | Self::StuckBit(of)
            | Self::ZeroOneInTen(of)
            | Self::GoodOneInTen(of)
            | Self::Spike(of)
            | Self::Ringing(of) => match of {
                Displacement => Element::DisplacementChannel,
                Force => Element::ForceChannel,
            },
            // The displacement controls the motion of the piston.
            Self::Swapped | Self::SwappedFromStart => Element::DisplacementChannel,
            Self::TemperatureNan
            | Self::TemperatureNanAtCycleEnd
            | Self::TemperatureOpen
            | Self::TemperatureJump
            | Self::TemperatureNoise
            | Self::TemperatureInfinite => Element::Temperature,
            Self::ControlsLost => Element::ControlInput,
            Self::DacBrownOut | Self::DacHolds | Self::DacGain | Self::ServoDead => {
                Element::ActuatorAndDac
            }
            Self::EnableStuckLow | Self::EnableStuckHigh => Element::EnableLine,
            Self::HalfRate | Self::Stall | Self::LostTicks => Element::Clock,
            Self::LinkSilent => Element::Link,
            Self::LawWrong => Element::Settings,
            _ => Element::Specimen,
        }
    }

    /// Cycles within which it must be found, from the time when it counts as present.
    pub fn within(self) -> f64 {
        match self {
            Self::GainStep(_) | Self::GainDrift(_) | Self::GainDriftInRunIn(_) | Self::Hum(_) => {
                IN_CYCLES
            }
            Self::TemperatureNoise | Self::LawWrong => IN_CYCLES,
            _ if self.element() == Element::Specimen => IN_CYCLES,
            _ => SOON,
        }
    }

    /// Cycles from its beginning until it counts as present, for a law whose adaptation to slow changes is limited to `follow`.
    pub fn lead(self, size: f64, follow: f64) -> f64 {
        match self {
            Self::GainDrift(_) | Self::WiresOneByOne | Self::Backlash => {
                SIZE.max(follow) / size.abs()
            }
            Self::GainDriftInRunIn(_) | Self::WiresInRunIn => RUN_IN / size.abs(),
            // A gap of a tenth of the amplitude removes about as much of the force as a break.
            Self::BacklashInRunIn => 0.5 * RUN_IN / size,
            Self::BreakWhileLearning => LEARNING.1 - LEARNING.0,
            _ if self.begins() == Begins::AtStart => RAMP,
            _ => 0.0,
        }
    }

    /// When it begins in its own trial.
    pub fn begins(self) -> Begins {
        match self {
            Self::GainFromStart(_)
            | Self::NeverConnected(_)
            | Self::ReversedFromStart(_)
            | Self::SwappedFromStart
            | Self::AbsentFromStart
            | Self::LawWrong => Begins::AtStart,
            Self::BreakWhileLearning => Begins::WhileLearning,
            Self::TemperatureNanAtCycleEnd => Begins::AtCycleEnd,
            Self::BreakInShortBlocks => Begins::InShortBlock,
            _ => Begins::Later,
        }
    }

    /// Whether it is a slow change that differs from the run-in only by being later.
    pub(super) fn is_after_run_in(self) -> bool {
        matches!(
            self,
            Self::GainDrift(_) | Self::WiresOneByOne | Self::Backlash
        )
    }

    /// Why a single channel per quantity, without a read-back, cannot show it; `None` if it can.
    pub fn hidden(self) -> Option<&'static str> {
        const OWN_GAIN: &str =
            "one channel cannot show its own constant gain; only a law known beforehand would";
        match self {
            Self::GainFromStart(_) => Some(OWN_GAIN),
            Self::GainDrift(Displacement) | Self::GainDriftInRunIn(Displacement) => Some(
                "the rig drives what the channel shows, so that a slow drift of its gain looks like a specimen that settles",
            ),
            Self::EnableStuckHigh => {
                Some("without a read-back a line that stays high shows only when it should drop")
            }
            Self::Ringing(_) => Some("it changes nothing until a limit is exceeded"),
            Self::ControlsLost => {
                Some("the law of the campaign has no control input, and nothing measures one twice")
            }
            _ => None,
        }
    }

    /// Whether it can lead to a hazardous state or disable the protection against one. A specimen that becomes weaker cannot, nor
    /// can an actuator that is cut off.
    pub fn is_dangerous(self) -> bool {
        !matches!(
            self,
            Self::Break
                | Self::WiresOneByOne
                | Self::WiresInRunIn
                | Self::BreakWhileLearning
                | Self::BreakInShortBlocks
                | Self::Wear
                | Self::Backlash
                | Self::BacklashInRunIn
                | Self::Removed
                | Self::AbsentFromStart
                | Self::EnableStuckLow
        )
    }

    /// The channel that a limit depends on and that no longer shows its quantity.
    pub fn loses(self) -> Option<Channel> {
        match self {
            Self::Open(of)
            | Self::Frozen(of)
            | Self::NeverConnected(of)
            | Self::GoodOneInTen(of) => Some(of),
            _ => None,
        }
    }
}
