//! From demanded to commanded displacement: gain and lead, corrected from cycle to cycle, and integral feedback.
//!
//! command = p·d + q·v + i, with d and v the generator's displacement and velocity. Because v = jω·d in a sine, C = p + jω·q is the
//! actuator's inverse at ω. With a dead time or a slow loop q is about the same at all frequencies, so that it stays valid from
//! block to block and through a sweep.
//!
//! Over each cycle the measured displacement y is demodulated against d and v,
//!
//! - Y = a + jω·b, a = Σy·d/Σd², b = Σy·v/Σv², ω² = Σv²/Σd²
//! - C ← C + gain·(1 − Y)·C/Y
//!
//! With gain 1 this would be right at once for a linear actuator, whose inverse is C/Y. p and q glide to their new values, so that
//! the command has no step. Ramps are left out, because there y lags in amplitude too.
//!
//! i ← i + feedback·h·(d − y) holds the mean against friction, leakage and sensors, which would let it drift.
//!
//! If a displacement channel shows too little, C grows, and the true amplitude with it. Therefore |C|² = p² + ω²·q² may grow within
//! a block by [`super::RigSettings::correction_limit`] relative to its value after the first cycles, and during these relative to 1
//! by twice that. A larger growth trips the rig.

use super::fault::TripCause;
use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::{Real, in_range, square_root};
use crate::sine::Excitation;
use crate::sum::{FOLD, Sum};

/// p stays in `1/GAIN_LIMIT..=GAIN_LIMIT`.
const GAIN_LIMIT: f32 = 5.0;
/// Upper end of [`super::RigSettings::correction_limit`], and its effect on the squares.
const MOST_LIMIT: f64 = 10.0;
const MOST_GROWTH: f64 = (1.0 + MOST_LIMIT) * (1.0 + MOST_LIMIT);
const MOST_FIRST: f64 = (1.0 + 2.0 * MOST_LIMIT) * (1.0 + 2.0 * MOST_LIMIT);
/// Limit of q in either direction, s.
const LEAD_LIMIT: f32 = 0.1;
/// Steady cycles after which a block's correction has settled: with a gain of 0.8 a 125th of the error remains.
const SETTLING: u8 = 3;
/// cos² of 30°.
const OPPOSITE: f32 = 0.75;
/// Smallest response, relative to the demand, that is a basis for a correction: below it a sensor or an actuator is dead.
const RESPONSE_MIN: f32 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CorrectionConfig {
    gain: f32,
    lead: f32,
    glide: f32,
    feedback_step: f32,
    feedback_limit: f32,
    /// Squares of the permitted growth of |C| once it has settled, and of its permitted value before.
    growth_square: f32,
    first_square: f32,
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
            self.growth_square,
            self.first_square,
            self.demand_min,
        ];
        writer.words(floats.map(f32::to_bits));
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [
            gain,
            lead,
            glide,
            feedback_step,
            feedback_limit,
            growth_square,
            first_square,
            demand_min,
        ] = reader.words()?.map(f32::from_bits);
        let within = |value, low, high| in_range("correction", value, low, high).ok();
        Some(Self {
            gain: within(gain, 0.0, 1.0)?,
            lead: within(lead, 0.0, f64::from(LEAD_LIMIT))?,
            glide: within(glide, 1e-7, 1.0)?,
            feedback_step: within(feedback_step, 0.0, 0.01)?,
            feedback_limit: within(feedback_limit, 1e-6, 1e4)?,
            growth_square: within(growth_square, 1.0, MOST_GROWTH)?,
            first_square: within(first_square, 1.0, MOST_FIRST)?,
            demand_min: within(demand_min, 0.0, 1e2)?,
        })
    }
}

