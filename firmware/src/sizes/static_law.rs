//! A firmware with a fixed law: mixed damping law, stick-slip, and the results of each cycle.

use core::hint::black_box;

use mesh_damper::cycle::CycleAccumulator;
use mesh_damper::effects::StickSlip;
use mesh_damper::law::Law;
use mesh_damper::power::{OCTAVES, PowerSeed, SEGMENTS, Segment};
use mesh_damper::static_law::StaticLaw;
use mesh_damper::tick_law::TickLaw as _;

use super::{TICKS, motion};
use crate::board::Board;

/// `PowerSeed::octave` and `PowerSeed::scale` for c = 0.1 and α = 0.3, computed on a host.
const OCTAVE: [Segment; SEGMENTS] = [
    [0.54508185, 0.66045636, -0.2561416, 0.050603464],
    [0.50100243, 0.54300565, -0.18839642, 0.033300832],
    [0.46467638, 0.45558253, -0.14299595, 0.02286815],
    [0.4341421, 0.38857782, -0.11135039, 0.016258609],
    [0.40805948, 0.33597723, -0.08856964, 0.011897587],
    [0.38547966, 0.29385066, -0.07172278, 0.008920785],
    [0.36571047, 0.2595365, -0.05897637, 0.006829459],
    [0.34823444, 0.23117708, -0.04914135, 0.0053233975],
];
const SCALE: [f32; OCTAVES] = [
    2661.5886,
    1638.4,
    1008.5535,
    620.8375,
    382.17032,
    235.25342,
    144.81548,
    89.14438,
    54.8748,
    33.779404,
    20.793661,
    12.8,
    7.8793244,
    4.850293,
    2.9857056,
    1.8379173,
    1.1313709,
    0.69644046,
    0.4287094,
    0.2639016,
    0.16245048,
    0.1,
    0.061557222,
    0.037892915,
    0.023325825,
    0.014358729,
    0.008838835,
    0.005440941,
    0.003349292,
    0.0020617312,
    0.0012691444,
    0.00078125,
];

pub(super) const SEED: PowerSeed = match PowerSeed::from_parts(0.1, 0.3, OCTAVE, SCALE) {
    Ok(seed) => seed,
    Err(_) => panic!("no seed"),
};

static mut LAW: StaticLaw<(StickSlip<f32>,)> = StaticLaw::empty();

/// Fills the law in place, and ticks.
pub fn static_law<B: Board>(_: &mut B::Link) -> Option<()> {
    // SAFETY: an image calls this once.
    let law = unsafe { (&raw mut LAW).as_mut() }?;
    let mixed = Law::new(black_box(1.2), 30.0, 0.1, 0.3).ok()?;
    law.set_with_seed(mixed, &SEED, (StickSlip::new(&[(0.5, 0.02)]).ok()?,))
        .ok()?;
    let mut cycles = CycleAccumulator::<1>::new();
    for n in 0..TICKS {
        let motion = motion(n);
        let force = law.force(&motion);
        black_box(cycles.update(motion.displacement, [force], u32::from(n) << 25));
    }
    Some(())
}
