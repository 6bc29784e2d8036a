//! In a close look the monitor compares one tick's motion and force with what was demanded.

use super::cause::{Channel, HealthCause};
use super::event::{Event, Statistic};
use super::places::part_end;
use super::{HealthConfig, HealthMonitor, force, moving, response, roughness, sums};
use crate::fast_law::Adaptation;
use crate::rig::TripCause;

/// Ticks per cycle below which the 32 looks do not all have a tick of their own.
const FEW_TICKS: u32 = 64;

/// One tick that is examined closely.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Observed displacement and velocity, mm and mm/s.
    pub(crate) displacement: f32,
    pub(crate) velocity: f32,
    /// Measured displacement, mm.
    pub(crate) measured: f32,
    /// Demanded displacement and velocity, mm and mm/s.
    pub(crate) demand: (f32, f32),
    /// Measured force and that of the running law, kN.
    pub(crate) force: f32,
    pub(crate) law: f32,
    /// [`crate::fast_law::RunningLaw::parts`] with adaptation, 0 otherwise.
    pub(crate) parts: [f32; 3],
    /// Phase, 2³² per cycle.
    pub(crate) phase: u32,
    /// The tick is in a ramp.
    pub(crate) ramp: bool,
}

impl HealthMonitor {
    /// Whether a tick at `phase`, 2³² per cycle, is due for a close look.
    #[inline(always)]
    pub(crate) fn is_due(&self, phase: u32) -> bool {
        // No tick is half a cycle long.
        phase.wrapping_sub(self.due) as i32 >= 0
    }

    /// Takes a close look at a tick that is due. Returns the new adaptation of the law, if a cycle has ended and adaptation is on.
    #[inline]
    pub(crate) fn look(&mut self, config: &HealthConfig, look: &Look) -> Option<Adaptation> {
        self.due = part_end(look.phase, self.cycle);
        let mut share = self.adaptation.share(look.parts);
        let mut followed = None;
        if let Some(ended) = self.ended.take() {
            // The law in this look is still that of the cycle before, unless another one has taken over.
            if ended.another_law {
                share = 0.0;
            }
            self.close_cycle(config, &ended);
        } else if self.adaptation.is_due() {
            followed = Some(self.adaptation.follow());
        } else if !look.ramp && self.response.turns(look.phase) {
            // This is enough work for one tick.
        } else {
            let turns = self.following.turns(look.phase);
            if turns {
                self.watch_force(look.phase);
            }
            // A cycle with few ticks has few looks, so one look has to do both.
            let (_, ticks) = self.motion;
            if !turns || ticks < FEW_TICKS {
                self.work(config);
            }
        }
        let (d, v) = look.demand;
        for (largest, value) in self.largest.iter_mut().zip([d, look.law]) {
            if value.abs() > *largest {
                *largest = value.abs();
            }
        }
        self.looked = look.law;
        let given = look.law - share;
        self.sums.add(&sums::Sample {
            displacement: look.displacement,
            velocity: look.velocity,
            measured: look.force,
            given,
            share,
        });
        if config.follows() {
            self.adaptation.add(look.parts, look.force - given);
        }
        if look.ramp {
            self.response.restart();
            self.watch_moving(look);
        } else if let Some(off) = self.response.update(look.measured, d, v, look.phase) {
            self.response_event(off);
        }
        // The demanded velocity: the observed one may still be settling, for instance after a broken wire.
        self.following.add(look.measured, v, look.force);
        self.watch_noise(config, look);
        followed
    }

    /// Reports a wrong response of the actuator, unless the displacement that shows it is lost, or the fault has been reported and
    /// continues.
    #[cold]
    #[inline(never)]
    fn response_event(&mut self, (mut cause, mut or, distance): response::Off) {
        // Hum also changes the shape.
        if cause == HealthCause::ActuatorSaturated && self.roughness[0].count() >= roughness::SOME {
            or = Some(HealthCause::SensorNoisy(Channel::Displacement));
        }
        // A specimen at rest gives no varying force.
        if cause == HealthCause::ActuatorDead && self.following.varies() {
            let stuck = HealthCause::SensorStuck(Channel::Displacement);
            (cause, or) = (stuck, None);
            self.stops = Some(TripCause::DisplacementLost);
        }
        let known = self.is_response_known();
        let [off, before] = &mut self.off;
        // A reported fault continues; with a lost displacement it is not reported.
        *off |= *before || !known;
        let [disturbed, _] = &mut self.disturbed;
        *disturbed = true;
        if !known {
            self.latch(Event {
                cause,
                or,
                statistic: Statistic::Response,
                value: distance,
                limit: response::LIMIT,
                cycle: self.cycle,
            });
        }
    }

