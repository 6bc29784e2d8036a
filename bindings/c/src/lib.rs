//! `mesh-damper` for C. The header `include/mesh_damper.h` is generated from this crate; `docs/c.md` is its page.
//!
//! The caller owns all memory: each opaque struct has a size and an alignment that hold on every target of its pointer width, and
//! what is in it stays where it was initialised. Nothing is allocated, nothing is global, and no function of C's library is defined.
//!
//! | file | for |
//! |---|---|
//! | `error.rs` | error codes, and what exactly was refused |
//! | `law.rs` | the law with its effects, read from a pack |
//! | `pack_info.rs` | what a pack says of itself |
//! | `cycle.rs` | stiffness, energy and loss factor of each cycle |
//! | `sine.rs` | an excitation of sines and sweeps |
//! | `converter.rs` | codes of an ADC or a DAC, and what a controller is given each tick |
//! | `emulation.rs` | a damper emulation |
//! | `rig.rs` | a rig that calls back for its sensors and its actuator |
//! | `telemetry.rs` | what both say of each tick |
//!
//! Units are mm, s, kN and J.
#![no_std]

pub mod converter;
pub mod cycle;
pub mod emulation;
pub mod error;
pub mod law;
pub mod pack_info;
pub mod rig;
pub mod sine;
mod storage;
pub mod telemetry;

/// No code is left that comes here; a test of the library's symbols holds that.
#[cfg(feature = "static-library")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
