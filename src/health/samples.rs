//! On every tick the monitor examines the samples of a channel that stand still or jump.

use super::HealthMonitor;
use super::cause::{Channel, HealthCause};
use super::channel::{Beside, Change};
use super::event::{Event, Statistic};
use crate::converter::Sample;
use crate::rig::Reading;

impl HealthMonitor {
    /// Call it on every tick: compares a `reading` with the `last` codes of displacement and force. If a change asks for it, call
    /// [`HealthMonitor::channels`].
    #[inline(always)]
    pub(crate) fn samples(
        &mut self,
        [displacement, force]: [u16; 2],
        reading: &Reading,
    ) -> [Change; 2] {
        [
            self.displacement
                .update(displacement, &reading.displacement),
            self.force.update(force, &reading.force),
        ]
    }

    /// Examines the channels whose changes ask for it, with the demanded displacement in mm and the law's force in kN, which may be
    /// those of the tick before. Returns the channel that is lost, reported or not.
    #[inline(never)]
    pub(crate) fn channels(
        &mut self,
        reading: &Reading,
        changes: &[Change; 2],
        demand: f32,
        law: f32,
    ) -> Option<Channel> {
        let [amplitude, force_amplitude] = core::array::from_fn(|of| {
            let (before, now) = (self.amplitudes[of], self.largest[of]);
            if now > before { now } else { before }
        });
        let beside = |reference, amplitude_of_it| Beside {
            reference,
            amplitude: amplitude_of_it,
            motion: demand,
            motion_amplitude: amplitude,
        };
        let [of_displacement, of_force] = changes;
        let displacement = if of_displacement.asks() {
            let beside = beside(demand, amplitude);
            self.displacement
                .look(&reading.displacement, of_displacement, &beside)
        } else {
            None
        };
        let force = if of_force.asks() {
            let beside = beside(law, force_amplitude);
            self.force.look(&reading.force, of_force, &beside)
        } else {
            None
        };
        // If nothing moves, both channels may stand still without a fault.
        let both = 2 * self.force.held() > self.displacement.held();
        let stuck = HealthCause::SensorStuck(Channel::Displacement);
        let displacement = displacement.filter(|cause| *cause != stuck || !both);
        // A spike is found one tick late.
        let taken = law == self.looked;
        if let Some(cause) = displacement {
            if taken {
                self.response.skip_last();
            }
            self.sample_event(
                cause,
                taken,
                self.displacement.limit(),
                &reading.displacement,
            );
        }
        if let Some(cause) = force {
            self.sample_event(cause, taken, self.force.limit(), &reading.force);
        }
        [displacement, force]
            .into_iter()
            .flatten()
            .find_map(|cause| match cause {
                HealthCause::SensorStuck(channel) | HealthCause::SensorDroppedOut(channel) => {
                    Some(channel)
                }
                _ => None,
            })
    }

    /// `taken`: a close look took the sample of the spike.
    #[cold]
    #[inline(never)]
    pub(super) fn sample_event(
        &mut self,
        cause: HealthCause,
        taken: bool,
        limit: f32,
        sample: &Sample,
    ) {
        let ([disturbed, _], [blurred, _]) = (&mut self.disturbed, &mut self.blurred);
        *disturbed |= taken || !matches!(cause, HealthCause::SensorSpiking(_));
        *blurred |= cause.hides(Channel::Displacement);
        self.latch(Event {
            cause,
            or: None,
            statistic: Statistic::Sample,
            value: sample.value,
            limit,
            cycle: self.cycle,
        });
    }
}
