//! Limits, and the causes for which a rig stops.

use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::{Real, in_range};

/// Why a rig stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum TripCause {
    /// Reading the sensors failed, as on the ADC's bus.
    AdcBus,
    /// The actuator did not take a command, as on the DAC's bus, or drives another one as it is read back.
    DacBus,
    /// The enable line could not be set, or is at another level as it is read back.
    EnableLine,
    /// The displacement channel is at an end of its range.
    DisplacementClipped,
    /// The force channel is at an end of its range.
    ForceClipped,
    /// The command lies beyond the actuator's range.
    CommandClipped,
    /// The measured displacement exceeded its limit.
    DisplacementLimit,
    /// The measured force exceeded its limit, or the force that an emulator was about to drive.
    ForceLimit,
    /// The measured displacement was further from the demanded one than allowed.
    TrackingLimit,
    /// Over a cycle outside the ramps, or in a ramp or a streamed motion over as long as it takes to move, the measured displacement answered
    /// with less than a tenth of the demanded amplitude: a dead actuator or a frozen sensor, at amplitudes too small for the limit on
    /// tracking. Or it answered with the opposite.
    NoResponse,
    /// A force or command was infinite or NaN.
    NotFinite,
    /// The displacement channel is stuck, dropped out or frozen.
    DisplacementLost,
    /// The force channel is stuck or dropped out, or shows a force that is none of the motion: so does a specimen that is not there.
    ForceLost,
    /// Nothing was heard over the link for too long, or nothing of a streamed motion.
    LinkLost,
    /// A tick came late, early, or not at all, as the counter that it is given says, or whoever owns the timer.
    TickOverrun,
    /// A streamed motion asked for more than the rig drives: displacement, velocity, or a way too long from knot to knot.
    DemandLimit,
    /// An input outside of this controller says stop: an emergency stop, a guard, a second controller.
    External,
    /// Amplitude's correction asks for more command than [`super::RigSettings::correction_limit`] allows: the displacement channel shows
    /// too little, or the actuator has become weak.
    CorrectionLimit,
}

/// What is allowed, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    displacement: f32,
    force: f32,
    tracking: f32,
    trip_ticks: u32,
}

/// What a tick beyond a limit adds to its count, and a tick within takes off: 1. So a limit that is exceeded for more than a ninth of the
/// time stops the rig, whatever is shown meanwhile: a bad contact, ringing, a channel that drops out.
const BEYOND: u32 = 8;
/// Part of a limit from which a tick beyond it counts [`MORE`] times: noise does not get there, and what does has to stop before the
/// channels' lag, or a channel that shows it in one tick of three, has made the trip time longer.
const CLEARLY: f32 = 1.1;
const MORE: u32 = 4;

/// How long each limit has been exceeded: [`BEYOND`] to the tick, less the ticks within it since.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Exceeded {
    /// Of displacement, force and tracking.
    counts: [u32; 3],
    /// One of them is above 0.
    any: bool,
}

/// What each count stops the rig for, the first one first.
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
    /// Fields as in [`super::RigSettings`].
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

    /// mm.
    pub(super) fn displacement(&self) -> f32 {
        self.displacement
    }

    /// mm.
    pub(super) fn tracking(&self) -> f32 {
        self.tracking
    }

    /// Of displacement and force, mm and kN.
    pub(super) fn allowed(&self) -> [f32; 2] {
        [self.displacement, self.force]
    }

    /// kN.
    pub(super) fn force(&self) -> f32 {
        self.force
    }

    /// The fault, once a limit has been exceeded for `trip_ticks` ticks on end, for a quarter as many by more than a tenth of it, or for more of
    /// them where one in nine or fewer was within it. NaN exceeds every limit clearly.
    #[inline]
    pub(super) fn check(
        &self,
        exceeded: &mut Exceeded,
        displacement: f32,
        force: f32,
        tracking_error: f32,
    ) -> Option<TripCause> {
        // A NaN is within none.
        let within = displacement.abs() <= self.displacement
            && force.abs() <= self.force
            && tracking_error.abs() <= self.tracking;
        if within && !exceeded.any {
            return None;
        }
        self.count(exceeded, [displacement, force, tracking_error])
    }

    /// What a tick makes of the counts in which one of them is not 0, or will not be.
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

/// A channel at an end of its range.
pub(super) fn clipped(reading: &super::io::Reading) -> Option<TripCause> {
    if reading.displacement.clipped() {
        Some(TripCause::DisplacementClipped)
    } else if reading.force.clipped() {
        Some(TripCause::ForceClipped)
    } else {
        None
    }
}
