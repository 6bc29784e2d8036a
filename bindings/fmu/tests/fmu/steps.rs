//! Communication steps: their permitted sizes, and the inputs within a step.

use mesh_damper_fmu::functions::*;
use mesh_damper_fmu::types::Status;

use crate::master::{MODEL_WITH_HISTORY, MOTION, Unpacked};

#[test]
fn a_step_is_a_whole_number_of_ticks_from_where_the_last_one_ended() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 3e3);
    let master = unpacked.instance();
    master.well(fmi2SetupExperiment(master.handle, 1, 1e-6, -2.0, 1, 1.0));
    master.well(fmi2EnterInitializationMode(master.handle));
    master.well(fmi2ExitInitializationMode(master.handle));
    let tick = 1.0 / 3e3;
    for size in [0.0, -tick, 0.4 * tick, 1.5 * tick, f64::MIN_POSITIVE] {
        master.refused(
            master.step(-2.0, size),
            &[
                "communicationStepSize = ",
                "give a multiple of the tick",
                "--tick-rate",
            ],
        );
    }
    master.refused(master.step(-2.0, 1e9), &["1000000000 at most", "shorter"]);
    master.refused(
        master.step(-1.9, tick),
        &[
            "currentCommunicationPoint = -1.9 s",
            "the last step ended at -2 s",
            "restore a state",
        ],
    );
    master.refused(
        master.step(-2.0, 3.0 + tick),
        &["after the stop time of 1 s"],
    );
    // The sums of a master that adds up its steps; 1/3 ms has no exact float.
    let mut time = -2.0;
    for _ in 0..6000 {
        master.well(master.step(time, tick));
        time += tick;
    }
    master.well(master.step(time, 1.0));
    master.refused(master.step(1.0, tick), &["after the stop time"]);
}

/// A master that adds up `t += h` from `start`, for `steps` of one tick of 0.1 ms.
fn adds_up(start: f64, steps: u32) {
    let tick = 1e-4;
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    master.set_up(start);
    master.well(fmi2ExitInitializationMode(master.handle));
    let mut time = start;
    for _ in 0..steps {
        master.well(master.step(time, tick));
        time += tick;
    }
    // What is no rounding is refused all the same: the tenth of a tick, or steps of a little more than one.
    master.refused(master.step(time + 1e-5, tick), &["the last step ended at"]);
    let long = 1.0009 * tick;
    let add_up = |_| {
        let status = master.step(time, long);
        time += long;
        status == Status::Ok
    };
    let most = 2.0 + 2.0 * f64::from(steps) * f64::EPSILON * start.abs().max(1e3) / tick / 9e-4;
    let taken = (0..2 * most as u32).map(add_up).take_while(|&is_ok| is_ok);
    assert!(
        (taken.count() as f64) <= most,
        "steps that are no whole ticks added up"
    );
}

#[test]
fn a_master_may_add_up_its_steps_at_any_time_of_day() {
    for start in [0.0, 86_400.0, 1e6, -1e6] {
        adds_up(start, 100_000);
    }
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn a_master_may_add_up_its_steps_for_a_thousand_seconds() {
    adds_up(0.0, 10_000_000);
}

/// Ten ticks with derivatives equal ten steps with the same inputs one by one.
#[test]
fn derivatives_of_the_inputs_act_for_one_step() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let [one, many] = [unpacked.instance(), unpacked.instance()];
    let (y, v, a) = (1e-4, 2e-3, 0.3);
    for master in [&one, &many] {
        master.begin([y, v, a]);
    }
    let [displacement, velocity, _] = MOTION;
    let status = one.set_slopes(
        &[displacement, displacement, velocity],
        &[1, 2, 1],
        &[v, a, a],
    );
    one.well(status);
    one.well(one.step(0.0, 1e-3));
    for tick in 1..=10 {
        let t = f64::from(tick) * 1e-4;
        many.well(many.set(&MOTION, &[y + t * (v + 0.5 * t * a), v + t * a, a]));
        many.well(many.step(t - 1e-4, 1e-4));
    }
    assert!((one.force() / many.force() - 1.0).abs() < 1e-13);
    // Held from then on.
    many.well(many.set(&MOTION, &[y, v, a]));
    for master in [&one, &many] {
        master.well(master.step(1e-3, 1e-3));
    }
    assert!((one.force() / many.force() - 1.0).abs() < 1e-13);
}

