//! Displacement, velocity and acceleration from a noisy and quantized displacement.
//!
//! A tracking filter (α–β–γ: the steady state of a Kalman filter whose acceleration follows a random walk) with the generator's
//! acceleration u as feed-forward. With h the tick, d the acceleration in excess of u, and y the measurement:
//!
//! - a = (u₋ + u)/2 + d
//! - x⁻ = x + h·v + h²/2·a, v⁻ = v + h·a
//! - r = y − x⁻
//! - x ← x⁻ + α·r, v ← v⁻ + β/h·r, d ← d + γ/h²·r
//!
//! The error's poles are placed at e^(ph) with p = −ω and p = ω·(−ζ ± √(ζ²−1)), ω = 2π·bandwidth. Feed-forward carries the sine
//! itself. The bandwidth therefore only has to cover the actuator's deviation from it, and the velocity keeps its relative accuracy
//! near its zero crossings, where |v|^α is steep.
//!
//! White noise of σ mm in y gives about 0.9·σ·ω·√(ω·h) mm/s in v at ζ = 0.7. For 1e-4 mm at 10 kHz this is 7e-4 mm/s at 10 Hz and
//! 4e-3 mm/s at 30 Hz.

use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::limits;
use crate::real::{Real, in_range};

/// Gains of the tracking filter, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverConfig {
    tick: f32,
    half_tick_squared: f32,
    displacement_gain: f32,
    velocity_gain: f32,
    acceleration_gain: f32,
}

impl Fields for ObserverConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        let floats = [
            self.tick,
            self.half_tick_squared,
            self.displacement_gain,
            self.velocity_gain,
            self.acceleration_gain,
        ];
        writer.words(floats.map(f32::to_bits));
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [
            tick,
            half_tick_squared,
            displacement_gain,
            velocity_gain,
            acceleration_gain,
        ] = reader.words()?.map(f32::from_bits);
        let read = Self {
            tick,
            half_tick_squared,
            displacement_gain,
            velocity_gain,
            acceleration_gain,
        };
        read.is_stable().then_some(read)
    }
}

impl ObserverConfig {
    /// Whether the error decays: Jury's criterion for z³ − (3−α−β−γ/2)z² + (3−2α−β+γ/2)z − (1−α), with α, β and γ as in
    /// [`ObserverConfig::new`]: γ > 0, 0 < α < 2, 4α + 2β < 8 and 0 < αβ + αγ/2 − γ < 2α(2 − α). NaN fails.
    fn is_stable(&self) -> bool {
        let h = self.tick;
        let (alpha, beta) = (self.displacement_gain, self.velocity_gain * h);
        let gamma = self.acceleration_gain * h * h;
        let last = alpha * beta + 0.5 * alpha * gamma - gamma;
        (1e-6..=1.0).contains(&h)
            && (self.half_tick_squared - 0.5 * h * h).abs() <= 1e-6 * h * h
            && gamma > 0.0
            && alpha > 0.0
            && alpha < 2.0
            && 4.0 * alpha + 2.0 * beta < 8.0
            && last > 0.0
            && last < 2.0 * alpha * (2.0 - alpha)
    }

    /// * `tick_rate`: Hz, 1…1e6
    /// * `bandwidth`: Hz, 1e-3 to a tenth of the tick rate
    /// * `damping`: ζ of the pair of poles, 0.3…3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(tick_rate: f64, bandwidth: f64, damping: f64) -> Result<Self, ConfigError> {
        in_range("tick_rate", tick_rate, 1.0, 1e6)?;
        in_range("bandwidth", bandwidth, 1e-3, tick_rate / 10.0)?;
        in_range("damping", damping, 0.3, 3.0)?;
        let h = 1.0 / tick_rate;
        let w = core::f64::consts::TAU * bandwidth * h;
        // The distance u = 1 − z of each pole from 1. A slow observer has all poles near 1, where computing 1 − z would lose all
        // digits.
        let single = -libm::expm1(-w);
        // The pair is e^(w(−ζ ± √(ζ²−1))).
        let spread = libm::sqrt((damping * damping - 1.0).abs()) * w;
        let (pair_sum, pair_product) = if damping < 1.0 {
            let decay = libm::exp(-damping * w);
            let half = libm::sin(0.5 * spread);
            let real = -libm::expm1(-damping * w) + 2.0 * decay * half * half;
            // sin 2x = 2·sin x·cos x, of an angle below a quarter turn.
            let imaginary = decay * 2.0 * half * libm::sqrt(1.0 - half * half);
            (2.0 * real, real * real + imaginary * imaginary)
        } else {
            let slow = -libm::expm1(-damping * w + spread);
            let fast = -libm::expm1(-damping * w - spread);
            (slow + fast, slow * fast)
        };
        // The error's polynomial is z³ − (3−α−β−γ/2)z² + (3−2α−β+γ/2)z − (1−α). With Σu, Σuu′ and Πu of the poles
        // γ = Πu, β = Σuu′ − 3/2·Πu and α = Σu − Σuu′ + Πu.
        let gamma = single * pair_product;
        let pairs = single * pair_sum + pair_product;
        let beta = pairs - 1.5 * gamma;
        let alpha = single + pair_sum - pairs + gamma;
        Ok(Self {
            tick: h as f32,
            half_tick_squared: (h * h / 2.0) as f32,
            displacement_gain: alpha as f32,
            velocity_gain: (beta / h) as f32,
            acceleration_gain: (gamma / (h * h)) as f32,
        })
    }
}

