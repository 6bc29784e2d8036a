//! The observer against closed forms.

use core::f64::consts::TAU;

use mesh_damper::error::ConfigError;
use mesh_damper::limits;
use mesh_damper::observer::{Observer, ObserverConfig};
use proptest::prelude::*;

const TICK_RATE: f64 = 10_000.0;
const H: f64 = 1.0 / TICK_RATE;

fn config(bandwidth: f64) -> ObserverConfig {
    ObserverConfig::new(TICK_RATE, bandwidth, 0.7).unwrap()
}

/// Uniform in −1…1, from the 64-bit generator of Knuth's MMIX.
fn noise(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// After a step of the measurement the error is a sum of e^(pt). The bandwidths are high: with all poles near 1, any smooth sequence
/// satisfies the recurrence.
#[test]
fn the_poles_are_where_they_were_placed() {
    for (bandwidth, damping) in [(200.0, 0.5), (500.0, 0.7), (1000.0, 1.0), (400.0, 2.0)] {
        let config = ObserverConfig::new(TICK_RATE, bandwidth, damping).unwrap();
        let mut observer = Observer::default();
        observer.update(&config, 0.0, 0.0);
        let w = TAU * bandwidth * H;
        // z³ − s₁z² + s₂z − s₃ from the poles, applied to the error sequence: 0 if the poles are correct.
        let (single, radius) = ((-w).exp(), (-damping * w).exp());
        let pair = if damping < 1.0 {
            2.0 * radius * (w * (1.0 - damping * damping).sqrt()).cos()
        } else {
            2.0 * radius * (w * (damping * damping - 1.0).sqrt()).cosh()
        };
        let product = radius * radius;
        let (s1, s2, s3) = (single + pair, single * pair + product, single * product);
        let errors: Vec<f64> = (0..500)
            .map(|_| f64::from(observer.update(&config, 1.0, 0.0).displacement) - 1.0)
            .collect();
        for e in errors.windows(4) {
            let rest = e[3] - s1 * e[2] + s2 * e[1] - s3 * e[0];
            // Four values within half a unit of 1 in f32 (6e-8), weighted 1 + 3 + 3 + 1; the state's own rounding of
            // the same size adds a few more.
            assert!(
                rest.abs() < 16.0 * 6e-8,
                "{rest} at {bandwidth} Hz, ζ = {damping}"
            );
        }
        assert!(errors[0].abs() > 0.05 && errors[499].abs() < 1e-5);
    }
}

#[test]
fn a_sine_with_feed_forward_is_followed_without_lag() {
    let config = config(10.0);
    let mut observer = Observer::default();
    let (amplitude, w) = (0.1, TAU * 10.0);
    let mut worst: f64 = 0.0;
    for tick in 0..20_000 {
        let phase = w * H * f64::from(tick);
        let estimate = observer.update(
            &config,
            (amplitude * phase.sin()) as f32,
            (-amplitude * w * w * phase.sin()) as f32,
        );
        if tick > 10_000 {
            let error = f64::from(estimate.velocity) - amplitude * w * phase.cos();
            worst = worst.max(error.abs());
        }
    }
    // The mean of two accelerations instead of their integral leaves (ωh)²/12 = 3e-6 of the velocity. The rounding of the
    // displacement to f32, 4e-9 mm with the gain of the noise (0.9·ω₀·√(ω₀h) = 4.5 1/s, five times that at the peak), makes 1e-7 of
    // 6.3 mm/s. Each tick's rounding of x adds as much per tick: 4e-9 mm/h·√… stays below 3e-6.
    assert!(worst < 1e-5 * amplitude * w, "{worst}");
}

/// Noise of σ = 1e-4 mm and 16 bits over ±1 mm, 0.1 mm at 1 Hz: the velocity is 0.63 mm/s at its peak.
#[test]
fn velocity_keeps_its_accuracy_near_its_zero_crossings() {
    let config = config(10.0);
    let mut observer = Observer::default();
    let (amplitude, w) = (0.1, TAU);
    let mut random = 1;
    let (mut near, mut square, mut wrong_sign) = (0, 0.0, 0);
    for tick in 0..100_000 {
        let phase = w * H * f64::from(tick);
        // The sum of 12 uniform numbers divided by 2 has σ = 1 · √12·6/(12·√3) = 1.
        let gaussian = (0..12).map(|_| noise(&mut random)).sum::<f64>() / 2.0;
        let noisy = amplitude * phase.sin() + 1e-4 * gaussian;
        let measured = (noisy * 32768.0).round() / 32768.0;
        let ahead = -amplitude * w * w * phase.sin();
        let estimate = observer.update(&config, measured as f32, ahead as f32);
        let velocity = amplitude * w * phase.cos();
        if tick > 10_000 && velocity.abs() < 0.05 * amplitude * w {
            let error = f64::from(estimate.velocity) - velocity;
            near += 1;
            square += error * error;
            if velocity.abs() > 0.005 * amplitude * w && error.abs() > velocity.abs() {
                wrong_sign += 1;
            }
        }
    }
    let rms = (square / f64::from(near)).sqrt();
    // The formula in the module's documentation gives 7e-4 mm/s. It is an approximation for small ωh, so the test allows half as much
    // again.
    assert!(rms < 1.05e-3 && rms > 2e-4, "{rms}");
    // 0.005 of the peak is 3.1e-3 mm/s, four standard deviations.
    assert!(wrong_sign < near / 1000, "{wrong_sign} of {near}");
}

#[test]
fn without_feed_forward_a_slow_sine_lags_little() {
    let config = config(60.0);
    let mut observer = Observer::default();
    let (amplitude, w) = (0.1, TAU);
    let mut worst: f64 = 0.0;
    for tick in 0..30_000 {
        let phase = w * H * f64::from(tick);
        let estimate = observer.update(&config, (amplitude * phase.sin()) as f32, 0.0);
        if tick > 10_000 {
            worst = worst.max((f64::from(estimate.velocity) - amplitude * w * phase.cos()).abs());
        }
    }
    // The filter is of third order: its velocity error is of second order in ω/ω₀ = 1/60, with the factor (1 + 2ζ) = 2.4.
    assert!(worst < 2.4 / 3600.0 * 1.5 * amplitude * w, "{worst}");
}

#[test]
fn a_missing_measurement_is_bridged() {
    let config = config(10.0);
    let mut observer = Observer::default();
    let w = TAU;
    for tick in 0..20_000 {
        let phase = w * H * f64::from(tick);
        let measured = if (15_000..15_100).contains(&tick) {
            f32::NAN
        } else {
            (0.1 * phase.sin()) as f32
        };
        let estimate = observer.update(&config, measured, (-0.1 * w * w * phase.sin()) as f32);
        if tick > 10_000 {
            // As in the test above, and 10 ms of prediction with a velocity error of 1e-5·0.6 mm/s.
            assert!((f64::from(estimate.displacement) - 0.1 * phase.sin()).abs() < 1e-6);
        }
    }
}

#[test]
fn refuses_what_it_cannot_do() {
    let field = |result: Result<ObserverConfig, ConfigError>| match result.unwrap_err() {
        ConfigError::NonFinite(field) | ConfigError::OutOfRange { field, .. } => field,
        other => panic!("{other}"),
    };
    assert_eq!(field(ObserverConfig::new(0.0, 10.0, 0.7)), "tick_rate");
    assert_eq!(field(ObserverConfig::new(1e4, f64::NAN, 0.7)), "bandwidth");
    assert_eq!(field(ObserverConfig::new(1e4, 1001.0, 0.7)), "bandwidth");
    assert_eq!(field(ObserverConfig::new(1e4, 10.0, 0.0)), "damping");
}

proptest! {
    /// For any input, at the widest bandwidth, the output is finite and within its limits.
    #[test]
    fn bounded_for_any_input(
        inputs in prop::collection::vec((any::<u32>(), any::<u32>()), 1..200),
        bandwidth in 1e-3..1e3f64,
        damping in 0.3..3.0f64,
    ) {
        let config = ObserverConfig::new(TICK_RATE, bandwidth, damping).unwrap();
        let mut observer = Observer::default();
        for (measured, ahead) in inputs {
            let e = observer.update(&config, f32::from_bits(measured), f32::from_bits(ahead));
            prop_assert!(e.displacement.abs() <= limits::DISPLACEMENT as f32);
            prop_assert!(e.velocity.abs() <= limits::VELOCITY as f32);
            prop_assert!(e.acceleration.abs() <= limits::ACCELERATION as f32);
        }
    }
}
