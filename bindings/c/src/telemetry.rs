//! The telemetry of a rig and a damper emulation at each tick.

use core::ffi::{CStr, c_char};

use mesh_damper::health::HealthCause;
use mesh_damper::rig;

use crate::cycle::Cycle;
use crate::law::MD_CONTROLS;

/// The state of a controller.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Enable line low, command at 0 or on its way there.
    Idle = 0,
    /// Enable line high, command as controlled.
    Running = 1,
    /// The programme has ended; otherwise like MD_STATE_IDLE.
    Done = 2,
    /// Stopped by a trip until it is cleared; otherwise like MD_STATE_IDLE.
    Faulted = 3,
}

/// Trip causes of a controller. The numbers do not change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TripCause {
    /// Not stopped by a trip.
    None = 0,
    /// Reading the sensors failed.
    AdcBus = 1,
    /// The actuator did not accept a command.
    DacBus = 2,
    /// The enable line could not be set.
    EnableLine = 3,
    /// The displacement channel is at an end of its range.
    DisplacementClipped = 4,
    /// The force channel is at an end of its range.
    ForceClipped = 5,
    /// The command lies beyond the actuator's range.
    CommandClipped = 6,
    /// The measured displacement exceeded its limit.
    DisplacementLimit = 7,
    /// The measured force exceeded its limit, or the force that an emulation was about to drive.
    ForceLimit = 8,
    /// The measured displacement was further from the demanded one than allowed.
    TrackingLimit = 9,
    /// Over a cycle outside the ramps, the displacement responded with less than a tenth of the demanded amplitude.
    NoResponse = 10,
    /// A force or a command was infinite or NaN.
    NotFinite = 11,
    /// The displacement channel is stuck or dropped out.
    DisplacementLost = 12,
    /// The force channel is stuck or dropped out.
    ForceLost = 13,
    /// Nothing was heard over the link for too long.
    LinkLost = 14,
    /// A tick was late or missing.
    TickOverrun = 15,
    /// A motion demanded more than the rig drives.
    DemandLimit = 16,
    /// An external stop input is active.
    External = 17,
    /// The amplitude correction asks for more command than is allowed.
    CorrectionLimit = 18,
    /// A cause that this library has no number for.
    Other = 99,
}

impl From<rig::TripCause> for TripCause {
    fn from(cause: rig::TripCause) -> Self {
        match cause {
            rig::TripCause::AdcBus => Self::AdcBus,
            rig::TripCause::DacBus => Self::DacBus,
            rig::TripCause::EnableLine => Self::EnableLine,
            rig::TripCause::DisplacementClipped => Self::DisplacementClipped,
            rig::TripCause::ForceClipped => Self::ForceClipped,
            rig::TripCause::CommandClipped => Self::CommandClipped,
            rig::TripCause::DisplacementLimit => Self::DisplacementLimit,
            rig::TripCause::ForceLimit => Self::ForceLimit,
            rig::TripCause::TrackingLimit => Self::TrackingLimit,
            rig::TripCause::NoResponse => Self::NoResponse,
            rig::TripCause::NotFinite => Self::NotFinite,
            rig::TripCause::DisplacementLost => Self::DisplacementLost,
            rig::TripCause::ForceLost => Self::ForceLost,
            rig::TripCause::LinkLost => Self::LinkLost,
            rig::TripCause::TickOverrun => Self::TickOverrun,
            rig::TripCause::DemandLimit => Self::DemandLimit,
            rig::TripCause::External => Self::External,
            rig::TripCause::CorrectionLimit => Self::CorrectionLimit,
            _ => Self::Other,
        }
    }
}

const TRIPS: [(TripCause, &CStr); 20] = [
    (TripCause::None, c"MD_TRIP_NONE"),
    (TripCause::AdcBus, c"MD_TRIP_ADC_BUS"),
    (TripCause::DacBus, c"MD_TRIP_DAC_BUS"),
    (TripCause::EnableLine, c"MD_TRIP_ENABLE_LINE"),
    (
        TripCause::DisplacementClipped,
        c"MD_TRIP_DISPLACEMENT_CLIPPED",
    ),
    (TripCause::ForceClipped, c"MD_TRIP_FORCE_CLIPPED"),
    (TripCause::CommandClipped, c"MD_TRIP_COMMAND_CLIPPED"),
    (TripCause::DisplacementLimit, c"MD_TRIP_DISPLACEMENT_LIMIT"),
    (TripCause::ForceLimit, c"MD_TRIP_FORCE_LIMIT"),
    (TripCause::TrackingLimit, c"MD_TRIP_TRACKING_LIMIT"),
    (TripCause::NoResponse, c"MD_TRIP_NO_RESPONSE"),
    (TripCause::NotFinite, c"MD_TRIP_NOT_FINITE"),
    (TripCause::DisplacementLost, c"MD_TRIP_DISPLACEMENT_LOST"),
    (TripCause::ForceLost, c"MD_TRIP_FORCE_LOST"),
    (TripCause::LinkLost, c"MD_TRIP_LINK_LOST"),
    (TripCause::TickOverrun, c"MD_TRIP_TICK_OVERRUN"),
    (TripCause::DemandLimit, c"MD_TRIP_DEMAND_LIMIT"),
    (TripCause::External, c"MD_TRIP_EXTERNAL"),
    (TripCause::CorrectionLimit, c"MD_TRIP_CORRECTION_LIMIT"),
    (TripCause::Other, c"MD_TRIP_OTHER"),
];

