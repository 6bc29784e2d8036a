//! Trips, in words.

use mesh_damper::rig::TripCause;
use schemars::JsonSchema;
use serde::Serialize;

use crate::commands::Failure;

/// The time and the cause of a trip.
#[derive(JsonSchema, Serialize)]
pub struct Stop {
    /// Time since the start, s.
    pub time: f64,
    /// The trip cause, in words.
    pub fault: String,
}

impl Stop {
    /// The stop by `fault` at `time`, s.
    pub fn new((time, fault): (f64, TripCause)) -> Self {
        Self {
            time,
            fault: in_words(fault).to_owned(),
        }
    }

    pub fn failure(&self) -> Failure {
        Failure::Check(format!(
            "the rig tripped {:.3} s after its start: {}",
            self.time, self.fault
        ))
    }
}

/// The trip cause, in words.
pub fn in_words(fault: TripCause) -> &'static str {
    match fault {
        TripCause::AdcBus => "the ADC did not answer",
        TripCause::DacBus => "the DAC did not answer",
        TripCause::EnableLine => "the enable line could not be set",
        TripCause::DisplacementClipped => "the displacement channel is at an end of its range",
        TripCause::ForceClipped => "the force channel is at an end of its range",
        TripCause::CommandClipped => "the command is beyond the DAC's range",
        TripCause::DisplacementLimit => "the displacement exceeded its limit",
        TripCause::ForceLimit => "the force exceeded its limit",
        TripCause::TrackingLimit => "the displacement was too far from the demanded one",
        TripCause::NoResponse => "the displacement did not follow the demanded one",
        TripCause::NotFinite => "a force or command was not finite",
        TripCause::DisplacementLost => "the displacement sensor is lost",
        TripCause::ForceLost => "the force sensor is lost",
        TripCause::LinkLost => "the link was silent for too long",
        TripCause::TickOverrun => "a tick came late",
        TripCause::DemandLimit => "the streamed motion exceeded the limits of the rig",
        TripCause::External => "an external input requested the stop",
        TripCause::CorrectionLimit => {
            "the amplitude correction asked for more command than allowed"
        }
        _ => "an unknown trip cause",
    }
}
