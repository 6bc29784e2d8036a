//! The work of the image.

use core::fmt::{Display, Write as _};

use super::counter::Counter;
use super::output::Output;
use super::{known, suite};
use crate::board::{Board, Link as _};

/// Counts all regions for the board's core.
pub fn run<B: Board>() -> ! {
    B::prepare();
    let Some(peripherals) = cortex_m::Peripherals::take() else {
        B::exit(false)
    };
    let mut counter = Counter::<B>::new(peripherals.SYST);
    known::run(&mut counter);
    let counted = if cfg!(target_abi = "eabihf") {
        suite::cortex_m4f(&mut counter)
    } else {
        suite::cortex_m0(&mut counter)
    };
    B::exit(counted.is_ok())
}

/// Reports a failure, and ends.
pub fn complain<B: Board>(fault: impl Display) -> ! {
    let _ = writeln!(Output(B::Link::open()), "{fault}");
    B::exit(false)
}
