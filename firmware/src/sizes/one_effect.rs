//! The mixed damping law with stick-slip of one element, in the two forms for a firmware in Rust.

use core::hint::black_box;

use mesh_damper::effects::StickSlip;
use mesh_damper::fast_law::RunningLaw;
use mesh_damper::law::Law;
use mesh_damper::pack::{self, Expectation};
use mesh_damper::static_law::StaticLaw;
use mesh_damper::tick_law::TickLaw;

use super::static_law::SEED;
use super::{PACK, TICKS, motion};
use crate::board::Board;

static mut STATIC: StaticLaw<(StickSlip<f32>,)> = StaticLaw::empty();
static mut FROM_PACK: RunningLaw<1> = RunningLaw::empty();

/// As a static type, with the table's seed computed on a host.
pub fn one_effect_static<B: Board>(_: &mut B::Link) -> Option<()> {
    // SAFETY: an image calls this once.
    let law = unsafe { (&raw mut STATIC).as_mut() }?;
    let mixed = Law::new(black_box(1.2), 30.0, 0.1, 0.3).ok()?;
    law.set_with_seed(mixed, &SEED, (StickSlip::new(&[(1.2, 0.03)]).ok()?,))
        .ok()?;
    tick(law);
    Some(())
}

/// Read from a pack, which may contain any single effect.
pub fn one_effect_pack<B: Board>(_: &mut B::Link) -> Option<()> {
    // SAFETY: an image calls this once.
    let law = unsafe { (&raw mut FROM_PACK).as_mut() }?;
    let expected = Expectation::at(10_000.0);
    law.swap_with(|slot| pack::decode(black_box(PACK), slot, &expected).map(|_| ()))
        .ok()?;
    law.boundary();
    tick(law);
    Some(())
}

fn tick(law: &mut impl TickLaw) {
    for n in 0..TICKS {
        black_box(law.force(&motion(n)));
    }
}
