//! A damper's law on a Cortex-M0, in integers. Prints stiffness and loss factor of each cycle.
#![no_std]
#![no_main]

mod damper;

use cortex_m as _;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use panic_semihosting as _;

use damper::Damper;

#[entry]
fn main() -> ! {
    let mut damper = Damper::new().expect("motion and law are in range");
    let mut sum = 0u32;
    while let Some((force, ended)) = damper.tick() {
        sum = damper::added(sum, force);
        if let Some(cycle) = ended {
            hprintln!(
                "cycle: {} kN/mm, loss factor {}",
                cycle.stiffness,
                cycle.loss_factor
            );
        }
    }
    hprintln!("forces {:08x}", sum);
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}
