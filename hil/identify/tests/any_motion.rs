//! Motions that are no blocks of sines: nothing is called missing from a law that is the specimen's.

use std::f64::consts::{PI, TAU};

use mesh_damper_identify::trace::result::{TraceResult, Verdict};
use mesh_damper_identify::trace::trace;
use mesh_damper_model::predict::{band, predict};
use mesh_damper_model::{LawNode, Model};
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};

const RATE: f64 = 500.0;
const DURATION: f64 = 30.0;

fn law() -> Coefficients {
    tables::interpolate(3.0, 0.1)
}

/// Displacement and velocity of noise up to 12 Hz.
fn random(seed: u64) -> impl Fn(f64) -> [f64; 2] {
    let mut random = StdRng::seed_from_u64(seed);
    let tones: Vec<[f64; 3]> = (0..40)
        .map(|_| {
            let turn = TAU * random.random_range(0.3..12.0);
            [
                0.03 / (turn / TAU).max(1.0),
                turn,
                random.random_range(0.0..TAU),
            ]
        })
        .collect();
    move |time| {
        tones.iter().fold([0.0; 2], |[y, v], [size, turn, phase]| {
            let (sin, cos) = (turn * time + phase).sin_cos();
            [y + size * sin, v + size * turn * cos]
        })
    }
}

/// Steps to and fro, each along half a wave of a cosine, with holds of two seconds.
fn steps(seed: u64) -> impl Fn(f64) -> [f64; 2] {
    let mut random = StdRng::seed_from_u64(seed);
    let mut places = vec![0.0];
    places.extend((0..20).map(|_| random.random_range(-0.15..0.15)));
    move |time| {
        let step = (time / 2.2) as usize;
        let since = time - 2.2 * step as f64 - 2.0;
        let (from, to): (f64, f64) = (places[step], places[step + 1]);
        if since <= 0.0 {
            return [from, 0.0];
        }
        let (sin, cos) = (PI * since / 0.2).sin_cos();
        let way = to - from;
        [from + 0.5 * way * (1.0 - cos), 0.5 * way * PI / 0.2 * sin]
    }
}

