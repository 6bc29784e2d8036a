//! A firmware that reads its law from a pack: mixed damping law with up to eight effects of any kind.

use core::hint::black_box;

use mesh_damper::fast_law::RunningLaw;
use mesh_damper::pack::{self, Expectation};

use super::{PACK, TICKS, motion};
use crate::board::Board;

static mut LAW: RunningLaw<8> = RunningLaw::empty();

/// Reads a pack into the law in place, and ticks.
pub fn running_law<B: Board>(_: &mut B::Link) -> Option<()> {
    // SAFETY: an image calls this once.
    let law = unsafe { (&raw mut LAW).as_mut() }?;
    law.swap_with(|slot| pack::decode(black_box(PACK), slot, &Expectation::default()).map(|_| ()))
        .ok()?;
    law.boundary();
    for n in 0..TICKS {
        black_box(law.force(&motion(n)));
    }
    Some(())
}
