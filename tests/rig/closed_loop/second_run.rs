//! After a stop, the rig runs again in the same way as the first time.

use std::rc::Rc;

use mesh_damper::effects::{Effect, StickSlip};
use mesh_damper::rig::{ClearRefused, RigSettings, StartRefused, State};
use mesh_damper_rig::actuator::AdcPins;

use super::wired::{FailingLine, wired};
use super::{programme, setup, started};
use crate::support::{Ticks, elastic};

#[test]
fn it_can_be_stopped_and_runs_again() {
    let mut bench = started(setup(3.0, &[(0.2, 5.0, 5)]));
    assert_eq!(bench.rig.start(), Err(StartRefused::Running));
    assert_eq!(bench.rig.clear(), Err(ClearRefused::NoFault));
    for _ in 0..3000 {
        assert!(bench.tick().state == State::Running && bench.enabled.get());
    }
    bench.rig.stop();
    assert!(bench.rig.state() == State::Idle && !bench.enabled.get());
    assert_eq!(bench.rig.start(), Err(StartRefused::Moving));
    assert_eq!(bench.rig.clear(), Err(ClearRefused::NoFault));
    for _ in 0..5001 {
        bench.tick();
    }
    bench.rig.start().unwrap();
    assert_eq!(bench.tick().cycle, 0);
}

#[test]
fn a_second_run_begins_as_the_first() {
    // The displacement reads 0 except for noise of one step, which shows that the channel is alive. The observer sees the error of
    // its feed-forward, about 1e-4 mm, and the joints slip at 1e-5 mm. The force reads about 0.01 kN, as much as the force of the
    // joints.
    let adc = Rc::<AdcPins>::default();
    let flicker = |tick: usize| {
        let step = (tick % 2) as f64 / 32_768.0;
        adc.volts[0].set(step * mesh_damper::adc::INPUT_RANGE);
        adc.volts[1].set((0.01 + step) * mesh_damper::adc::INPUT_RANGE);
    };
    let joints = Effect::StickSlip(StickSlip::new(&[(1000.0, 1e-5)]).unwrap());
    let make = || {
        wired(
            (&adc, &Rc::default()),
            FailingLine::default(),
            &RigSettings::default(),
            programme(&[(0.1, 2.0, 1)]),
            elastic().with(joints).unwrap(),
        )
    };
    let (mut first, mut second) = (make(), make());
    let (mut firsts, mut seconds) = (Ticks::default(), Ticks::default());
    second.start().unwrap();
    for tick in 0..3_000 {
        flicker(tick);
        second.tick(seconds.next());
    }
    second.stop();
    for tick in 0..10_000 {
        flicker(tick);
        first.tick(firsts.next());
        second.tick(seconds.next());
    }
    first.start().unwrap();
    second.start().unwrap();
    for tick in 0..=5_000 {
        flicker(tick);
        let (a, b) = (first.tick(firsts.next()), second.tick(seconds.next()));
        assert_eq!((a.command, a.cycle, a.phase), (b.command, b.cycle, b.phase));
        // The observer's memory of the first run has decayed to e⁻⁵⁰ or less.
        let difference = (a.model_force - b.model_force).abs();
        assert!(difference < 1e-5, "{difference} at {tick}");
        if let (Some(a), Some(b)) = (a.report, b.report) {
            assert_eq!(a.model.ticks, b.model.ticks);
            assert!((a.nrmse - b.nrmse).abs() < 1e-4 && a.nrmse > 0.1);
        }
        assert_eq!(a.report.is_some(), b.report.is_some());
        assert_eq!(a.report.is_some(), tick == 5_000);
    }
}

#[test]
fn a_second_run_counts_its_own_ticks_beyond_a_limit() {
    let adc = Rc::<AdcPins>::default();
    let mut rig = wired(
        (&adc, &Rc::default()),
        FailingLine::default(),
        // The piston is far from the start, which these settings permit.
        &RigSettings {
            tracking_limit: 1.0,
            ..RigSettings::default()
        },
        programme(&[(0.1, 2.0, 1)]),
        elastic(),
    );
    adc.volts[0].set(0.53 * mesh_damper::adc::INPUT_RANGE);
    let mut ticks = Ticks::default();
    for _ in 0..3 {
        rig.start().unwrap();
        // One less than would trip.
        for _ in 0..9 {
            assert_eq!(rig.tick(ticks.next()).state, State::Running);
        }
        rig.stop();
        for _ in 0..5_002 {
            rig.tick(ticks.next());
        }
    }
}