impl CorrectionConfig {
    /// The fields of [`super::RigSettings`]; `displacement_limit` in mm bounds the feedback.
    pub(super) fn new(
        tick_rate: f64,
        gain: f64,
        lead: f64,
        glide: f64,
        feedback: f64,
        limit: f64,
        displacement_limit: f32,
    ) -> Result<Self, ConfigError> {
        in_range("glide", glide, 1.0 / tick_rate, 10.0)?;
        in_range("correction_limit", limit, 0.01, MOST_LIMIT)?;
        let (grown, first) = (1.0 + limit, 1.0 + 2.0 * limit);
        Ok(Self {
            gain: in_range("correction_gain", gain, 0.0, 1.0)? as f32,
            lead: in_range("lead", lead, 0.0, f64::from(LEAD_LIMIT))? as f32,
            glide: (1.0 / (glide * tick_rate)) as f32,
            feedback_step: (in_range("feedback", feedback, 0.0, 0.01 * tick_rate)? / tick_rate)
                as f32,
            feedback_limit: displacement_limit,
            growth_square: (grown * grown) as f32,
            first_square: (first * first) as f32,
            demand_min: (1e-3 * displacement_limit) * (1e-3 * displacement_limit),
        })
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Correction {
    /// p and q as they glide, and their targets.
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
    /// Whether the current cycle has been steady from its beginning.
    steady: bool,
    /// Steady cycles of this block, up to [`SETTLING`], and |C|² after that number.
    cycles: u8,
    settled_square: f32,
    /// |C|² that the last cycle asked for, divided by that; before, divided by the value without correction.
    growth: f32,
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

    /// Drops the current cycle and the feedback's integral, keeps the corrections.
    pub(super) fn restart(&mut self) {
        *self = Self {
            in_phase: self.in_phase_target,
            lead: self.lead_target,
            in_phase_target: self.in_phase_target,
            lead_target: self.lead_target,
            ..Self::default()
        };
    }

    /// A cycle has ended: computes the correction that it asks for.
    ///
    /// # Errors
    /// [`TripCause::NoResponse`], [`TripCause::CorrectionLimit`]; the correction stays as it was.
    pub(super) fn boundary(&mut self, config: &CorrectionConfig) -> Result<(), TripCause> {
        let outcome = if self.steady {
            self.correct(config)
        } else {
            self.cycles = 0;
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

    /// The command in mm at a tick with the demand `excitation` and the measured `displacement` mm.
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
        self.ahead(excitation)
    }

    /// The command in mm for `excitation` with the present correction.
    #[inline(always)]
    pub(super) fn ahead(&self, excitation: &Excitation) -> f32 {
        let Excitation {
            displacement,
            velocity,
            ..
        } = excitation;
        self.in_phase * displacement + self.lead * velocity + self.integral
    }

    /// Ticks of the current cycle.
    #[inline(always)]
    pub(super) fn ticks(&self) -> u32 {
        self.ticks
    }

    /// |C| that the last cycle asked for, divided by its value once settled, or by 1 until then, minus 1.
    pub(super) fn growth(&self) -> f32 {
        square_root(self.growth) - 1.0
    }

    /// Part of the command that the feedback adds, mm: at the same phase of each cycle it is the mean of the command minus that of
    /// the demand.
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
        // Within 30° of the opposite: no actuator is that late, but a channel may be reversed.
        let reversed = a < 0.0 && a * a > OPPOSITE * magnitude;
        if magnitude < RESPONSE_MIN * RESPONSE_MIN || reversed {
            return Err(TripCause::NoResponse);
        }
        // gain·(1 − Y)/Y = gain·(Y* − |Y|²)/|Y|², Y* = a − jω·b.
        let scale = config.gain / magnitude;
        let (re, im) = (scale * (a - magnitude), -scale * b);
        let (p, q) = (self.in_phase_target, self.lead_target);
        // Clamped to 1/GAIN_LIMIT..=GAIN_LIMIT, about the middle of the two.
        const MIDDLE: f32 = 0.5 * (GAIN_LIMIT + 1.0 / GAIN_LIMIT);
        let in_phase =
            MIDDLE + (p + p * re - square * q * im - MIDDLE).clamped(GAIN_LIMIT - MIDDLE);
        let lead = (q + p * im + q * re).clamped(LEAD_LIMIT);
        let now = in_phase * in_phase + square * lead * lead;
        let (before, most) = if self.cycles < SETTLING {
            (1.0, config.first_square)
        } else {
            (self.settled_square, config.growth_square)
        };
        self.growth = now / before;
        if self.growth > most {
            return Err(TripCause::CorrectionLimit);
        }
        if self.cycles < SETTLING {
            self.cycles += 1;
            self.settled_square = now;
        }
        self.in_phase_target = in_phase;
        self.lead_target = lead;
        Ok(())
    }
}
