//! Sequences of known length, which show that the counts are correct.

use core::arch::asm;

use super::suite::tally::{Meter, Region, Tally};

macro_rules! nops {
    ($($name:ident $count:literal),+) => {
        $(extern "C" fn $name(_: &mut (), a: f32, _: f32) -> f32 {
            // SAFETY: does nothing.
            unsafe { asm!(concat!(".rept ", $count), "nop", ".endr", options(nomem, nostack, preserves_flags)) };
            a
        })+
        const NOPS: &[(&str, Region<()>)] = &[$((concat!("known/nops-", $count), $name)),+];
    };
}

nops!(none 0, one 1, two 2, seven 7, hundred 100, thousand 1000);

/// Calls of each.
const CALLS: u32 = 50;

/// Each sequence, its length in its name.
pub fn run(meter: &mut impl Meter) {
    for (name, region) in NOPS {
        let mut tally = Tally::default();
        for _ in 0..CALLS {
            tally.add(meter.call(*region, &mut (), 0.0, 0.0));
        }
        meter.report(name, "call", &tally);
    }
}