/// Estimate of the observer at a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Displacement, mm.
    pub displacement: f32,
    /// Velocity, mm/s.
    pub velocity: f32,
    /// Acceleration, mm/s².
    pub acceleration: f32,
}

/// The tracking filter's state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observer {
    displacement: f32,
    velocity: f32,
    /// Acceleration in excess of the feed-forward, mm/s².
    excess: f32,
    feed_forward: f32,
    started: bool,
}

impl Observer {
    /// The state at this tick, from the measured displacement in mm and the generator's acceleration in mm/s² at this tick (0
    /// without a generator). The first call takes the measurement as it is, at rest.
    ///
    /// Everything returned is finite and within the limits above. A measurement that is not finite counts as missing: the state is
    /// then only predicted.
    #[inline]
    pub fn update(
        &mut self,
        config: &ObserverConfig,
        measured: f32,
        feed_forward: f32,
    ) -> Estimate {
        let feed_forward = feed_forward.clamped(limits::ACCELERATION as f32);
        if !self.started && measured.is_finite() {
            *self = Self {
                displacement: measured.clamped(limits::DISPLACEMENT as f32),
                feed_forward,
                started: true,
                ..Self::default()
            };
        } else {
            let mean = 0.5 * (self.feed_forward + feed_forward) + self.excess;
            let displacement =
                self.displacement + (config.tick * self.velocity + config.half_tick_squared * mean);
            let velocity = self.velocity + config.tick * mean;
            let residual = if measured.is_finite() {
                measured.clamped(limits::DISPLACEMENT as f32) - displacement
            } else {
                0.0
            };
            self.displacement = (displacement + config.displacement_gain * residual)
                .clamped(limits::DISPLACEMENT as f32);
            self.velocity =
                (velocity + config.velocity_gain * residual).clamped(limits::VELOCITY as f32);
            self.excess = (self.excess + config.acceleration_gain * residual)
                .clamped(limits::ACCELERATION as f32);
            self.feed_forward = feed_forward;
        }
        Estimate {
            displacement: self.displacement,
            velocity: self.velocity,
            acceleration: (self.feed_forward + self.excess).clamped(limits::ACCELERATION as f32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With three poles of u = 1 − z the gains are 3u − 3u² + u³, 3u² − 3/2·u³ and u³, however slow they are.
    #[test]
    fn the_slowest_observer_has_all_its_digits() {
        for (tick_rate, bandwidth) in [(1e6, 1e-3), (1e6, 1.0), (1e4, 20.0), (1e3, 100.0)] {
            let config = ObserverConfig::new(tick_rate, bandwidth, 1.0).unwrap();
            let u = -libm::expm1(-core::f64::consts::TAU * bandwidth / tick_rate);
            for (gain, expected) in [
                (config.displacement_gain, 3.0 * u - 3.0 * u * u + u * u * u),
                (
                    config.velocity_gain,
                    (3.0 * u * u - 1.5 * u * u * u) * tick_rate,
                ),
                (config.acceleration_gain, u * u * u * tick_rate * tick_rate),
            ] {
                let part = f64::from(gain) / expected;
                assert!(
                    (part - 1.0).abs() < 1e-6,
                    "{tick_rate}, {bandwidth}: {part}"
                );
            }
            assert!(config.is_stable());
        }
    }
}
