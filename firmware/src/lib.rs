//! The images, for any board.
//!
//! | image | content | made for a board by |
//! |---|---|---|
//! | `firmware` | the crate's rig controller, driven tick by tick over a link | `rig_image!`, feature `rig` |
//! | `own-timer` | the same on the board's own timer, sending telemetry | `own_timer_image!`, feature `own-timer` |
//! | `bench` | counts instructions in an emulator | `bench_image!`, feature `bench` |
//! | `static-law`, `running-law`, `damper`, `constructors` | one use of the crate each, for its size | `size_image!`, feature `sizes` |
//!
//! A [`Board`] contains the differences between boards. `emulated` has the parts of one in QEMU.
#![no_std]

#[cfg(feature = "bench")]
pub mod bench;
mod board;
#[cfg(all(feature = "emulated", target_os = "none"))]
pub mod emulated;
#[cfg(all(feature = "own-timer", target_os = "none"))]
pub mod own_timer;
mod port;
#[cfg(all(feature = "rig", target_os = "none"))]
pub mod rig;
pub mod shared_memory;
#[cfg(all(feature = "sizes", target_os = "none"))]
pub mod sizes;
#[cfg(all(any(feature = "rig", feature = "sizes"), target_os = "none"))]
mod stack;

#[cfg(target_os = "none")]
pub use board::OwnTimer;
pub use board::{Board, Converters, Harnessed, Link, Log, Port};
pub use port::PortLink;
