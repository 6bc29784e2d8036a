//! Motions for the rig to follow, and the rig that follows them.

use std::f64::consts::TAU;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper_recording::Recording;
use mesh_damper_recording::spectrum::powers;
use mesh_damper_rig::drive::limits::{Demands, checked};
use mesh_damper_rig::drive::{Grid, Motion, RandomMotion, recorded};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigRun, RigSetup, SetupError, run_rig};

const TICK_RATE: f64 = 10_000.0;

type Setup = RigSetup<Specimen, 1, 1>;

fn random(rms: f64, to: f64) -> Motion {
    let random = RandomMotion {
        rms,
        from: 0.5,
        to,
        duration: 8.0,
        seed: 1,
    };
    random.motion(Grid::at(TICK_RATE)).unwrap()
}

fn setup(motion: Motion) -> Setup {
    let specimen = Specimen::of_density(3.0, 0.1);
    let c = specimen.coefficients();
    let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
    RigSetup::driven(specimen, AugmentedLaw::new(law), motion, 1).unwrap()
}

/// Samples of `motion` from `from` s on for `duration` s, with noise of the size `noise` that a cubic does not follow.
fn recording(motion: impl Fn(f64) -> f64, duration: f64, rate: f64, noise: f64) -> Recording {
    let count = (duration * rate) as usize;
    let time: Vec<f64> = (0..count).map(|i| i as f64 / rate).collect();
    let mut state = 1_u64;
    let mut noisy = || {
        // Marsaglia's xorshift; uniform, with a deviation of 1.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        noise * 12f64.sqrt() * (state as f64 / u64::MAX as f64 - 0.5)
    };
    let displacement = time.iter().map(|t| motion(*t) + noisy()).collect();
    Recording::new("test", time, displacement, vec![0.0; count]).unwrap()
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (squares, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
    f64::sqrt(squares / count)
}

/// RMS of the run's displacement minus `motion`'s, divided by that of the motion.
fn followed(run: &RigRun, motion: &Motion) -> f64 {
    let samples = &run.samples;
    let demand = |time: &f64| motion.at(*time).displacement;
    let error = samples.time.iter().zip(&samples.displacement);
    rms(error.map(|(t, y)| y - demand(t))) / rms(samples.time.iter().map(demand))
}

#[test]
fn a_random_motion_has_its_rms_its_band_and_its_period() {
    let motion = random(0.1, 20.0);
    let [before, after] = motion.ramps();
    assert_eq!([before, after, motion.duration()], [2.0, 2.0, 12.0]);
    assert!((motion.rms() / 0.1 - 1.0).abs() < 1e-3, "{}", motion.rms());
    // One period at 1 kHz: every line of the band has the same power, and the others have none.
    let core: Vec<f64> = (0..8000)
        .map(|i| motion.at(2.0 + i as f64 * 1e-3).displacement)
        .collect();
    for line in 0..400 {
        let turn = TAU * line as f64 / 8000.0;
        let (mut re, mut im) = (0.0, 0.0);
        for (i, y) in core.iter().enumerate() {
            let (sin, cos) = (turn * i as f64).sin_cos();
            re += y * cos;
            im += y * sin;
        }
        let amplitude = f64::hypot(re, im) / 4000.0;
        let band = (4..=160).contains(&line);
        let expected = if band {
            0.1 * (2.0 / 157.0_f64).sqrt()
        } else {
            0.0
        };
        assert!(
            (amplitude - expected).abs() < 1e-9,
            "line {line}: {amplitude}"
        );
    }
    // Velocity is the displacement's derivative, also in ramps, and both ends are at rest at 0.
    let h = 1e-4;
    for place in 1..2400 {
        let time = 5e-3 * f64::from(place);
        let ahead = motion.at(time + h).displacement - motion.at(time - h).displacement;
        let velocity = motion.at(time).velocity;
        assert!((ahead / (2.0 * h) - velocity).abs() < 0.02, "{time} s");
    }
    for end in [0.0, 12.0] {
        let at = motion.at(end);
        assert!(
            at.displacement.abs() < 1e-12 && at.velocity.abs() < 1e-12,
            "{at:?}"
        );
    }
}

#[test]
fn the_seed_draws_the_phases() {
    let of_seed = |seed| {
        let text = format!("rms=0.1mm,from=1,to=10Hz,duration=4s,seed={seed}");
        let random = RandomMotion::parse(&text).unwrap();
        random.motion(Grid::at(TICK_RATE)).unwrap()
    };
    assert_eq!(of_seed(7), of_seed(7));
    assert_ne!(of_seed(7), of_seed(8));
}

#[test]
fn a_random_motion_that_cannot_be_is_refused_by_its_field() {
    for (text, said) in [
        ("", "\"\" is not name=value"),
        ("rms=0.1mm", "field from: it is missing"),
        ("rms=0.1mm,from=1,to=10", "field duration: it is missing"),
        (
            "rms=0.1kg,from=1,to=10,duration=4",
            "field rms: \"kg\" is not a unit of it",
        ),
        (
            "rms=-1,from=1,to=10,duration=4",
            "field rms: \"-1\" is not a number above 0",
        ),
        ("rms=nan,from=1,to=10,duration=4", "field rms:"),
        (
            "rms=1,rms=1,from=1,to=10,duration=4",
            "field rms: it is given twice",
        ),
        (
            "rms=1,from=1,to=10,duration=4,seed=x",
            "field seed: \"x\" is no whole number",
        ),
        (
            "rms=1,from=1,to=10,duration=4,size=1",
            "field size: there is no such field",
        ),
    ] {
        let error = RandomMotion::parse(text).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    for (text, said) in [
        (
            "rms=0.1,from=10,to=1,duration=4",
            "field to: 1 Hz is outside 10 to 100 Hz",
        ),
        (
            "rms=0.1,from=1,to=200,duration=4",
            "field to: 200 Hz is outside 1 to 100 Hz",
        ),
        (
            "rms=0.1,from=0.1,to=2,duration=4",
            "field duration: 4 s is outside 10 to 3600 s",
        ),
        ("rms=0.1,from=1,to=2,duration=2h", "not a unit"),
        (
            "rms=0.1,from=1.1,to=1.2,duration=1",
            "field to: no multiple of 1.0000 Hz",
        ),
        (
            "rms=1e9,from=1,to=2,duration=4",
            "field rms: 1000000000 mm is outside",
        ),
    ] {
        let motion = RandomMotion::parse(text).and_then(|r| r.motion(Grid::at(TICK_RATE)));
        let error = motion.unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    let minutes = RandomMotion::parse("rms=100um,from=1Hz,to=2Hz,duration=1min").unwrap();
    assert!((minutes.rms - 0.1).abs() < 1e-12 && minutes.duration == 60.0 && minutes.seed == 1);
}

#[test]
fn a_recorded_motion_is_the_one_that_was_recorded_and_its_ramps_come_in_addition() {
    let truth = |time: f64| 0.1 * (TAU * 2.0 * time).cos() + 0.05 * (TAU * 7.0 * time).sin();
    let recording = recording(truth, 5.0, 1000.0, 1e-4);
    let out = recorded(&recording, 0.5, 0.1, Grid::at(TICK_RATE)).unwrap();
    let [before, after] = out.motion.ramps();
    assert!((0.05..=0.5).contains(&before) && (0.05..=0.5).contains(&after));
    assert!((out.motion.duration() - before - after - 5.0).abs() < 2e-3);
    let error = (0..4999).map(|i| {
        let time = f64::from(i) * 1e-3;
        out.motion.at(before + time).displacement - 0.5 * (truth(time) + 0.1)
    });
    let error = rms(error);
    // A thousandth of the motion, in which the windows' bias matters more than the noise.
    assert!(error < 8e-5, "{error}");
    // The rejected part is the noise, 1e-4 mm and half as large now, and that bias.
    let noise = 5e-5;
    assert!(
        out.left_out > 0.9 * noise && out.left_out < 1.7 * noise,
        "{}",
        out.left_out
    );
    // Nowhere does it jump or demand much more than the recorded motion does.
    let peaks = out.motion.peaks();
    assert!(peaks.displacement < 0.5 * 0.3, "{peaks:?}");
    let fastest = 0.5 * (TAU * 2.0 * 0.1 + TAU * 7.0 * 0.05);
    assert!(peaks.velocity < 1.5 * fastest, "{peaks:?}");
}

#[test]
fn a_recording_of_any_rate_is_resampled() {
    let truth = |time: f64| 0.1 * (TAU * 3.0 * time).sin();
    for rate in [250.0, 333.0, 1000.0, 5000.0] {
        let recording = recording(truth, 3.0, rate, 0.0);
        let out = recorded(&recording, 1.0, 0.0, Grid::at(TICK_RATE)).unwrap();
        let [before, _] = out.motion.ramps();
        for i in 0..2900 {
            let time = 1e-3 * f64::from(i);
            let error = out.motion.at(before + time).displacement - truth(time);
            assert!(error.abs() < 1e-4, "{rate} Hz, {time} s: {error}");
        }
    }
}

#[test]
fn a_recording_with_a_gap_or_a_scale_that_is_none_is_refused() {
    let whole = recording(|t| 0.1 * (TAU * t).sin(), 3.0, 500.0, 0.0);
    let grid = Grid::at(TICK_RATE);
    for (scale, shift, said) in [
        (f64::NAN, 0.0, "field scale"),
        (1.0, f64::INFINITY, "field shift"),
    ] {
        let error = recorded(&whole, scale, shift, grid).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
    let keep = |values: &[f64]| [&values[..500], &values[700..]].concat();
    let cut = Recording::new(
        "test",
        keep(&whole.time),
        keep(&whole.displacement),
        keep(&whole.force),
    );
    let error = recorded(&cut.unwrap(), 1.0, 0.0, grid).unwrap_err();
    assert!(
        error.to_string().contains("there is a gap at 1.0"),
        "{error}"
    );
}

/// The actuator is a first-order lag of 24 Hz with a millisecond of dead time; the lead removes most of it.
#[test]
fn the_rig_follows_within_the_error_that_was_said_before() {
    for (to, most) in [(3.0, 0.02), (8.0, 0.06), (20.0, 0.25)] {
        let motion = random(0.08, to);
        let setup = setup(motion.clone());
        let demands = checked(&setup, 1.0).unwrap();
        let run = run_rig(setup, |_| {}).unwrap();
        assert!(
            run.faults.is_empty() && run.events.is_empty(),
            "{:?}",
            run.faults
        );
        assert!(run.cycles.is_empty());
        assert!((run.ticks as f64 - motion.duration() * TICK_RATE).abs() < 5.0);
        let error = followed(&run, &motion);
        assert!(error < most, "up to {to} Hz: {error}");
        // Over the whole motion, ramps included, as stated before.
        let whole = rms(run.samples.time.iter().map(|t| motion.at(*t).displacement));
        let said = demands.following_error_rms_mm / whole;
        assert!(
            (error / said - 1.0).abs() < 0.15,
            "up to {to} Hz: {error}, {said}"
        );
    }
}

#[test]
fn what_the_rig_moved_has_its_power_in_the_band() {
    let motion = random(0.08, 10.0);
    let run = run_rig(setup(motion), |_| {}).unwrap();
    let steady = run.samples.displacement[2000..10_000].to_vec();
    let powers = powers(steady);
    let whole: f64 = powers.iter().sum();
    // The Hann window widens a line of 0.125 Hz by four.
    let band: f64 = powers[..=10 * 8 + 4].iter().sum();
    assert!(band > 0.9995 * whole, "{}", band / whole);
    let lower: f64 = powers[..=5 * 8].iter().sum();
    assert!(
        lower > 0.35 * whole && lower < 0.6 * whole,
        "{}",
        lower / whole
    );
}

#[test]
fn a_replay_of_a_run_moves_as_the_run_did() {
    let first = run_rig(setup(random(0.08, 5.0)), |_| {}).unwrap();
    let out = recorded(
        &first.recording("run").unwrap(),
        1.0,
        0.0,
        Grid::at(TICK_RATE),
    );
    let out = out.unwrap();
    let second = run_rig(setup(out.motion.clone()), |_| {}).unwrap();
    assert!(second.faults.is_empty());
    let error = followed(&second, &out.motion);
    assert!(error < 0.04, "{error}");
    // The force agrees too: the same specimen under the same motion, after the ramp in.
    let late = (out.motion.ramps()[0] * 1e3).round() as usize;
    let pairs = first
        .samples
        .force
        .iter()
        .zip(&second.samples.force[late..]);
    let differ = rms(pairs.map(|(a, b)| a - b)) / rms(first.samples.force.iter().copied());
    assert!(differ < 0.06, "{differ}");
}

fn demand(setup: &Setup) -> Result<Demands, String> {
    checked(setup, 1.0).map_err(|error| {
        let SetupError::Drive(error) = error else {
            panic!("{error}")
        };
        error.to_string()
    })
}

#[test]
fn a_motion_beyond_a_limit_is_refused_with_value_limit_and_scale() {
    let demands = demand(&setup(random(0.08, 8.0))).unwrap();
    assert!(demands.displacement_mm > 0.15 && demands.displacement_mm < 0.4);
    assert!(
        demands.force_kn > 0.3 && demands.following_error_mm < 0.05,
        "{demands:?}"
    );

    let refused = |change: fn(&mut Setup)| {
        let mut setup = setup(random(0.08, 8.0));
        change(&mut setup);
        demand(&setup).unwrap_err()
    };
    for (field, error) in [
        (
            "displacement",
            refused(|s| s.settings.displacement_limit = 0.1),
        ),
        ("velocity", refused(|s| s.stream.velocity_limit = 1.0)),
        ("velocity", refused(|s| s.servo.flow_velocity = 1.0)),
        ("acceleration", refused(|s| s.servo.mass = 1e9)),
        ("force", refused(|s| s.settings.force_limit = 0.1)),
        ("command", refused(|s| s.command_range = 0.15)),
        (
            "following error",
            refused(|s| s.settings.tracking_limit = 1e-4),
        ),
    ] {
        assert!(error.contains(&format!("field {field}")), "{error}");
        assert!(error.contains("--scale 0."), "{error}");
    }
    // The scale is enough where the demand is proportional.
    let large = demand(&setup(random(0.3, 8.0))).unwrap_err();
    let scale = large.split("--scale ").nth(1).unwrap();
    let scale: f64 = scale.split(' ').next().unwrap().parse().unwrap();
    assert!(scale < 0.9);
    // For a motion that is scaled already, the suggested scale replaces that scale.
    let again = checked(&setup(random(0.3, 8.0)), 0.5)
        .unwrap_err()
        .to_string();
    assert!(
        again.contains(&format!("--scale {}", 0.5 * scale)[..12]),
        "{again}"
    );
    demand(&setup(random(0.3 * scale, 8.0))).unwrap();
}
