//! All code that runs every tick, with any floats as input.

use mesh_damper::crossing::CrossingAccumulator;
use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::effects::{AugmentedLaw, CONTROLS, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::observer::{Observer, ObserverConfig};

use crate::feed::{Feed, Random};
use crate::law::{EFFECTS, law};

fn motion(random: &mut Random) -> Motion<f32> {
    Motion {
        displacement: random.float(),
        velocity: random.float(),
        acceleration: random.float(),
        cycles: random.float(),
        temperature: random.float(),
        controls: [(); CONTROLS].map(|()| random.float()),
    }
}

/// A law's force at some motions, with and without the table of the fast law.
pub fn forces_are_finite(law: &AugmentedLaw<f32, EFFECTS>) {
    let mut random = Random::of(b"motions");
    let mut running = RunningLaw::new(FastLaw::new(law.clone()));
    let mut state = law.at_rest();
    for _ in 0..16 {
        let motion = motion(&mut random);
        let (tabulated, direct) = (running.force(&motion), law.force(&mut state, &motion));
        assert!(
            tabulated.is_finite() && direct.is_finite(),
            "{law:?} at {motion:?}"
        );
    }
}

/// Whether every field of the cycle is finite.
pub fn is_finite(cycle: &Cycle) -> bool {
    cycle.values().iter().all(|value| value.is_finite())
}

/// Law, observer and cycles, for `ticks` ticks with any floats.
pub fn check(script: &[u8], ticks: u32) {
    let feed = &mut Feed(script);
    let tick_rate = feed.between(1.0, 1e6);
    let observer_config = ObserverConfig::new(
        tick_rate,
        feed.between(1e-3, 0.0999 * tick_rate.max(0.1)).max(1e-3),
        feed.between(0.3, 3.0),
    )
    .expect("all are in range");
    let laws = [law(feed, 1.0 / tick_rate), law(feed, 1.0 / tick_rate)];
    let hysteresis = feed.between(1e-9, 1e4) as f32;
    let mut running = RunningLaw::new(FastLaw::new(laws[0].clone()));
    let mut observer = Observer::default();
    let mut cycles = CycleAccumulator::<2>::new();
    let mut crossing =
        CrossingAccumulator::new(hysteresis.clamp(1e-9, 1e4)).expect("it is in range");
    let mut random = Random::of(script);
    let mut phase = 0u32;
    for tick in 0..ticks {
        if tick % 512 == 511 {
            let next = &laws[usize::from(random.next().is_multiple_of(2))];
            running.swap(FastLaw::new(next.clone()));
            running.boundary();
        }
        let motion = motion(&mut random);
        let force = running.force(&motion);
        assert!(
            force.is_finite(),
            "force {force} at {motion:?} of {:?}",
            running.law()
        );
        let estimate = observer.update(&observer_config, motion.displacement, motion.acceleration);
        for value in [
            estimate.displacement,
            estimate.velocity,
            estimate.acceleration,
        ] {
            assert!(value.is_finite(), "{estimate:?} of {observer_config:?}");
        }
        phase = phase.wrapping_add(random.next() as u32 >> 4);
        let ended = cycles.update(motion.displacement, [force, random.float()], phase);
        for cycle in ended.iter().flatten() {
            assert!(is_finite(cycle), "{cycle:?}");
        }
        if let Some(cycle) = crossing.update(motion.displacement, random.float()) {
            assert!(is_finite(&cycle), "{cycle:?}");
        }
    }
}
