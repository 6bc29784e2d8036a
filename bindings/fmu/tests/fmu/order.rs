//! Calls out of order or with errors: they are refused with a reason, and have no effect.

use std::ffi::{CStr, c_int};
use std::ptr;

use mesh_damper_fmu::functions::*;
use mesh_damper_fmu::types::Status;
use mesh_damper_fmu::variables::{AMPLITUDE, FORCE, IDENTITY, TICK_RATE, WITHIN_RANGE};

use crate::master::{MODEL_WITH_HISTORY, MOTION, Unpacked};

#[test]
fn calls_out_of_order_are_refused() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    let c = master.handle;
    master.refused(
        fmi2EnterInitializationMode(c),
        &[
            "the start time is not known",
            "call fmi2SetupExperiment first",
        ],
    );
    for status in [
        fmi2ExitInitializationMode(c),
        fmi2Terminate(c),
        master.step(0.0, 1e-4),
    ] {
        assert_eq!(status, Status::Error);
    }
    for (_, said) in master.said() {
        assert!(
            said.contains(
                "called when Instantiated: out of order; call fmi2EnterInitializationMode"
            ),
            "{said}"
        );
    }
    master.refused(master.try_get(FORCE).0, &["fmi2GetReal", "out of order"]);
    master.set_up(0.0);
    master.refused(
        master.step(0.0, 1e-4),
        &["fmi2DoStep", "call fmi2ExitInitializationMode first"],
    );
    master.refused(
        fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0),
        &["fmi2SetupExperiment"],
    );
    master.well(fmi2ExitInitializationMode(c));
    master.refused(fmi2EnterInitializationMode(c), &["fmi2Reset first"]);
    master.well(master.step(0.0, 1e-4));
    master.well(fmi2Terminate(c));
    master.refused(
        master.step(1e-4, 1e-4),
        &["called when Terminated", "call fmi2Reset first"],
    );
    master.refused(master.set(&MOTION, &[0.0; 3]), &["fmi2SetReal"]);
    // Computed values may still be read.
    master.force();
    master.well(fmi2Reset(c));
    master.begin([1e-4, 0.0, 0.0]);
    master.well(master.step(0.0, 1e-4));
}

#[test]
fn a_wrong_value_changes_nothing() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    let c = master.handle;
    master.begin([1e-4, 1e-3, 0.0]);
    let before = master.bytes(master.save());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let status = master.set(&MOTION, &[2e-4, bad, 0.0]);
        master.refused(
            status,
            &["velocity = ", "no finite number", "give a finite number"],
        );
        master.refused(
            master.set_slopes(&MOTION[..1], &[1], &[bad]),
            &["displacement = "],
        );
        master.refused(master.step(bad, 1e-4), &["currentCommunicationPoint = "]);
        master.refused(master.step(0.0, bad), &["communicationStepSize = "]);
    }
    for unknown in [AMPLITUDE, 3, 4, 5, 99, u32::MAX] {
        let status = master.set(&[MOTION[0], unknown], &[1.0, 1.0]);
        let field = format!("valueReference = {unknown}");
        let parts = [
            field.as_str(),
            "no variable of this FMU has it",
            "modelDescription.xml",
        ];
        master.refused(status, &parts);
        master.refused(master.try_get(unknown).0, &parts);
    }
    for fixed in [FORCE, WITHIN_RANGE, TICK_RATE, IDENTITY] {
        master.refused(master.set(&[fixed], &[1.0]), &["is not to be set"]);
    }
    master.refused(
        master.set_slopes(&[FORCE], &[1], &[1.0]),
        &["force is no input"],
    );
    for order in [0, 3, -1, c_int::MIN] {
        master.refused(
            master.set_slopes(&MOTION[..1], &[order], &[1.0]),
            &["order = ", "give 1 or 2"],
        );
    }
    master.refused(
        master.try_get(WITHIN_RANGE).0,
        &["not of the type of fmi2GetReal"],
    );
    let mut text = ptr::null();
    // SAFETY: one reference, and room for one.
    let status = unsafe { fmi2GetString(c, &FORCE, 1, &mut text) };
    master.refused(status, &["force is not of the type of fmi2GetString"]);
    // SAFETY: one reference, and room for one.
    let status = unsafe { fmi2GetInteger(c, &FORCE, 1, &mut 0) };
    master.refused(status, &["force is not of the type of fmi2GetInteger"]);
    assert_eq!(master.bytes(master.save()), before);
}

