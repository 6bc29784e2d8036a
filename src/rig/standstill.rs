//! Standstill and plausibility of a damper emulation.
//!
//! - **Rest.** At standstill a channel's noise makes c·|v|^α·sgn v a force of c·(its velocity)^α that changes sign with each
//!   sample. A displacement that has stayed within a band for a while is therefore at rest, and its velocity is taken as 0 until it
//!   leaves the band. The band follows it, with a time constant of [`REST`].
//! - **A frozen channel.** Every live channel has noise in its last bit. A channel that repeats the same code for too long is
//!   stuck.
//! - **A dead actuator.** The measured force is compared with the command of the tick before. A tick whose difference exceeds
//!   [`MISSED`] of the command and [`LEAST_MISSED`] of the limit increases a count by 1, and any other tick decreases it by 1.

use super::fault::TripCause;
use super::io::Reading;
use crate::error::ConfigError;
use crate::real::in_range;

/// Time of standstill after which the displacement is at rest, s. At the reversal of a motion of A at ω the displacement stays
/// within ±b for 4·√(b/A)/ω: 14 ms for 0.1 mm at 3 Hz with the usual band.
const REST: f64 = 0.05;
/// Permitted difference of the measured force, as parts of the command and of the force's limit.
const MISSED: f32 = 0.7;
const LEAST_MISSED: f32 = 0.02;
/// Time of too large a difference after which the actuator is dead, s. An actuator with a phase lag of 40° has such a difference
/// for 4 ticks in 10 of a sine.
const DEAD: f64 = 0.1;

/// The relevant [`super::DamperEmulationSettings`], at a tick rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct StandstillConfig {
    /// Half width, mm; 0 without a rest band.
    band: f32,
    rest_ticks: u32,
    /// Part of the distance by which the middle of the band follows per tick, so that the noise of a displacement that comes to
    /// rest near the edge does not take it out of the band.
    follow: f32,
    /// 0 if the channel is not checked.
    stuck_ticks: u32,
    dead_ticks: u32,
    least_missed: f32,
}

impl StandstillConfig {
    pub(super) fn new(
        tick_rate: f64,
        rest_band: f64,
        stuck_ticks: u32,
        force_limit: f32,
    ) -> Result<Self, ConfigError> {
        in_range("stuck_ticks", f64::from(stuck_ticks), 0.0, 1e9)?;
        let ticks = |seconds: f64| (seconds * tick_rate) as u32 + 1;
        Ok(Self {
            band: in_range("rest_band", rest_band, 0.0, 1e4)? as f32,
            rest_ticks: ticks(REST),
            follow: (1.0 / (1.0 + REST * tick_rate)) as f32,
            stuck_ticks,
            dead_ticks: ticks(DEAD),
            least_missed: LEAST_MISSED * force_limit,
        })
    }
}

/// State of the checks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Standstill {
    /// Middle of the band that contains the displacement, mm, and the number of ticks for which it has.
    middle: f32,
    still: u32,
    code: u16,
    held: u32,
    missed: u32,
}

impl Standstill {
    /// Whether the observed displacement, mm, is at rest.
    #[inline]
    pub(super) fn rests(&mut self, config: &StandstillConfig, displacement: f32) -> bool {
        let away = displacement - self.middle;
        if away.abs() < config.band {
            self.middle += config.follow * away;
            self.still = self.still.saturating_add(1);
        } else {
            self.middle = displacement;
            self.still = 0;
        }
        self.still >= config.rest_ticks
    }

    /// Checks one tick of a running emulation, in kN; returns the trip cause, if there is one.
    #[inline]
    pub(super) fn check(
        &mut self,
        config: &StandstillConfig,
        reading: &Reading,
        command: f32,
    ) -> Option<TripCause> {
        let code = reading.displacement.code;
        self.held = if code == self.code {
            self.held.saturating_add(1)
        } else {
            0
        };
        self.code = code;
        if config.stuck_ticks > 0 && self.held >= config.stuck_ticks {
            return Some(TripCause::DisplacementLost);
        }
        let missed = (reading.force.value - command).abs();
        self.missed = if missed > MISSED * command.abs() && missed > config.least_missed {
            self.missed + 1
        } else {
            self.missed.saturating_sub(1)
        };
        (self.missed >= config.dead_ticks).then_some(TripCause::NoResponse)
    }

    /// The emulation starts: earlier differences do not count.
    pub(super) fn restart(&mut self) {
        self.held = 0;
        self.missed = 0;
    }
}
