//! Correct names of an attack: all causes that the rig's signals cannot distinguish from it in principle.

use mesh_damper::health::{Channel, HealthCause};
use mesh_damper::rig::TripCause;

use super::kind::AttackKind;

/// A cause that the rig can report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Name {
    /// A health cause, reported by its monitor.
    Health(HealthCause),
    /// A trip cause.
    Trip(TripCause),
}

fn health<const N: usize>(causes: [HealthCause; N]) -> Vec<Name> {
    causes.map(Name::Health).into()
}

fn trips<const N: usize>(causes: [TripCause; N]) -> Vec<Name> {
    causes.map(Name::Trip).into()
}

/// A channel that no longer shows its quantity.
fn lost(channel: Channel) -> Vec<Name> {
    let mut names = health([
        HealthCause::SensorStuck(channel),
        HealthCause::SensorDroppedOut(channel),
        HealthCause::SensorClipped(channel),
        HealthCause::SensorNoisy(channel),
    ]);
    names.extend(match channel {
        // The rig's position loop runs away without its displacement, and reaches the limit on tracking.
        Channel::Displacement => trips([
            TripCause::DisplacementLost,
            TripCause::DisplacementClipped,
            TripCause::NoResponse,
            TripCause::TrackingLimit,
        ]),
        Channel::Force => trips([TripCause::ForceLost, TripCause::ForceClipped]),
    });
    // A missing specimen gives no force either.
    if channel == Channel::Force {
        names.extend(health([HealthCause::SpecimenAbsent]));
    }
    names
}

/// Wrong samples of a channel among right ones. They may exceed its limit.
fn outliers(channel: Channel) -> Vec<Name> {
    let mut names = lost(channel);
    names.extend(health([HealthCause::SensorSpiking(channel)]));
    names.extend(match channel {
        Channel::Displacement => trips([TripCause::DisplacementLimit]),
        Channel::Force => trips([TripCause::ForceLimit]),
    });
    names
}

/// The force grows, and reaches its limit or, if the actuator yields, the limit on tracking.
fn stiffer() -> Vec<Name> {
    let mut names = health([
        HealthCause::Stiffening,
        HealthCause::SensorGain(Channel::Force),
        HealthCause::SensorGain(Channel::Displacement),
        HealthCause::ActuatorSaturated,
    ]);
    names.extend(trips([
        TripCause::ForceLimit,
        TripCause::ForceClipped,
        TripCause::TrackingLimit,
    ]));
    names
}

/// A force channel that shows more looks like a specimen that has become stiffer, and one that shows less like a specimen that has
/// broken. A displacement channel that shows more drives less, and one that shows less drives more.
fn gain(channel: Channel, size: f64) -> Vec<Name> {
    let mut names = health([HealthCause::SensorGain(channel)]);
    names.extend(if (channel == Channel::Force) == (size > 0.0) {
        health([HealthCause::Stiffening])
    } else {
        health([HealthCause::WireBreakage])
    });
    if channel == Channel::Displacement {
        names.extend(trips([
            TripCause::CorrectionLimit,
            TripCause::TrackingLimit,
            TripCause::NoResponse,
            TripCause::ForceLimit,
            TripCause::ForceClipped,
        ]));
    }
    names
}

/// The actuator does not move as commanded, or not at all.
fn actuator() -> Vec<Name> {
    let mut names = health([HealthCause::ActuatorDead, HealthCause::ActuatorSaturated]);
    names.extend(trips([
        TripCause::NoResponse,
        TripCause::TrackingLimit,
        TripCause::DacBus,
        TripCause::EnableLine,
    ]));
    names
}