    /// Takes a close look in a motion without distinct cycles: checks that the force follows the motion.
    #[inline]
    pub(crate) fn look_at_any(&mut self, look: &Look) {
        self.due = part_end(look.phase, self.cycle);
        let [least, _] = self.least_amplitudes;
        // The demanded velocity: the observed one may still be settling, for instance after a broken wire.
        let (y, (_, v), f) = (look.measured, look.demand, look.force);
        if let Some(explained) = self.following.update_any(y, v, f, 0.5 * least) {
            self.force_is_lost(explained);
        }
        self.watch_moving(look);
    }

    /// Checks that the displacement follows the demand at all.
    #[inline(never)]
    fn watch_moving(&mut self, look: &Look) {
        let [least, _] = self.least_amplitudes;
        let (d, _) = look.demand;
        let Some(part) = self.moving.update(d, look.measured, 0.5 * least) else {
            return;
        };
        self.stops = Some(TripCause::NoResponse);
        self.latch(Event {
            cause: HealthCause::ActuatorDead,
            or: Some(HealthCause::SensorStuck(Channel::Displacement)),
            statistic: Statistic::Response,
            value: part,
            limit: moving::STILL,
            cycle: self.cycle,
        });
    }

    /// Checks that the force follows the motion. It compares with the measured motion, so a lagging actuator is no excuse.
    #[inline(never)]
    fn watch_force(&mut self, phase: u32) {
        let [least, _] = self.least_amplitudes;
        if let Some(explained) = self.following.turn(phase, 0.5 * least) {
            self.force_is_lost(explained);
        }
    }

    /// The force does not follow the motion. Either the channel is at fault or there is no specimen; the data cannot tell. If the
    /// force never followed, a missing specimen is more likely.
    #[cold]
    #[inline(never)]
    fn force_is_lost(&mut self, explained: f32) {
        self.stops = Some(TripCause::ForceLost);
        let both = [
            HealthCause::SpecimenAbsent,
            HealthCause::SensorDroppedOut(Channel::Force),
        ];
        let [absent, dropped] = both;
        let (cause, or) = if self.following.has_followed() {
            (dropped, absent)
        } else {
            (absent, dropped)
        };
        self.latch(Event {
            cause,
            or: Some(or),
            statistic: Statistic::Explained,
            value: explained,
            limit: force::LEAST_EXPLAINED,
            cycle: self.cycle,
        });
    }

    /// Watches for noise and hum on either channel, unless the actuator's response is off. Hum on the displacement reaches the
    /// law's force too, and then the residual says nothing about the force channel.
    fn watch_noise(&mut self, config: &HealthConfig, look: &Look) {
        let known = self.is_response_known() && !self.is_lasting();
        let (_, ticks) = self.motion;
        let [displacement, force] = &mut self.roughness;
        if look.ramp || known || ticks < roughness::LEAST_TICKS {
            displacement.interrupt();
            force.interrupt();
            return;
        }
        let learns = !self.specimen.is_watching(config);
        let [amplitude, force_amplitude] = self.amplitudes;
        let (demand, v) = look.demand;
        let noisy = displacement.update(look.measured - demand, v, amplitude, learns);
        let loud = force.update(look.force - look.law, v, force_amplitude, learns);
        if let Some(level) = noisy {
            self.noise_event(Channel::Displacement, level);
        } else if let Some(level) = loud
            && self.roughness[0].count() < roughness::SOME
        {
            self.noise_event(Channel::Force, level);
        }
    }

    #[cold]
    #[inline(never)]
    fn noise_event(&mut self, channel: Channel, level: f32) {
        let [disturbed, _] = &mut self.disturbed;
        *disturbed = true;
        self.latch(Event {
            cause: HealthCause::SensorNoisy(channel),
            or: None,
            statistic: Statistic::Noise,
            value: roughness::FACTOR * level,
            limit: level,
            cycle: self.cycle,
        });
    }

    /// Trip cause that close looks have found.
    #[inline(always)]
    pub(crate) fn stops(&self) -> Option<TripCause> {
        self.stops
    }

    /// Whether a wrong response is no news: the displacement was lost in this cycle or in the one before, or the actuator's fault
    /// has been reported.
    pub(super) fn is_response_known(&self) -> bool {
        let seen = [self.off, self.blurred];
        seen.iter().flatten().any(|seen| *seen)
    }
}
