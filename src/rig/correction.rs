//! From demanded to commanded displacement: gain and lead, corrected from cycle to cycle, and integral feedback.
//!
//! command = p·d + q·v + i, with d and v the generator's displacement and velocity: as v = jω·d in a sine, C = p + jω·q
//! is the actuator's inverse at ω. A dead time or a slow loop makes q about the same at all frequencies, so that it
//! carries over from block to block and through a sweep.
//!
//! Over each cycle the measured displacement y is demodulated against d and v,
//!
//! - Y = a + jω·b, a = Σy·d/Σd², b = Σy·v/Σv², ω² = Σv²/Σd²
//! - C ← C + gain·(1 − Y)·C/Y
//!
//! which would be right at once with gain 1 if the actuator were linear, C/Y being its inverse. p and q glide to their
//! new values, so that the command has no step. Ramps are left out: there y lags in amplitude too.
//!
//! i ← i + feedback·h·(d − y) holds the mean, where friction, leakage and sensors would let it drift.

use super::fault::TripCause;
use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::{Real, in_range};
use crate::sine::Excitation;
use crate::sum::{FOLD, Sum};

/// p stays in `1/GAIN_LIMIT..=GAIN_LIMIT`.
const GAIN_LIMIT: f32 = 5.0;
/// q stays within ± this, s.
const LEAD_LIMIT: f32 = 0.1;
/// A response smaller than this part of the demand is no basis for a correction: a sensor or an actuator is dead.
const RESPONSE_MIN: f32 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CorrectionConfig {
    gain: f32,
    lead: f32,
    glide: f32,
    feedback_step: f32,
    feedback_limit: f32,
    /// Smallest mean square of the demand that is demodulated, mm².
    demand_min: f32,
}

impl Fields for CorrectionConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        let floats = [
            self.gain,
            self.lead,
            self.glide,
            self.feedback_step,
            self.feedback_limit,
            self.demand_min,
        ];
        writer.words(floats.map(f32::to_bits));
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [gain, lead, glide, feedback_step, feedback_limit, demand_min] =
            reader.words()?.map(f32::from_bits);
        Some(Self {
            gain,
            lead,
            glide,
            feedback_step,
            feedback_limit,
            demand_min,
        })
    }
}

impl CorrectionConfig {
    /// Fields as in [`super::RigSettings`]; `displacement_limit` in mm bounds the feedback.
    pub(super) fn new(
        tick_rate: f64,
        gain: f64,
        lead: f64,
        glide: f64,
        feedback: f64,
        displacement_limit: f32,
    ) -> Result<Self, ConfigError> {
        in_range("glide", glide, 1.0 / tick_rate, 10.0)?;
        Ok(Self {
            gain: in_range("correction_gain", gain, 0.0, 1.0)? as f32,
            lead: in_range("lead", lead, 0.0, f64::from(LEAD_LIMIT))? as f32,
            glide: (1.0 / (glide * tick_rate)) as f32,
            feedback_step: (in_range("feedback", feedback, 0.0, 0.01 * tick_rate)? / tick_rate)
                as f32,
            feedback_limit: displacement_limit,
            demand_min: (1e-3 * displacement_limit) * (1e-3 * displacement_limit),
        })
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Correction {
    /// p and q as they glide, and where to.
    in_phase: f32,
    lead: f32,
    in_phase_target: f32,
    lead_target: f32,
    integral: f32,
    demand_square: Sum,
    rate_square: Sum,
    response_demand: Sum,
    response_rate: Sum,
    ticks: u32,
    /// The cycle under way has been steady from its beginning.
    steady: bool,
}

impl Correction {
    pub(super) fn new(config: &CorrectionConfig) -> Self {
        Self {
            in_phase: 1.0,
            lead: config.lead,
            in_phase_target: 1.0,
            lead_target: config.lead,
            ..Self::default()
        }
    }

    /// Forgets the cycle under way and the feedback's integral, keeps the corrections.
    pub(super) fn restart(&mut self) {
        *self = Self {
            in_phase: self.in_phase_target,
            lead: self.lead_target,
            in_phase_target: self.in_phase_target,
            lead_target: self.lead_target,
            ..Self::default()
        };
    }

    /// A cycle has ended: the correction that it asks for.
    ///
    /// # Errors
    /// [`TripCause::NoResponse`].
    pub(super) fn boundary(&mut self, config: &CorrectionConfig) -> Result<(), TripCause> {
        let outcome = if self.steady {
            self.correct(config)
        } else {
            Ok(())
        };
        self.demand_square = Sum::default();
        self.rate_square = Sum::default();
        self.response_demand = Sum::default();
        self.response_rate = Sum::default();
        self.ticks = 0;
        self.steady = true;
        outcome
    }

    /// The command in mm at a tick that demands `excitation` and measured `displacement` mm.
    #[inline(always)]
    pub(super) fn command(
        &mut self,
        config: &CorrectionConfig,
        excitation: &Excitation,
        displacement: f32,
    ) -> f32 {
        let (d, v) = (excitation.displacement, excitation.velocity);
        self.steady &= !excitation.ramp;
        self.demand_square.add(d * d);
        self.rate_square.add(v * v);
        self.response_demand.add(displacement * d);
        self.response_rate.add(displacement * v);
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks.is_multiple_of(FOLD) {
            self.demand_square.fold();
            self.rate_square.fold();
            self.response_demand.fold();
            self.response_rate.fold();
        }
        self.in_phase += config.glide * (self.in_phase_target - self.in_phase);
        self.lead += config.glide * (self.lead_target - self.lead);
        self.integral = (self.integral + config.feedback_step * (d - displacement))
            .clamped(config.feedback_limit);
        self.in_phase * d + self.lead * v + self.integral
    }

    /// What the feedback adds to the command, mm: at the same phase of each cycle, the mean that the command has beyond
    /// the demand's.
    pub(super) fn mean_command(&self) -> f32 {
        self.integral
    }

    fn correct(&mut self, config: &CorrectionConfig) -> Result<(), TripCause> {
        let (dd, vv) = (self.demand_square.total(), self.rate_square.total());
        if !(dd > config.demand_min * self.ticks as f32 && vv > f32::MIN_POSITIVE) {
            return Ok(());
        }
        let a = self.response_demand.total() / dd;
        let b = self.response_rate.total() / vv;
        let square = vv / dd;
        let magnitude = a * a + square * b * b;
        if magnitude < RESPONSE_MIN * RESPONSE_MIN {
            return Err(TripCause::NoResponse);
        }
        // gain·(1 − Y)/Y = gain·(Y* − |Y|²)/|Y|², Y* = a − jω·b.
        let scale = config.gain / magnitude;
        let (re, im) = (scale * (a - magnitude), -scale * b);
        let (p, q) = (self.in_phase_target, self.lead_target);
        // Clamped to 1/GAIN_LIMIT..=GAIN_LIMIT, about the middle of the two.
        const MIDDLE: f32 = 0.5 * (GAIN_LIMIT + 1.0 / GAIN_LIMIT);
        self.in_phase_target =
            MIDDLE + (p + p * re - square * q * im - MIDDLE).clamped(GAIN_LIMIT - MIDDLE);
        self.lead_target = (q + p * im + q * re).clamped(LEAD_LIMIT);
        Ok(())
    }
}
