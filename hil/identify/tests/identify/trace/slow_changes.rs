//! Forces that change with the temperature and from cycle to cycle.

use mesh_damper_identify::trace::{Trace, trace};

use super::{BLOCKS, K1, K3, OTHERS, Sample, TICK, families, law, motion, record, trace_of};

/// The temperature in °C at each sample of a test of `samples`, from `first` towards `last`.
fn warming(first: f64, last: f64, samples: usize) -> Vec<f64> {
    let way = |sample: usize| 1.0 - (-(sample as f64) * TICK / 6.0).exp();
    let at = |sample| first + (last - first) * way(sample);
    (0..samples).map(at).collect()
}

/// The law loses the fractions `lost` of its elastic and of its damping force per degree.
fn traced_warm(lost: [f64; 2]) -> Trace {
    let warm = |name, blocks: &[(f64, f64, u32)], seed, first, last| {
        let temperature = warming(first, last, motion(blocks).len());
        let mut rises = temperature.iter().map(|degrees| degrees - 20.0);
        let change = move |sample: &Sample| {
            let elastic = K1 * sample.1 + K3 * sample.1.powi(3);
            let forces = [elastic, law(sample) - elastic];
            let of_degree: f64 = lost
                .iter()
                .zip(forces)
                .map(|(beta, force)| beta * force)
                .sum();
            -rises.next().unwrap_or_default() * of_degree
        };
        let mut recording = record(name, blocks, 0.004, seed, change);
        recording.temperature = Some(temperature.clone());
        recording
    };
    let fitted = warm("fitted", &BLOCKS, 1, 20.0, 45.0);
    // It starts warm and cools down.
    let held = warm("held", &OTHERS, 2, 45.0, 30.0);
    trace(&[fitted], &[held], &|_| ()).unwrap()
}

#[test]
fn what_warmth_takes_of_stiffness_and_of_friction_is_told_apart() {
    for lost in [[0.004, 0.0], [0.0, 0.004], [0.004, 0.004]] {
        let trace = traced_warm(lost);
        assert_eq!(families(&trace.result), ["temperature"], "{lost:?}");
        let parameters = &trace.result.effects[0].parameters;
        let estimates = ["beta", "beta_damping"].map(|name| parameters.get(name));
        let [Some(beta), damping] = estimates else {
            panic!("{lost:?}: {parameters:?}")
        };
        // A single number appears if both are equal.
        assert_eq!(damping.is_none(), lost[0] == lost[1], "{lost:?}");
        for (estimate, truth) in [beta, damping.unwrap_or(beta)].into_iter().zip(lost) {
            let off = (estimate.value - truth).abs();
            // The intervals hold in nine of ten cases.
            let half = 0.5 * (estimate.high - estimate.low);
            assert!(off < 2.0 * half && half < 5e-4, "{lost:?}: {estimate:?}");
        }
        let left = trace.result.on_target.nrmse_held_out / trace.result.noise_floor_nrmse;
        assert!(left < 1.15, "{lost:?}: {left} times the noise");
    }
}

/// The cycle count at each sample of a test.
fn cycles_run(blocks: &[(f64, f64, u32)]) -> Vec<f64> {
    let mut run = 0.0;
    let mut all = Vec::new();
    for &block in blocks {
        for _ in motion(&[block]) {
            all.push(run);
            run += block.1 * TICK;
        }
    }
    all
}

/// In the end, the elastic and damping forces of eq 13 have changed by these fractions; after 12 cycles by 63 % of that.
fn traced_drifting(change: [f64; 2]) -> Trace {
    let drifting = |name, blocks: &[(f64, f64, u32)], seed| {
        let mut run = cycles_run(blocks).into_iter();
        record(name, blocks, 0.004, seed, move |sample| {
            let elastic = K1 * sample.1 + K3 * sample.1.powi(3);
            let done = 1.0 - (-run.next().unwrap_or_default() / 12.0).exp();
            done * (change[0] * elastic + change[1] * (law(sample) - elastic))
        })
    };
    let (fitted, held) = (drifting("fitted", &BLOCKS, 1), drifting("held", &OTHERS, 2));
    trace(&[fitted], &[held], &|_| ()).unwrap()
}

#[test]
fn what_the_cycles_take_of_stiffness_and_of_friction_is_told_apart() {
    for change in [[-0.2, -0.2], [0.0, 0.4], [0.25, -0.3]] {
        let trace = traced_drifting(change);
        assert_eq!(families(&trace.result), ["drift"], "{change:?}");
        let parameters = &trace.result.effects[0].parameters;
        let truths = [
            ("elastic_change", change[0]),
            ("damping_change", change[1]),
            ("cycles", 12.0),
        ];
        for (name, truth) in truths {
            let estimate = &parameters[name];
            let off = (estimate.value - truth).abs();
            // The intervals hold in nine of ten cases.
            let half = 0.5 * (estimate.high - estimate.low);
            assert!(off < 2.0 * half, "{change:?}: {name} {estimate:?}");
            let narrow = if name == "cycles" { 2.0 } else { 0.03 };
            assert!(half < narrow, "{change:?}: {name} {estimate:?}");
        }
        let left = trace.result.on_target.nrmse_held_out / trace.result.noise_floor_nrmse;
        assert!(left < 1.15, "{change:?}: {left} times the noise");
    }
}

/// In blocks in order of their frequency, a stiffness that depends on frequency seems to settle from block to block, but within a
/// block it stands still.
#[test]
fn what_depends_on_frequency_is_no_drift() {
    const RISING: [(f64, f64, u32); 5] = [
        (0.1, 0.5, 6),
        (0.1, 1.0, 8),
        (0.1, 2.5, 10),
        (0.1, 5.0, 12),
        (0.1, 10.0, 12),
    ];
    let by_frequency = |blocks: &'static [(f64, f64, u32)]| {
        move |s: &Sample| {
            let mut end = 0.0;
            let block = blocks.iter().find(|(_, frequency, cycles)| {
                end += f64::from(*cycles) / frequency;
                s.0 < end - 1e-9
            });
            block.map_or(0.0, |(_, frequency, _)| 0.3 * frequency.ln() * s.1)
        }
    };
    const OTHER: [(f64, f64, u32); 2] = [(0.1, 4.0, 8), (0.1, 1.25, 6)];
    let fitted = record("fitted", &RISING, 0.004, 15, by_frequency(&RISING));
    let held = record("held", &OTHER, 0.004, 16, by_frequency(&OTHER));
    let result = trace_of(fitted, held).result;
    assert!(!result.depends_on.iter().any(|name| name == "cycle"));
    let (before, after) = (result.baseline, result.augmented);
    assert!(
        after.nrmse_held_out < 0.4 * before.nrmse_held_out,
        "{after:?}"
    );
}
