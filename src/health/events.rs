//! The monitor keeps one event for each cause, until it is cleared.

use super::cause::{Channel, HealthCause};
use super::event::{Event, Statistic};
use super::pattern::reversed;
use super::{HealthMonitor, response};
use crate::rig::{Reading, TripCause};

/// Capacity for events. They are reported, and kept with their evidence until they are cleared. There is one per cause, so that no
/// event displaces another.
pub const EVENTS: usize = HealthCause::ALL.len();

impl HealthMonitor {
    /// The first event of each cause since the last [`HealthMonitor::clear`].
    pub(crate) fn events(&self) -> &[Event] {
        &self.events
    }

    /// Whether there is an event not yet reported.
    #[inline(always)]
    pub(crate) fn has_fresh(&self) -> bool {
        self.reported < self.events.len()
    }

    /// The first event not yet reported, which is then reported.
    #[inline]
    pub(crate) fn take_fresh(&mut self) -> Option<Event> {
        let event = self.events.get(self.reported).copied();
        self.reported += usize::from(event.is_some());
        event
    }

    /// Keeps the first event of each cause.
    #[cold]
    #[inline(never)]
    pub(super) fn latch(&mut self, event: Event) {
        if self.events.iter().all(|kept| kept.cause != event.cause) {
            self.is_damaged |= event.cause.is_lasting();
            // There is room for one event per cause.
            let _ = self.events.push(event);
        }
    }

    /// The rig has stopped for `fault` with a `reading`: reports the channel or actuator that is the cause. `growth` is the growth
    /// of the command that the amplitude correction asked for, minus 1.
    #[cold]
    #[inline(never)]
    pub(crate) fn stopped(&mut self, fault: TripCause, reading: &Reading, growth: f32) {
        match fault {
            TripCause::DisplacementClipped => self.sample_event(
                HealthCause::SensorClipped(Channel::Displacement),
                true,
                self.displacement.limit(),
                &reading.displacement,
            ),
            TripCause::ForceClipped => self.sample_event(
                HealthCause::SensorClipped(Channel::Force),
                true,
                self.force.limit(),
                &reading.force,
            ),
            TripCause::CorrectionLimit => self.latch(Event {
                cause: HealthCause::SensorGain(Channel::Displacement),
                or: Some(HealthCause::ActuatorLagging),
                statistic: Statistic::Response,
                value: growth,
                limit: response::LIMIT,
                cycle: self.cycle,
            }),
            TripCause::NoResponse if self.response.is_reversed() => {
                let (force, displacement) = reversed();
                self.latch(Event {
                    cause: displacement,
                    or: Some(force),
                    statistic: Statistic::Response,
                    value: 2.0,
                    limit: response::LIMIT,
                    cycle: self.cycle,
                });
            }
            TripCause::TrackingLimit | TripCause::NoResponse
                if !self.is_response_known() && self.response.is_dead() =>
            {
                self.latch(Event {
                    cause: HealthCause::ActuatorDead,
                    or: None,
                    statistic: Statistic::Response,
                    value: 1.0,
                    limit: response::LIMIT,
                    cycle: self.cycle,
                });
            }
            _ => {}
        }
    }

    /// Reports an implausible temperature: the sensor `shown` it, and the rig used `taken` in its place, °C.
    #[cold]
    #[inline(never)]
    pub(crate) fn implausible_temperature(&mut self, shown: f32, taken: f32) {
        self.latch(Event {
            cause: HealthCause::TemperatureImplausible,
            or: None,
            statistic: Statistic::Sample,
            value: shown,
            limit: taken,
            cycle: self.cycle,
        });
    }
}