#[test]
fn null_and_handles_that_are_none_are_refused() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    let c = master.handle;
    master.begin([0.0; 3]);
    // SAFETY: the test passes NULL.
    unsafe {
        master.refused(fmi2GetReal(c, ptr::null(), 1, &mut 0.0), &["vr = NULL"]);
        master.refused(
            fmi2GetReal(c, &FORCE, 1, ptr::null_mut()),
            &["value = NULL"],
        );
        master.refused(
            fmi2SetReal(c, &MOTION[0], 1, ptr::null()),
            &["value = NULL"],
        );
        master.refused(
            fmi2GetBoolean(c, &WITHIN_RANGE, 1, ptr::null_mut()),
            &["value = NULL"],
        );
        master.refused(fmi2GetFMUstate(c, ptr::null_mut()), &["FMUstate = NULL"]);
        master.refused(fmi2GetReal(c, &FORCE, usize::MAX, &mut 0.0), &["items"]);
        master.well(fmi2GetReal(c, ptr::null(), 0, ptr::null_mut()));
        master.refused(
            fmi2SetDebugLogging(c, 1, 1, [c"noise".as_ptr()].as_ptr()),
            &["category = noise", "logStatusError"],
        );
    }
    for none in [ptr::null_mut(), ptr::without_provenance_mut(usize::MAX)] {
        assert_eq!(fmi2DoStep(none, 0.0, 1e-4, 1), Status::Error);
        fmi2FreeInstance(none);
    }
    let freed = unpacked.instance().handle;
    assert_eq!(fmi2Reset(freed), Status::Error);
    fmi2FreeInstance(freed);
}

#[test]
fn what_is_not_provided_says_so() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    let c = master.handle;
    master.begin([0.0; 3]);
    let (none, one) = (ptr::null(), ptr::null());
    master.refused(
        fmi2GetDirectionalDerivative(c, none, 1, one, 1, ptr::null(), ptr::null_mut()),
        &["providesDirectionalDerivative"],
    );
    master.refused(
        fmi2GetRealOutputDerivatives(c, &FORCE, 1, &1, &mut 0.0),
        &["maxOutputDerivativeOrder"],
    );
    master.refused(fmi2CancelStep(c), &["no step is under way"]);
    assert_eq!(fmi2GetStatus(c, 0, &mut 0), Status::Discard);
    assert_eq!(fmi2GetStringStatus(c, 1, &mut ptr::null()), Status::Discard);
    master.said();
    master.well(master.step(0.0, 3e-4));
    let mut time = 0.0;
    // SAFETY: there is room for one.
    master.well(unsafe { fmi2GetRealStatus(c, 2, &mut time) });
    assert!((time - 3e-4).abs() < 1e-15);
    let mut ends = 7;
    // SAFETY: there is room for one.
    master.well(unsafe { fmi2GetBooleanStatus(c, 3, &mut ends) });
    assert_eq!(ends, 0);
}

#[test]
fn constants_are_read_and_the_range_is_watched() {
    let unpacked = Unpacked::new(MODEL_WITH_HISTORY, 1e4);
    let master = unpacked.instance();
    let c = master.handle;
    master.begin([1e-4, 0.0, 0.0]);
    assert_eq!(master.get(TICK_RATE), 1e4);
    let mut text = ptr::null();
    // SAFETY: one reference, and room for one.
    master.well(unsafe { fmi2GetString(c, &IDENTITY, 1, &mut text) });
    // SAFETY: it ends in NUL, and stays until the instance is freed.
    let identity = unsafe { CStr::from_ptr(text) }.to_str().unwrap();
    assert_eq!(identity, unpacked.contents.file.identity().to_string());
    let is_within = || {
        let mut value = 7;
        // SAFETY: one reference, and room for one.
        assert_eq!(
            unsafe { fmi2GetBoolean(c, &WITHIN_RANGE, 1, &mut value) },
            Status::Ok
        );
        value
    };
    assert_eq!(is_within(), 1);
    master.well(master.set(&MOTION, &[3e-4, 0.0, 0.0]));
    assert_eq!(master.step(0.0, 1e-3), Status::Ok);
    assert_eq!(is_within(), 0);
    let said = master.said();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].1.contains("left the operating range"));
    // One warning each time that the motion leaves the range, and none if warnings are off.
    master.well(master.step(1e-3, 1e-3));
    master.well(master.set(&MOTION, &[0.0; 3]));
    master.well(master.step(2e-3, 1e-3));
    // SAFETY: without categories there is none to read.
    master.well(unsafe { fmi2SetDebugLogging(c, 0, 0, ptr::null()) });
    master.well(master.set(&MOTION, &[0.0, 0.1, 0.0]));
    master.well(master.step(3e-3, 1e-3));
    assert_eq!(is_within(), 0);
}
