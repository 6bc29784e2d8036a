//! The correction of the command: its convergence and its limits.

use std::f64::consts::TAU;
use std::rc::Rc;

use mesh_damper::dac::OUTPUT_RANGE;
use mesh_damper::rig::{RigSettings, State, Telemetry};
use mesh_damper_rig::actuator::{AdcPins, DacPins};

use super::wired::{FailingLine, wired};
use super::{demodulate, programme};
use crate::support::{Ticks, elastic};

/// Telemetry of 0.05 mm at 2 Hz with an actuator that follows `gain` times the command `delay` ticks later.
fn on_an_actuator(gain: f64, delay: usize, frequency: f64, cycles: u32) -> Vec<Telemetry> {
    let (adc, dac) = (Rc::<AdcPins>::default(), Rc::<DacPins>::default());
    let settings = RigSettings {
        correction_gain: 0.5,
        correction_limit: 10.0,
        feedback: 0.0,
        ..RigSettings::default()
    };
    let mut rig = wired(
        (&adc, &dac),
        FailingLine::default(),
        &settings,
        programme(&[(0.05, frequency, cycles)]),
        elastic(),
    );
    rig.start().unwrap();
    let mut way = std::collections::VecDeque::from(vec![0.0; delay]);
    let mut run = Vec::new();
    let mut ticks = Ticks::default();
    while rig.state() == State::Running {
        way.push_back(gain * dac.volts.get() / OUTPUT_RANGE);
        let volts = way.pop_front().unwrap() * mesh_damper::adc::INPUT_RANGE;
        // A force in proportion.
        adc.volts[0].set(volts);
        adc.volts[1].set(volts);
        run.push(rig.tick(ticks.next()));
    }
    assert_eq!(rig.state(), State::Done);
    run
}

#[test]
fn the_error_after_correction_falls_by_the_same_part_each_cycle() {
    let run = on_an_actuator(0.9, 100, 2.0, 6);
    let errors: Vec<_> = (1..6)
        .map(|cycle| {
            let moved: Vec<_> = run
                .iter()
                .filter(|t| t.cycle == cycle)
                .map(|t| (f64::from(t.displacement), t.phase))
                .collect();
            let (amplitude, phase) = demodulate(&moved, 2.0);
            (
                1.0 - amplitude / 0.05 * phase.cos(),
                amplitude / 0.05 * phase.sin(),
            )
        })
        .collect();
    // The dead time of 10 ms.
    let phase = TAU * 2.0 * 0.01;
    assert!((errors[0].1 + 0.9 * phase.sin()).abs() < 2e-3, "{errors:?}");
    for two in errors.windows(2) {
        // A gain of 0.5 halves 1 − Y. Transition and dead time, 15 ms of the 500 ms, still contain the previous cycle: 3 % of its
        // error, doubled where the sine is at its crest. The ADC's noise-free step is 3e-5 mm of 0.05 mm.
        let tolerance = |before: f64| 0.06 * before.abs() + 6e-4;
        assert!(
            (two[1].0 - 0.5 * two[0].0).abs() < tolerance(two[0].0),
            "{errors:?}"
        );
        assert!(
            (two[1].1 - 0.5 * two[0].1).abs() < tolerance(two[0].1),
            "{errors:?}"
        );
    }
}

#[test]
fn the_correction_stays_within_its_limits() {
    // A gain of 0.15 requires 6.7; the limit is 5.
    let run = on_an_actuator(0.15, 0, 2.0, 12);
    let peak = run.iter().map(|t| t.command.abs()).fold(0.0, f32::max);
    assert!((peak / 0.05 - 5.0).abs() < 0.01, "{peak}");
    // A dead time of 0.2 s at 0.5 Hz requires 0.19 s of lead; the limit is 0.1: the command where the demand is 0.
    let run = on_an_actuator(1.0, 2000, 0.5, 12);
    let lead = run
        .iter()
        .filter(|t| t.phase == 0 && !t.ramp)
        .map(|t| t.command / (0.05 * TAU as f32 * 0.5))
        .fold(0.0, f32::max);
    assert!((lead / 0.1 - 1.0).abs() < 0.01, "{lead}");
}
