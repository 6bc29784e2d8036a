//! A rig that was attacked and repaired starts from neutral, and slowly.

use mesh_damper::rig::State;

use super::Rig;

/// A correction that was learned with a bad channel is not used with the repaired one.
#[test]
fn a_repaired_rig_starts_from_neutral() {
    for gain in [0.85, 0.6] {
        let mut rig = Rig::new(1, 20, 1);
        rig.run(|a| *a.volts[0] *= if a.cycle > 5.0 { gain } else { 1.0 });
        rig.bench.rig.stop();
        for _ in 0..6000 {
            rig.tick(|_| {});
        }
        let _ = rig.bench.rig.clear();
        rig.bench.rig.clear_events();
        rig.bench.rig.start().unwrap();
        rig.tick = 0;
        let run = rig.run(|_| {});
        assert_eq!(run.state, State::Done);
        assert!(run.furthest < 1.03, "{gain}: {}", run.furthest);
    }
}

/// The largest speed is that of the motion to the start, 0.25 mm in half a second.
#[test]
fn a_start_where_the_piston_is_not_goes_there_slowly() {
    let mut rig = Rig::new(1, 3, 1);
    // A stop at the crest leaves the piston there.
    rig.run_until_crest();
    rig.bench.rig.stop();
    for _ in 0..6000 {
        rig.tick(|_| {});
    }
    let left = rig.bench.plant.servo.displacement();
    assert!(left.abs() > 0.05, "{left}");
    rig.bench.rig.start().unwrap();
    // During its dead time of a millisecond the servo follows the previous command: 0.015 mm allow for that.
    for _ in 0..200 {
        rig.tick(|_| {});
    }
    assert!((rig.bench.plant.servo.displacement() - left).abs() < 0.015);
    let mut fastest = 0.0f64;
    for _ in 0..4000 {
        let (_, seen) = rig.tick(|_| {});
        assert_eq!(seen.state, State::Running);
        fastest = fastest.max(rig.bench.plant.servo.velocity().abs());
    }
    let way = left.abs() / 0.5;
    assert!(fastest < 1.1 * way, "{fastest} mm/s of {way}");
    rig.tick = 0;
    assert_eq!(rig.run(|_| {}).state, State::Done);
}