impl AttackKind {
    /// Its correct names at this size.
    pub fn names(self, size: f64) -> Vec<Name> {
        use HealthCause as H;
        match self {
            Self::GainStep(of) | Self::GainDrift(of) | Self::GainDriftInRunIn(of) => gain(of, size),
            Self::GainFromStart(of) => {
                let mut names = gain(of, size);
                names.extend(health([H::LawMismatch]));
                names
            }
            Self::Open(of) | Self::Frozen(of) | Self::NeverConnected(of) => lost(of),
            Self::DropOuts(of)
            | Self::Bursts(of)
            | Self::ZeroOneInTen(of)
            | Self::GoodOneInTen(of)
            | Self::Spike(of)
            | Self::StuckBit(of) => outliers(of),
            Self::Hum(of) => health([H::SensorNoisy(of)]),
            Self::Reversed(of) | Self::ReversedFromStart(of) => {
                let mut names = health([H::SensorReversed(of)]);
                names.extend(match of {
                    Channel::Displacement => trips([
                        TripCause::TrackingLimit,
                        TripCause::DisplacementLimit,
                        TripCause::DisplacementLost,
                        TripCause::NoResponse,
                    ]),
                    Channel::Force => trips([TripCause::ForceLost]),
                });
                names
            }
            // A limit that is really exceeded.
            Self::Ringing(_) => trips([TripCause::ForceLimit, TripCause::DisplacementLimit]),
            // Each channel shows a voltage that follows the motion, with another size.
            Self::Swapped | Self::SwappedFromStart => {
                let (displacement, force) = (Channel::Displacement, Channel::Force);
                let mut names = lost(displacement);
                names.extend(trips([
                    TripCause::ForceLost,
                    TripCause::ForceLimit,
                    TripCause::DisplacementLimit,
                    TripCause::CorrectionLimit,
                ]));
                names.extend(health([
                    H::SensorGain(displacement),
                    H::SensorGain(force),
                    H::SensorReversed(displacement),
                    H::SensorReversed(force),
                    H::LawMismatch,
                ]));
                names
            }
            Self::Break | Self::WiresOneByOne | Self::WiresInRunIn => health([
                H::WireBreakage,
                H::SensorGain(Channel::Force),
                H::SensorGain(Channel::Displacement),
            ]),
            Self::BreakWhileLearning | Self::BreakInShortBlocks => health([
                H::WireBreakage,
                H::SensorGain(Channel::Force),
                H::SensorGain(Channel::Displacement),
                H::LawMismatch,
            ]),
            Self::Wear => health([H::FrictionWear]),
            Self::Preload => health([H::PreloadShift, H::SensorDrifting(Channel::Force)]),
            Self::Backlash | Self::BacklashInRunIn => health([H::Loosening]),
            Self::Seized | Self::Stiffened => stiffer(),
            // A specimen that is stiffer only does not look like a gain of the force. If friction hardly depends on velocity, it
            // may look like a gain of the displacement.
            Self::Stiffer => health([H::Stiffening, H::SensorGain(Channel::Displacement)]),
            Self::Removed | Self::AbsentFromStart => {
                let mut names = lost(Channel::Force);
                names.extend(health([H::WireBreakage]));
                names
            }
            Self::FrictionRise => health([H::FrictionRise]),
            Self::NegativeDamping => health([H::FrictionWear]),
            Self::LawWrong => health([
                H::LawMismatch,
                H::SensorGain(Channel::Force),
                H::SensorGain(Channel::Displacement),
            ]),
            Self::TemperatureNan
            | Self::TemperatureNanAtCycleEnd
            | Self::TemperatureOpen
            | Self::TemperatureJump
            | Self::TemperatureNoise
            | Self::TemperatureInfinite => {
                let mut names = health([H::TemperatureImplausible]);
                names.extend(trips([TripCause::NotFinite]));
                names
            }
            Self::ControlsLost => trips([TripCause::NotFinite]),
            // A sudden motion of half the size also looks like a displacement channel of half the gain.
            Self::DacGain => {
                let mut names = actuator();
                names.extend(trips([TripCause::CorrectionLimit]));
                names.extend(health([
                    H::SensorGain(Channel::Displacement),
                    H::ActuatorLagging,
                ]));
                names
            }
            Self::DacBrownOut
            | Self::DacHolds
            | Self::ServoDead
            | Self::EnableStuckLow
            | Self::EnableStuckHigh => actuator(),
            Self::HalfRate | Self::Stall | Self::LostTicks => trips([TripCause::TickOverrun]),
            Self::LinkSilent => trips([TripCause::LinkLost]),
        }
    }
}
