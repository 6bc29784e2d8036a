//! Names that several changes share: causes that the rig's signals cannot distinguish from them in principle.

use mesh_damper::health::Channel::{self, Displacement, Force};
use mesh_damper::health::HealthCause as H;
use mesh_damper::rig::TripCause as T;

/// Causes that the rig can report.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Names {
    /// By its monitor.
    health: Vec<H>,
    /// When it stops.
    trips: Vec<T>,
}

impl Names {
    pub(super) fn of(health: &[H], trips: &[T]) -> Self {
        let (health, trips) = (health.into(), trips.into());
        Self { health, trips }
    }

    /// These, or others.
    pub(super) fn or(mut self, health: &[H], trips: &[T]) -> Self {
        self.health.extend(health);
        self.trips.extend(trips);
        self
    }

    pub(super) fn has_cause(&self, cause: H) -> bool {
        self.health.contains(&cause)
    }

    pub(super) fn has_trip(&self, cause: T) -> bool {
        self.trips.contains(&cause)
    }
}

/// A channel that no longer shows its quantity.
pub(super) fn lost(channel: Channel) -> Names {
    let names = Names::of(
        &[
            H::SensorStuck(channel),
            H::SensorDroppedOut(channel),
            H::SensorClipped(channel),
            H::SensorNoisy(channel),
        ],
        &[],
    );
    match channel {
        // The rig's position loop runs away without its displacement, and reaches the limit on tracking.
        Displacement => names.or(
            &[],
            &[
                T::DisplacementLost,
                T::DisplacementClipped,
                T::NoResponse,
                T::TrackingLimit,
            ],
        ),
        // A missing specimen gives no force either.
        Force => names.or(&[H::SpecimenAbsent], &[T::ForceLost, T::ForceClipped]),
    }
}

/// Wrong samples of a channel among right ones. They may exceed its limit.
pub(super) fn outliers(channel: Channel) -> Names {
    let limit = match channel {
        Displacement => T::DisplacementLimit,
        Force => T::ForceLimit,
    };
    lost(channel).or(&[H::SensorSpiking(channel)], &[limit])
}

/// A channel with the opposite sign.
pub(super) fn reversed(channel: Channel) -> Names {
    let trips: &[T] = match channel {
        Displacement => &[
            T::TrackingLimit,
            T::DisplacementLimit,
            T::DisplacementLost,
            T::NoResponse,
        ],
        Force => &[T::ForceLost],
    };
    Names::of(&[H::SensorReversed(channel)], trips)
}

/// Each channel shows a voltage that follows the motion, with another size.
pub(super) fn swapped() -> Names {
    lost(Displacement).or(
        &[
            H::SensorGain(Displacement),
            H::SensorGain(Force),
            H::SensorReversed(Displacement),
            H::SensorReversed(Force),
            H::LawMismatch,
        ],
        &[
            T::ForceLost,
            T::ForceLimit,
            T::DisplacementLimit,
            T::CorrectionLimit,
        ],
    )
}

/// A force channel that shows more looks like a specimen that has become stiffer, and one that shows less like a specimen that has
/// broken. A displacement channel that shows more drives less, and one that shows less drives more.
pub(super) fn gain(channel: Channel, size: f64) -> Names {
    let specimen = if (channel == Force) == (size > 0.0) {
        H::Stiffening
    } else {
        H::WireBreakage
    };
    let trips: &[T] = match channel {
        Displacement => &[
            T::CorrectionLimit,
            T::TrackingLimit,
            T::NoResponse,
            T::ForceLimit,
            T::ForceClipped,
        ],
        Force => &[],
    };
    Names::of(&[H::SensorGain(channel), specimen], trips)
}

/// Less force, which a smaller gain of either channel shows too.
pub(super) fn broken() -> Names {
    Names::of(
        &[
            H::WireBreakage,
            H::SensorGain(Force),
            H::SensorGain(Displacement),
        ],
        &[],
    )
}

/// The force grows, and reaches its limit or, if the actuator yields, the limit on tracking.
pub(super) fn stiffer() -> Names {
    Names::of(
        &[
            H::Stiffening,
            H::SensorGain(Force),
            H::SensorGain(Displacement),
            H::ActuatorSaturated,
        ],
        &[T::ForceLimit, T::ForceClipped, T::TrackingLimit],
    )
}

/// A temperature that is none.
pub(super) fn temperature() -> Names {
    Names::of(&[H::TemperatureImplausible], &[T::NotFinite])
}

/// The actuator does not move as commanded, or not at all.
pub(super) fn actuator() -> Names {
    Names::of(
        &[H::ActuatorDead, H::ActuatorSaturated],
        &[T::NoResponse, T::TrackingLimit, T::DacBus, T::EnableLine],
    )
}
