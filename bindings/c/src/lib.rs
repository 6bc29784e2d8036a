//! `mesh-damper` for C. The header `include/mesh_damper.h` is generated from this crate; `docs/c.md` is its page.
//!
//! The caller owns all memory. The size and alignment of each opaque struct are the same on every target with its pointer width,
//! and its contents must stay in the memory in which they were initialised. Nothing is allocated, nothing is global, and no
//! function of the C library is defined.
//!
//! | file | for |
//! |---|---|
//! | `error.rs` | error codes, and the details of a problem |
//! | `law.rs` | the law with its effects, read from a pack |
//! | `pack_info.rs` | the information of a pack about itself |
//! | `cycle.rs` | stiffness, energy and loss factor of each cycle |
//! | `sine.rs` | an excitation of sines and sweeps |
//! | `converter.rs` | codes of an ADC or a DAC, and the input of a controller at each tick |
//! | `emulation.rs` | a damper emulation |
//! | `rig.rs` | a rig that calls back for its sensors and its actuator |
//! | `telemetry.rs` | the telemetry of both at each tick |
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

/// No code reaches this; a test of the library's symbols checks it.
#[cfg(feature = "static-library")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
