//! States: saved, restored, as bytes, and refused.

use std::ptr;

use mesh_damper_fmu::functions::*;
use mesh_damper_fmu::types::Status;
use proptest::prelude::*;

use crate::master::{MODEL_WITH_HISTORY, MOTION, Master, Unpacked};

/// A model with much memory: a ring of forces, and a residual table's average.
fn rich_model() -> String {
    let cells: Vec<String> = (0..306).map(|cell| (cell % 23 - 11).to_string()).collect();
    MODEL_WITH_HISTORY
        .replace("[-20.0, 20.0]", "[-100.0, 100.0]")
        .replace("[-0.2, 0.2]", "[-0.3, 0.3]")
        .replace(
            r#""effects": ["#,
            r#""effects": [ { "family": "delay", "parameters": { "time": 0.0037 } },
                { "family": "compliance", "parameters": { "stiffness": 60.0 } },
                { "family": "periodic", "parameters": { "amplitude": 0.02, "frequency": 50.0, "phase": 0.3 } },
                { "family": "degradation", "parameters": { "stiffness": 1.5, "softening": 0.08 } },"#,
        )
        .replace(
            r#""fitted_range""#,
            &format!(
                r#""correction": {{ "reach": 0.2, "speed": 20.0, "unit": 0.001, "cells": [{}],
                    "memory": {{ "of": {{ "lag": {{ "time": 0.02 }} }}, "range": [-0.1, 0.1] }} }}, "fitted_range""#,
                cells.join(",")
            ),
        )
}

/// The force after each of the steps from `from` on, for a motion of two tones with the rates `tones`.
fn run(master: &Master, steps: std::ops::Range<usize>, tones: [f64; 2]) -> Vec<u64> {
    steps
        .map(|step| {
            let t = step as f64 * 1e-3;
            let [a, b] = tones;
            let y = 1e-4 * ((a * t).sin() + (b * t).cos());
            let v = 1e-4 * (a * (a * t).cos() - b * (b * t).sin());
            master.well(master.set(&MOTION, &[y, v, 0.0]));
            master.well(master.step(t, 1e-3));
            master.force().to_bits()
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn what_follows_a_restored_state_is_the_same_to_the_last_bit(
        tones in [20.0..300.0_f64, 20.0..300.0],
        before in 0..120_usize,
        after in 1..60_usize,
        astray in 1..40_usize,
    ) {
        let unpacked = Unpacked::new(&rich_model(), 1e4);
        let master = unpacked.instance();
        master.begin([0.0; 3]);
        run(&master, 0..before, tones);
        let saved = master.save();
        let bytes = master.bytes(saved);
        let first = run(&master, before..before + after, tones);

        master.well(fmi2SetFMUstate(master.handle, saved));
        prop_assert_eq!(&run(&master, before..before + after, tones), &first);

        // After steps with another motion, through bytes.
        master.well(fmi2SetFMUstate(master.handle, saved));
        run(&master, before..before + astray, [31.0, 250.0]);
        let (status, read) = master.deserialize(&bytes);
        master.well(status);
        master.well(fmi2SetFMUstate(master.handle, read));
        prop_assert_eq!(&run(&master, before..before + after, tones), &first);

        // In another instance that has not started.
        let other = unpacked.instance();
        let (status, read) = other.deserialize(&bytes);
        other.well(status);
        other.well(fmi2SetFMUstate(other.handle, read));
        prop_assert_eq!(other.bytes(other.save()), bytes);
        prop_assert_eq!(&run(&other, before..before + after, tones), &first);
    }
}

/// Without this test, the property above would also hold for a law without a memory.
#[test]
fn the_history_matters() {
    let unpacked = Unpacked::new(&rich_model(), 1e4);
    let after = |tones: [f64; 2]| {
        let master = unpacked.instance();
        master.begin([0.0; 3]);
        run(&master, 0..50, tones);
        run(&master, 50..51, [100.0, 90.0])
    };
    assert_ne!(after([100.0, 90.0]), after([70.0, 190.0]));
}

#[test]
fn a_state_is_saved_over_another_and_freed_once() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    master.begin([0.0; 3]);
    let mut saved = master.save();
    let at_start = master.bytes(saved);
    run(&master, 0..3, [100.0, 50.0]);
    let before = saved;
    // SAFETY: there is one.
    master.well(unsafe { fmi2GetFMUstate(master.handle, &mut saved) });
    assert_eq!(saved, before);
    assert_ne!(master.bytes(saved), at_start);
    // SAFETY: there is one.
    master.well(unsafe { fmi2FreeFMUstate(master.handle, &mut saved) });
    assert!(saved.is_null());
    // The standard requires that NULL is ignored. SAFETY: NULL is allowed.
    master.well(unsafe { fmi2FreeFMUstate(master.handle, &mut saved) });
    // SAFETY: NULL is allowed.
    master.well(unsafe { fmi2FreeFMUstate(master.handle, ptr::null_mut()) });
    let unknown = &["FMUstate = 1", "no state that this instance saved"];
    master.refused(fmi2SetFMUstate(master.handle, before), unknown);
    let mut freed = before;
    // SAFETY: there is one.
    master.refused(
        unsafe { fmi2FreeFMUstate(master.handle, &mut freed) },
        unknown,
    );
    // SAFETY: there is one.
    master.refused(
        unsafe { fmi2GetFMUstate(master.handle, &mut freed) },
        unknown,
    );
    master.refused(
        fmi2SetFMUstate(master.handle, ptr::null_mut()),
        &["FMUstate = 0"],
    );
}

#[test]
fn bytes_that_are_no_state_are_refused() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    master.begin([0.0; 3]);
    let bytes = master.bytes(master.save());
    let refused = |bytes: &[u8], problem: &str| {
        let (status, saved) = master.deserialize(bytes);
        master.refused(
            status,
            &["serializedState", problem, "fmi2SerializeFMUstate"],
        );
        assert!(saved.is_null());
    };
    refused(&[], "no state of such an FMU");
    refused(b"some text that is longer", "no state of such an FMU");
    for length in 8..bytes.len() {
        let (status, _) = master.deserialize(&bytes[..length]);
        assert_eq!(status, Status::Error);
    }
    master.said();
    for place in 0..bytes.len() {
        let mut other = bytes.clone();
        other[place] ^= 0x10;
        assert_eq!(master.deserialize(&other).0, Status::Error, "{place}");
    }
    master.said();
    let other = Unpacked::new(MODEL_WITH_HISTORY, 2e4).instance();
    other.begin([0.0; 3]);
    refused(&other.bytes(other.save()), "a state of another FMU");

    let saved = master.save();
    let mut short = vec![0; bytes.len() - 1];
    // SAFETY: there is room for as many.
    let status =
        unsafe { fmi2SerializeFMUstate(master.handle, saved, short.as_mut_ptr(), short.len()) };
    master.refused(status, &["size = ", "fmi2SerializedFMUstateSize"]);
}