/// For a sine of 20 Hz and 0.1 mm, with the inputs of the step's beginning and a number of their derivatives: RMS of the force's
/// error over that of the force, and its largest value over the largest force. The page's table contains these.
fn cost(ticks: usize, order: usize) -> [f64; 2] {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let [coarse, fine] = [unpacked.instance(), unpacked.instance()];
    let w = std::f64::consts::TAU * 20.0;
    let motion = |t: f64| {
        // No tick coincides with a reversal of friction: the last bit of the velocity would decide there.
        let (sin, cos) = (w * t + 0.2).sin_cos();
        [
            1e-4 * sin,
            1e-4 * w * cos,
            -1e-4 * w * w * sin,
            -1e-4 * w.powi(3) * cos,
        ]
    };
    for master in [&coarse, &fine] {
        let [y, v, a, _] = motion(0.0);
        master.begin([y, v, a]);
    }
    let (mut largest, mut peak) = (0.0_f64, 0.0_f64);
    let (mut squares, mut size) = (0.0, 0.0);
    for step in 0..2000 / ticks {
        let begin = step * ticks;
        let t = begin as f64 * 1e-4;
        let [y, v, a, jerk] = motion(t);
        coarse.well(coarse.set(&MOTION, &[y, v, a]));
        let [displacement, velocity, acceleration] = MOTION;
        if order > 0 {
            let references = [displacement, velocity, acceleration];
            coarse.well(coarse.set_slopes(&references, &[1; 3], &[v, a, jerk]));
        }
        if order > 1 {
            let fourth = w.powi(4) * y;
            let references = [displacement, velocity, acceleration];
            coarse.well(coarse.set_slopes(&references, &[2; 3], &[a, jerk, fourth]));
        }
        coarse.well(coarse.step(t, ticks as f64 * 1e-4));
        for tick in begin + 1..=begin + ticks {
            let [y, v, a, _] = motion(tick as f64 * 1e-4);
            fine.well(fine.set(&MOTION, &[y, v, a]));
            fine.well(fine.step((tick - 1) as f64 * 1e-4, 1e-4));
            peak = peak.max(fine.force().abs());
        }
        let error = coarse.force() - fine.force();
        largest = largest.max(error.abs());
        squares += error * error;
        size += fine.force() * fine.force();
    }
    [(squares / size).sqrt(), largest / peak]
}

/// The table of the page equals the computed one.
#[test]
fn the_page_says_what_the_hold_of_an_input_costs() {
    let page = include_str!("../../../../docs/fmu.md");
    let mut before = [f64::INFINITY; 3];
    let mut lacking = Vec::new();
    for (ticks, size) in [
        (50, "5 ms"),
        (20, "2 ms"),
        (10, "1 ms"),
        (5, "0.5 ms"),
        (2, "0.2 ms"),
        (1, "0.1 ms"),
    ] {
        let [held, first, second] = [0, 1, 2].map(|order| cost(ticks, order));
        let costs = [held[0], first[0], second[0]];
        for (cost, before) in costs.iter().zip(before) {
            assert!(*cost < before, "{size}: {costs:?}");
        }
        assert!(
            second[0] < first[0] && first[0] < held[0],
            "{size}: {costs:?}"
        );
        before = costs;
        let percent = |part: f64| match 100.0 * part {
            percent if percent >= 0.01 => format!("{percent:.2}"),
            percent => format!("{percent:.0e}"),
        };
        let [held, largest, first, second] = [held[0], held[1], first[0], second[0]].map(percent);
        let row = format!("| {size} | {held} | {largest} | {first} | {second} |");
        if !page.contains(&row) {
            lacking.push(row);
        }
    }
    assert!(
        lacking.is_empty(),
        "docs/fmu.md lacks\n{}",
        lacking.join("\n")
    );
}

#[test]
fn instances_know_nothing_of_each_other() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let [one, other] = [unpacked.instance(), unpacked.instance()];
    one.begin([1e-4, 0.0, 0.0]);
    assert_eq!(other.try_get(16).0, Status::Error);
    other.said();
    other.begin([-1e-4, 0.0, 0.0]);
    one.well(one.step(0.0, 1e-4));
    assert_eq!(one.force(), -other.force());
}
