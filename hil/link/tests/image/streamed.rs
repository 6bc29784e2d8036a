//! A streamed motion on an image has the bits of that on the host.

use mesh_damper::rig::TripCause;
use mesh_damper_link::image::Board;
use mesh_damper_link::lockstep::{LinkError, run_rig_on};
use mesh_damper_rig::drive::{Grid, RandomMotion};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{RigSetup, run_rig};

use crate::support::{EFFECTS, boards_with_rig, image_on, setup};

/// The rig of [`setup`], following a motion of up to 12 Hz.
fn driven() -> RigSetup<Specimen, 4, EFFECTS> {
    let random = RandomMotion {
        rms: 0.06,
        from: 1.0,
        to: 12.0,
        duration: 2.0,
        seed: 4,
    };
    let motion = random.motion(Grid::at(10_000.0)).unwrap();
    let of_sines = setup();
    let mut setup = RigSetup::driven(of_sines.specimen, of_sines.law, motion, 5).unwrap();
    setup.record_every = 1;
    setup
}

#[test]
fn a_streamed_motion_on_every_board_is_the_hosts_to_the_last_bit_of_each_sample() {
    let host = run_rig(driven(), |_| {}).unwrap();
    assert!(host.faults.is_empty() && host.ticks > 40_000 && host.cycles.is_empty());
    // Effects that count cycles have some.
    assert!(host.samples.cycle.iter().any(|cycle| *cycle > 10));
    for board in boards_with_rig() {
        let Some(mut image) = image_on(board) else {
            return;
        };
        let run = run_rig_on(&mut image, driven(), |_| {}).unwrap();
        assert!(run == host, "{board:?}");
        let statistics = image.statistics().unwrap();
        // The same limit as for a programme, above.
        assert!(statistics.stack <= 1760, "{statistics:?}");
    }
}

#[test]
fn a_streamed_motion_that_asks_for_too_much_stops_the_image_as_it_does_the_host() {
    let beyond = || {
        let mut setup = driven();
        setup.stream.velocity_limit = 4.0;
        setup
    };
    let host = run_rig(beyond(), |_| {}).unwrap();
    assert!(matches!(host.faults[..], [(_, TripCause::DemandLimit)]));
    let Some(mut image) = image_on(Board::Mps2An386) else {
        return;
    };
    assert_eq!(run_rig_on(&mut image, beyond(), |_| {}).unwrap(), host);
}

#[test]
fn a_rig_of_sines_takes_no_knots() {
    let Some(mut image) = image_on(Board::Mps2An386) else {
        return;
    };
    let error = image.knots(&[]).unwrap_err();
    assert!(matches!(error, LinkError::Refused { .. }), "{error}");
    run_rig_on(&mut image, setup(), |_| {}).unwrap();
    let error = image.knots(&[]).unwrap_err();
    assert!(matches!(error, LinkError::Refused { .. }), "{error}");
}
