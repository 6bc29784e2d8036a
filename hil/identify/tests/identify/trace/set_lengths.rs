//! A length that is set before each test, such as a slider's, in a column of the file.

use std::fmt::Write as _;
use std::path::Path;

use super::*;
use rand::RngExt as _;

/// The motion of the tests, amplitude mm, frequency Hz, cycles.
const TESTS: [(f64, f64, u32); 3] = [(0.1, 1.0, 5), (0.2, 2.0, 6), (0.1, 5.0, 8)];

/// A test whose slider stands at `set` mm and adds a spring of `stiffness` kN/mm.
fn at(set: f64, stiffness: f64, seed: u64) -> Recording {
    let spring = move |&(_, y, _, _): &Sample| stiffness * y;
    let test = record("test", &TESTS, 0.004, seed, spring);
    let mut text = String::from("time_s,displacement_mm,force_kN,Slider [mm]\n");
    for n in 0..test.len() {
        let (y, f) = (test.displacement[n], test.force[n]);
        writeln!(text, "{:.3},{y:.7},{f:.7},{set:.2}", test.time[n]).unwrap();
    }
    let name = format!("{set:.2}.csv");
    Recording::from_bytes(Path::new(&name), text.into_bytes()).unwrap()
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn a_length_that_sets_the_stiffness_is_used() {
    for seed in 0..2 {
        let mut random = ChaCha8Rng::seed_from_u64(70 + seed);
        // kN/mm for each mm.
        let per_length = random.random_range(0.01..0.04);
        let between = random.random_range(15.0..28.0);
        let mut test = |set: f64| at(set, per_length * set, random.random());
        let fitted = [test(0.0), test(12.0), test(31.0), test(40.0)];
        let held = test(between);
        let found = trace(&fitted, &[held], &|_| ()).unwrap();
        assert_eq!(families(&found.result), ["control_input"], "seed {seed}");
        let controls = &found.model.controls;
        assert_eq!(controls.len(), 1);
        assert_eq!(controls[0].name, "slider_mm");
        assert_eq!(controls[0].range, [0.0, 40.0]);
        let error = found.result.augmented.nrmse_held_out;
        assert!(error < 0.006, "{error} at {between} mm");
        let stiffness = found.model.effects[0].parameters["stiffness"];
        assert!((stiffness / per_length - 1.0).abs() < 0.02, "{stiffness}");
        assert!(found.result.baseline.nrmse_held_out > 2.0 * error);
    }
}

#[test]
fn a_length_without_influence_is_not_used() {
    let fitted = [at(5.0, 0.3, 1), at(20.0, 0.3, 2), at(40.0, 0.3, 3)];
    let found = trace(&fitted, &[at(30.0, 0.3, 4)], &|_| ()).unwrap();
    assert_eq!(
        found.result.verdict,
        Verdict::None,
        "{:?}",
        families(&found.result)
    );
    assert!(found.model.controls.is_empty());
}