/// The law's force with noise over its RMS, along a motion whose displacement has noise in mm.
fn recorded(
    motion: impl Fn(f64) -> [f64; 2],
    noise: f64,
    of_displacement: f64,
    seed: u64,
) -> Recording {
    let mut random = StdRng::seed_from_u64(seed);
    let mut noisy = |deviation: f64| Normal::new(0.0, deviation).unwrap().sample(&mut random);
    let time: Vec<f64> = (0..(RATE * DURATION) as usize)
        .map(|index| index as f64 / RATE)
        .collect();
    let law = law();
    let force: Vec<f64> = time
        .iter()
        .map(|time| {
            let [y, v] = motion(*time);
            law.force(y, v)
        })
        .collect();
    let rms = rms(&force);
    let displacement = time
        .iter()
        .map(|time| motion(*time)[0] + noisy(of_displacement))
        .collect();
    let force = force
        .iter()
        .map(|force| force + noisy(noise * rms))
        .collect();
    Recording::new("any motion", time, displacement, force).unwrap()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

fn traced(training: Recording, held_out: Recording) -> TraceResult {
    trace(&[training], &[held_out], &|_| ()).unwrap().result
}

/// A little noise of the displacement is much force near a standstill, where |v|^α is steep: what it makes of the force is allowed
/// for, however quiet the force is and however shaky the displacement.
#[test]
fn noise_of_the_displacement_is_no_missing_effect() {
    for (noise, of_displacement) in [(1e-3, 5e-5), (5e-3, 5e-4), (1e-2, 1e-4)] {
        let test = |seed| recorded(random(seed), noise, of_displacement, seed);
        let result = traced(test(1), test(2));
        assert_eq!(result.verdict, Verdict::None, "{noise} {of_displacement}");
        let (found, law) = (&result.law[0], law());
        for (found, true_value) in [
            (&found.k1, law.k1),
            (&found.c, law.c),
            (&found.alpha, law.alpha),
        ] {
            assert!(
                (found.value / true_value - 1.0).abs() < 0.03,
                "{} {true_value}",
                found.value
            );
        }
    }
}

/// What stands still has no velocity whose sign noise could give.
#[test]
fn holds_between_steps_are_no_missing_effect() {
    let test = |seed| recorded(steps(seed), 5e-3, 5e-5, seed);
    let (training, held_out) = (test(3), test(4));
    // What the true law leaves along the estimated motion, which a fitted one is nearly as good as.
    let trajectory = Trajectory::of(&held_out).unwrap();
    let (motion, law) = (&trajectory.motion, law());
    assert!(motion.rests.len() > 10, "{:?}", motion.rests);
    let left = motion
        .displacement
        .iter()
        .zip(&motion.velocity)
        .zip(&trajectory.force);
    let left = left
        .map(|((y, v), force)| (force - law.force(*y, *v)).powi(2))
        .sum::<f64>();
    let of_truth = left.sqrt() / trajectory.force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let result = traced(training, held_out);
    assert_eq!(result.verdict, Verdict::None);
    let error = result.augmented.nrmse_held_out;
    assert!(error < 1.1 * of_truth, "{error} {of_truth}");
}

/// Taken for motion it would have a velocity of a tenth of the largest, and friction a direction that is none.
#[test]
fn hum_on_the_displacement_is_taken_off() {
    let test = |seed| {
        let mut recording = recorded(steps(seed), 5e-3, 5e-5, seed);
        for (time, y) in recording.time.iter().zip(&mut recording.displacement) {
            *y += 5e-4 * (TAU * 50.01 * time + 0.3).sin();
        }
        recording
    };
    let result = traced(test(7), test(8));
    assert_eq!(result.verdict, Verdict::None, "{:?}", result.effects);
    let said = |warning: &&String| {
        warning.contains("hum on the displacement") && warning.contains("at 50.01 Hz")
    };
    assert_eq!(
        result.warnings.iter().filter(said).count(),
        2,
        "{:?}",
        result.warnings
    );
}

/// What acts in some places only has to be fitted and judged in such places, wherever they are in the recording.
#[test]
fn steps_show_what_acts_on_one_side() {
    let test = |seed| {
        let mut recording = recorded(steps(seed), 5e-3, 5e-5, seed);
        for (time, force) in recording.time.iter().zip(&mut recording.force) {
            *force += 3.0 * steps(seed)(*time)[0].powi(2);
        }
        recording
    };
    let result = traced(test(3), test(4));
    assert_eq!(result.verdict, Verdict::Found);
    let families: Vec<&str> = result
        .effects
        .iter()
        .map(|effect| effect.family.as_str())
        .collect();
    assert_eq!(families, ["asymmetry"]);
}

/// The tabulated coefficients of each amplitude, which differ by up to three times, from one slow cycle at each.
#[test]
fn one_cycle_at_each_amplitude_gives_coefficients_for_each() {
    let amplitudes = [0.05, 0.1, 0.15, 0.2];
    let period = 100.0;
    let rate = 10.0;
    let mut random = StdRng::seed_from_u64(9);
    let mut noisy = |deviation: f64| Normal::new(0.0, deviation).unwrap().sample(&mut random);
    let (mut time, mut displacement, mut force) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..(amplitudes.len() as f64 * period * rate) as usize {
        let now = index as f64 / rate;
        let amplitude = amplitudes[(now / period) as usize];
        let (sin, cos) = (TAU * now / period).sin_cos();
        let [y, v] = [amplitude * sin, amplitude * TAU / period * cos];
        time.push(now);
        displacement.push(y + noisy(5e-5));
        force.push(tables::interpolate(3.0, amplitude).force(y, v) + noisy(5e-4));
    }
    let recording = Recording::new("slow", time, displacement, force).unwrap();
    let result = trace(&[recording], &[], &|_| ()).unwrap().result;
    assert_eq!(result.verdict, Verdict::None);
    // The last cycle is held out.
    assert_eq!(result.law.len(), 3);
    for (found, amplitude) in result.law.iter().zip(amplitudes) {
        let law = tables::interpolate(3.0, amplitude);
        assert!(
            (found.amplitude / amplitude - 1.0).abs() < 0.01,
            "{}",
            found.amplitude
        );
        assert!(
            (found.k1.value / law.k1 - 1.0).abs() < 0.05,
            "{amplitude}: {} {}",
            found.k1.value,
            law.k1
        );
    }
}

/// Whatever the noise of the displacement, at the share that it says.
#[test]
fn the_band_holds_the_force_along_the_true_motion() {
    let law = law();
    let node = LawNode {
        amplitude: 0.0,
        k1: law.k1,
        k3: law.k3,
        c: law.c,
        alpha: law.alpha,
    };
    let model = Model {
        law: vec![node],
        effects: Vec::new(),
        correction: None,
    };
    for of_displacement in [2e-5, 1e-4, 5e-4] {
        let recording = recorded(random(11), 1e-3, of_displacement, 11);
        let trajectory = Trajectory::of(&recording).unwrap();
        let predicted = predict(&model, &trajectory).unwrap();
        let band = band(&model, &trajectory).unwrap();
        let samples: Vec<usize> = (0..trajectory.len())
            .filter(|&i| trajectory.is_telling(i))
            .collect();
        let holds = |&&i: &&usize| {
            let [y, v] = random(11)(recording.time[i]);
            (predicted[i] - law.force(y, v)).abs() <= band[i]
        };
        let share = samples.iter().filter(holds).count() as f64 / samples.len() as f64;
        assert!((0.8..0.97).contains(&share), "{of_displacement}: {share}");
    }
}

/// White noise through poles an octave apart, whose powers add up to nearly 1/f; of deviation 1.
fn pink(count: usize, seed: u64) -> Vec<f64> {
    let mut random = StdRng::seed_from_u64(seed);
    let white = Normal::new(0.0, 1.0).unwrap();
    let mut sum = vec![0.0; count];
    for pole in 0..16 {
        let kept = (-(2.0_f64.powi(1 - pole))).exp();
        let mut state = white.sample(&mut random);
        for sum in &mut sum {
            state = kept * state + f64::sqrt(1.0 - kept * kept) * white.sample(&mut random);
            *sum += state;
        }
    }
    let deviation = rms(&sum);
    sum.iter().map(|x| x / deviation).collect()
}

/// An amplifier's noise grows towards low frequencies, where the motion is: quick changes show a third of it. It is no missing effect, and
/// hides none that is larger.
#[test]
fn noise_that_grows_towards_low_frequencies_is_no_missing_effect() {
    let test = |stiffness: f64, seed: u64| {
        let mut recording = recorded(random(seed), 1e-4, 1e-5, seed);
        let noise = 0.01 * rms(&recording.force);
        let pink = pink(recording.force.len(), seed);
        let motion = random(seed);
        let (mut stretch, mut before) = (0.0, motion(0.0)[0]);
        let moments = recording.time.iter().zip(&pink);
        for (force, (time, pink)) in recording.force.iter_mut().zip(moments) {
            let [y, _] = motion(*time);
            stretch = f64::clamp(stretch + y - before, -0.03, 0.03);
            before = y;
            *force += noise * pink + stiffness * stretch;
        }
        recording
    };
    let nothing = traced(test(0.0, 1), test(0.0, 2));
    assert_eq!(nothing.verdict, Verdict::None, "{:?}", nothing.warnings);
    let told = nothing
        .warnings
        .iter()
        .any(|warning| warning.contains("1/f"));
    assert!(told, "{:?}", nothing.warnings);
    let sliding = traced(test(1.5, 3), test(1.5, 4));
    assert_eq!(sliding.verdict, Verdict::Found, "{:?}", sliding.warnings);
    assert_eq!(sliding.effects[0].family, "stick_slip");
    assert_eq!(sliding.effects.len(), 1);
}

/// A law with a mass of 40 kg along noise up to 12 Hz at 2 kHz, whose force, by time, comes through `channel` with noise of a thousandth.
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

/// Ten seconds of x″ + √2·ω·x′ + ω²·x = ω²·force at `rate`, by Runge and Kutta's steps of a twentieth of a sample, after a tenth of a second
/// in which the start has faded.
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

/// The families found, and a parameter by its name; NaN where none has it.
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

/// A low-pass makes what changes fast less late than what changes slowly, which beside a mere delay is taken for more of a mass.
#[test]
fn a_force_behind_a_low_pass_leaves_the_mass_as_it_is() {
    for corner in [25.0, 40.0, 100.0, 200.0] {
        let test = |seed| massive(seed, |force, rate| low_passed(force, rate, corner));
        let result = traced(test(1), test(2));
        let (families, value) = found(&result);
        assert_eq!(families, ["delay", "inertia"], "{corner} Hz");
        let (mass, at) = (value("mass"), value("corner"));
        assert!((mass / 40.0 - 1.0).abs() < 0.01, "{corner} Hz: {mass} kg");
        assert!((at / corner - 1.0).abs() < 0.01, "{corner} Hz: {at} Hz");
    }
}

/// What is late by one time at all frequencies is a delay of that time.
#[test]
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