/// The name of a trip cause as in this header, such as `"MD_TRIP_FORCE_LIMIT"`; `"?"` for any other number. It ends in NUL and is
/// never null.
#[unsafe(no_mangle)]
pub extern "C" fn md_trip_name(trip: i32) -> *const c_char {
    let named = TRIPS.iter().find(|(cause, _)| *cause as i32 == trip);
    named.map_or(c"?", |(_, name)| *name).as_ptr()
}

/// A finding of a rig's monitor: the number of a health cause, as on the link. The header gets its constants from the crate's list.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HealthEvent(pub i32);

impl From<HealthCause> for HealthEvent {
    fn from(cause: HealthCause) -> Self {
        Self(cause.number().into())
    }
}

/// One tick of a controller.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Telemetry {
    /// Number of ticks since the initialisation, including this one.
    pub tick: u64,
    /// Measured displacement, mm; the last value if reading failed.
    pub displacement: f32,
    /// Observed velocity, mm/s.
    pub velocity: f32,
    /// Measured force, kN; the last value if reading failed.
    pub measured_force: f32,
    /// Control inputs as given to the law; the last values if reading failed.
    pub controls: [f32; MD_CONTROLS],
    /// Force of the law at the observed motion, kN.
    pub model_force: f32,
    /// Command for the actuator until the next tick: mm, or kN for an emulation.
    pub command: f32,
    /// Block of the programme; 0 for an emulation.
    pub block: u32,
    /// Number of cycles completed.
    pub cycle: u32,
    /// Phase of the current cycle, 2^32 per cycle.
    pub phase: u32,
    /// State after this tick.
    pub state: State,
    /// Trip cause, for MD_STATE_FAULTED.
    pub trip: TripCause,
    /// Level of the enable line.
    pub enabled: bool,
    /// Whether the tick is in a ramp of the programme.
    pub ramp: bool,
    /// Whether a cycle ended with this tick; the next three fields belong to it.
    pub has_cycle: bool,
    /// Results of that cycle with the measured force.
    pub measured: Cycle,
    /// Results of that cycle with the law's force.
    pub model: Cycle,
    /// RMS of the law's error over the RMS of the measured force.
    pub nrmse: f32,
    /// Whether the monitor reports an event at this tick, in `event` and its numbers. Never for an emulation.
    pub has_event: bool,
    /// The reported cause.
    pub event: HealthEvent,
    /// Whether `event_or` is another possible cause that the signals cannot distinguish.
    pub has_event_or: bool,
    /// The other possible cause.
    pub event_or: HealthEvent,
    /// Change of the monitored quantity.
    pub event_value: f32,
    /// Permitted change.
    pub event_limit: f32,
}

impl From<rig::State> for State {
    fn from(state: rig::State) -> Self {
        match state {
            rig::State::Idle => Self::Idle,
            rig::State::Running => Self::Running,
            rig::State::Done => Self::Done,
            rig::State::Faulted(_) => Self::Faulted,
        }
    }
}

impl From<&rig::Telemetry> for Telemetry {
    fn from(seen: &rig::Telemetry) -> Self {
        let report = seen.report.as_ref();
        let cycle = |of: fn(&rig::CycleReport) -> &mesh_damper::cycle::Cycle| {
            report
                .map(|report| Cycle::from(of(report)))
                .unwrap_or_default()
        };
        let event = seen.event.as_ref();
        Self {
            tick: seen.tick,
            displacement: seen.displacement,
            velocity: seen.velocity,
            measured_force: seen.measured_force,
            controls: seen.controls,
            model_force: seen.model_force,
            command: seen.command,
            block: seen.block as u32,
            cycle: seen.cycle,
            phase: seen.phase,
            state: seen.state.into(),
            trip: match seen.state {
                rig::State::Faulted(cause) => cause.into(),
                _ => TripCause::None,
            },
            enabled: seen.to_drive().enabled,
            ramp: seen.ramp,
            has_cycle: report.is_some(),
            measured: cycle(|report| &report.measured),
            model: cycle(|report| &report.model),
            nrmse: report.map_or(0.0, |report| report.nrmse),
            has_event: event.is_some(),
            event: event
                .map_or(HealthCause::Unexplained, |event| event.cause)
                .into(),
            has_event_or: event.is_some_and(|event| event.or.is_some()),
            event_or: event
                .and_then(|event| event.or)
                .unwrap_or(HealthCause::Unexplained)
                .into(),
            event_value: event.map_or(0.0, |event| event.value),
            event_limit: event.map_or(0.0, |event| event.limit),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_events_are_those_of_the_link() {
        for cause in HealthCause::ALL {
            assert_eq!(HealthEvent::from(cause).0, i32::from(cause.number()));
        }
    }
}
