//! A force channel with a delay, together with a mass.

use std::f64::consts::TAU;

use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_recording::Recording;
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, Normal};

use super::{law, random, rms, traced};

/// A law with a mass of 40 kg along noise up to 12 Hz at 2 kHz. Its force over time passes through `channel` and has noise of a
/// thousandth.
fn massive(seed: u64, channel: impl Fn(&dyn Fn(f64) -> f64, f64) -> Vec<f64>) -> Recording {
    let (motion, law) = (random(seed), law());
    let rate = 2000.0;
    let (h, mass) = (1e-5, 40e-6);
    let force = |time: f64| {
        let [[y, v], [_, before], [_, after]] = [time, time - h, time + h].map(&motion);
        law.force(y, v) + mass * (after - before) / (2.0 * h)
    };
    let mut force = channel(&force, rate);
    let mut random = StdRng::seed_from_u64(seed + 100);
    let mut noisy = |deviation: f64| Normal::new(0.0, deviation).unwrap().sample(&mut random);
    let noise = 1e-3 * rms(&force);
    force.iter_mut().for_each(|force| *force += noisy(noise));
    let time: Vec<f64> = (0..force.len()).map(|index| index as f64 / rate).collect();
    let displacement = time.iter().map(|time| motion(*time)[0] + noisy(2e-6));
    let displacement = displacement.collect();
    Recording::new("behind a channel", time, displacement, force).unwrap()
}

/// Ten seconds of x″ + √2·ω·x′ + ω²·x = ω²·force at `rate`, by Runge–Kutta steps of a twentieth of a sample, after a tenth of a
/// second in which the start fades.
fn low_passed(force: &dyn Fn(f64) -> f64, rate: f64, corner: f64) -> Vec<f64> {
    let (parts, lead) = (20, 200);
    let step = 1.0 / (rate * f64::from(parts));
    let omega = TAU * corner;
    let mut state = [force(-f64::from(lead) / rate), 0.0];
    let mut sample = |index: i32| {
        let shown = state[0];
        for part in 0..parts {
            let time = f64::from(index - lead) / rate + f64::from(part) * step;
            let [now, half, next] = [0.0, 0.5, 1.0].map(|of| force(time + of * step));
            let slope = |force: f64, by: f64, [dx, dv]: [f64; 2]| {
                let [x, v] = [state[0] + by * dx, state[1] + by * dv];
                let pull = omega * (force - x) - 2.0_f64.sqrt() * v;
                [v, omega * pull]
            };
            let a = slope(now, 0.0, [0.0; 2]);
            let b = slope(half, 0.5 * step, a);
            let c = slope(half, 0.5 * step, b);
            let d = slope(next, step, c);
            state = [0, 1].map(|i| state[i] + step / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        shown
    };
    let all: Vec<f64> = (0..lead + 20_000).map(&mut sample).collect();
    all[lead as usize..].to_vec()
}

/// The families found, and a function for a parameter by its name; NaN if none has it.
fn found(result: &TraceResult) -> (Vec<&str>, impl Fn(&str) -> f64) {
    let effects = result.effects.iter();
    let mut families: Vec<&str> = effects.map(|effect| effect.family.as_str()).collect();
    families.sort_unstable();
    let value = |name: &str| {
        let effects = result.effects.iter();
        let mut all = effects.filter_map(|effect| effect.parameters.get(name));
        all.next().map_or(f64::NAN, |estimate| estimate.value)
    };
    (families, value)
}

/// A low-pass attenuates fast changes. With a mere delay in the law, that would look like a larger mass.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_force_behind_a_low_pass_leaves_the_mass_as_it_is() {
    for corner in [100.0, 200.0] {
        let test = |seed| massive(seed, |force, rate| low_passed(force, rate, corner));
        let result = traced(test(1), test(2));
        let (families, value) = found(&result);
        assert_eq!(families, ["delay", "inertia"], "{corner} Hz");
        let (mass, at) = (value("mass"), value("corner"));
        assert!((mass / 40.0 - 1.0).abs() < 0.01, "{corner} Hz: {mass} kg");
        assert!((at / corner - 1.0).abs() < 0.01, "{corner} Hz: {at} Hz");
    }
}

/// A force with the same delay at all frequencies is found as that delay.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_mere_delay_stays_one() {
    for late in [1.25e-3, 4e-3] {
        let shown = |force: &dyn Fn(f64) -> f64, rate: f64| {
            let times = (0..20_000).map(|index| f64::from(index) / rate - late);
            times.map(force).collect()
        };
        let result = traced(massive(1, shown), massive(2, shown));
        let (families, value) = found(&result);
        assert_eq!(families, ["delay", "inertia"], "{late} s");
        let (mass, time) = (value("mass"), value("time"));
        assert!((mass / 40.0 - 1.0).abs() < 0.01, "{late} s: {mass} kg");
        assert!((time / late - 1.0).abs() < 0.005, "{late} s: {time} s");
    }
}
