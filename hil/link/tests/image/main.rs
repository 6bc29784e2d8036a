//! The firmware's image in the emulator, compared with the crate in this process.

#[path = "../emulated/mod.rs"]
mod emulated;
mod faulty_link;
mod packs;
mod process;
mod runs;
mod streamed;
mod support;
