//! Limits, and the trip causes of a rig.

use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::{Real, in_range};

/// Trip cause: why a rig tripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum TripCause {
    /// Reading the sensors failed, for example on the ADC's bus.
    AdcBus,
    /// The actuator did not accept a command, for example on the DAC's bus, or its output as read back differs.
    DacBus,
    /// The enable line could not be set, or reads back at another level.
    EnableLine,
    /// The displacement channel is at an end of its range.
    DisplacementClipped,
    /// The force channel is at an end of its range.
    ForceClipped,
    /// The command lies beyond the actuator's range.
    CommandClipped,
    /// The measured displacement exceeded its limit.
    DisplacementLimit,
    /// The measured force exceeded its limit, or the force that a damper emulation was about to drive.
    ForceLimit,
    /// The measured displacement was further from the demanded one than allowed.
    TrackingLimit,
    /// The measured displacement responded with less than a tenth of the demanded amplitude, or with the opposite sign. The check
    /// covers a cycle outside the ramps, or, in a ramp or a streamed motion, the time in which the demand moves enough. The cause
    /// is a dead actuator or a frozen sensor, at amplitudes too small for the limit on tracking.
    NoResponse,
    /// A force or command was infinite or NaN.
    NotFinite,
    /// The displacement channel is stuck, dropped out or frozen.
    DisplacementLost,
    /// The force channel is stuck or dropped out, or its force does not follow the motion, as with a missing specimen.
    ForceLost,
    /// Nothing was heard over the link for too long, or a streamed motion did not continue.
    LinkLost,
    /// A tick was late, early or missing, according to its counter or to the owner of the timer.
    TickOverrun,
    /// A streamed motion asked for more than the rig drives: displacement, velocity, or the distance from knot to knot.
    DemandLimit,
    /// An external stop input is active: an emergency stop, a guard, a second controller.
    External,
    /// The amplitude correction asks for more command than [`super::RigSettings::correction_limit`] allows: the displacement
    /// channel shows too little, or the actuator has become weak.
    CorrectionLimit,
}

/// Limits, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    displacement: f32,
    force: f32,
    tracking: f32,
    trip_ticks: u32,
}

/// Increase of a count by a tick beyond its limit; a tick within it decreases the count by 1. A limit exceeded for more than a
/// ninth of the time thus trips the rig, whatever the other ticks show: a bad contact, ringing, a channel that drops out.
const BEYOND: u32 = 8;
/// Part of a limit above which a tick counts [`MORE`] times. Noise does not reach it. A value that does must trip the rig before
/// the lag of the channels, or a channel that shows it in only one tick of three, lengthens the trip time.
const CLEARLY: f32 = 1.1;
const MORE: u32 = 4;

/// Counts of exceeded limits: [`BEYOND`] per tick beyond, minus the ticks within since.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Exceeded {
    /// Counts of displacement, force and tracking.
    counts: [u32; 3],
    /// Whether one of them is above 0.
    any: bool,
}

/// Trip cause of each count, the first with precedence.
const LIMITS: [TripCause; 3] = [
    TripCause::DisplacementLimit,
    TripCause::ForceLimit,
    TripCause::TrackingLimit,
];

impl Fields for Limits {
    fn write(&self, writer: &mut Writer<'_>) {
        let floats = [self.displacement, self.force, self.tracking];
        writer.words(floats.map(f32::to_bits));
        writer.u32(self.trip_ticks);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [displacement, force, tracking] = reader.words()?.map(f32::from_bits);
        let trip_ticks = reader.u32()?;
        Self::new(displacement, force, tracking, trip_ticks).ok()
    }
}

impl Limits {
    /// The fields of [`super::RigSettings`].
    pub(super) fn new<R: Real>(
        displacement: R,
        force: R,
        tracking: R,
        trip_ticks: u32,
    ) -> Result<Self, ConfigError> {
        in_range("trip_ticks", f64::from(trip_ticks), 1.0, 1e6)?;
        Ok(Self {
            displacement: in_range("displacement_limit", displacement, 1e-6, 1e4)?.to_f64() as f32,
            force: in_range("force_limit", force, 1e-6, 1e9)?.to_f64() as f32,
            tracking: in_range("tracking_limit", tracking, 1e-6, 1e4)?.to_f64() as f32,
            trip_ticks,
        })
    }

    /// Limit of the displacement, mm.
    pub(super) fn displacement(&self) -> f32 {
        self.displacement
    }

    /// Limit of the tracking error, mm.
    pub(super) fn tracking(&self) -> f32 {
        self.tracking
    }

    /// Limits of displacement and force, mm and kN.
    pub(super) fn allowed(&self) -> [f32; 2] {
        [self.displacement, self.force]
    }

    /// Limit of the force, kN.
    pub(super) fn force(&self) -> f32 {
        self.force
    }

    /// The trip cause, once the count of a limit reaches that of `trip_ticks` ticks beyond it. A quarter of them is enough for an
    /// excess of more than a tenth; each tick within the limit takes back an eighth of one. NaN clearly exceeds every limit.
    #[inline]
    pub(super) fn check(
        &self,
        exceeded: &mut Exceeded,
        displacement: f32,
        force: f32,
        tracking_error: f32,
    ) -> Option<TripCause> {
        // NaN is within no limit.
        let within = displacement.abs() <= self.displacement
            && force.abs() <= self.force
            && tracking_error.abs() <= self.tracking;
        if within && !exceeded.any {
            return None;
        }
        self.count(exceeded, [displacement, force, tracking_error])
    }

    /// Updates the counts when one of them is not 0, or will not be.
    #[cold]
    #[inline(never)]
    fn count(&self, exceeded: &mut Exceeded, values: [f32; 3]) -> Option<TripCause> {
        exceeded.any = false;
        let mut cause = None;
        let limits = [self.displacement, self.force, self.tracking];
        let counts = exceeded.counts.iter_mut().zip(values);
        for ((count, value), (limit, tripped)) in counts.zip(limits.into_iter().zip(LIMITS)) {
            let value = value.abs();
            *count = if value <= limit {
                count.saturating_sub(1)
            } else if value <= CLEARLY * limit {
                count.saturating_add(BEYOND)
            } else {
                count.saturating_add(MORE * BEYOND)
            };
            exceeded.any |= *count > 0;
            if cause.is_none() && *count >= BEYOND * self.trip_ticks {
                cause = Some(tripped);
            }
        }
        cause
    }
}

/// Trip cause of a channel at an end of its range.
pub(super) fn clipped(reading: &super::io::Reading) -> Option<TripCause> {
    if reading.displacement.clipped() {
        Some(TripCause::DisplacementClipped)
    } else if reading.force.clipped() {
        Some(TripCause::ForceClipped)
    } else {
        None
    }
}
