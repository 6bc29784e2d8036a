//! Counts instructions in an emulator: one line for each measurement, over the board's link.
//!
//! ```text
//! name moment calls instructions least most checksum
//! ```
//!
//! `instructions` is the sum over all calls, `checksum` that of their results; `moment` separates calls with different work.

#[cfg(target_os = "none")]
mod counter;
#[cfg(target_os = "none")]
mod image;
#[cfg(target_os = "none")]
mod known;
#[cfg(target_os = "none")]
mod output;
pub mod suite;

#[cfg(target_os = "none")]
pub use image::{complain, run};

/// The image that counts on a board: its entry and its handlers.
#[macro_export]
macro_rules! bench_image {
    ($board:ty) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            $crate::bench::run::<$board>()
        }

        #[panic_handler]
        fn panic(fault: &core::panic::PanicInfo) -> ! {
            $crate::bench::complain::<$board>(fault)
        }

        #[cortex_m_rt::exception]
        unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
            $crate::bench::complain::<$board>(format_args!("hard fault at {:#x}", frame.pc()))
        }
    };
}
