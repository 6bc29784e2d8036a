//! What mesh-damper is held to when it is given anything: nothing panics, what is read is right or refused, and no number
//! that goes out is infinite or NaN.
//!
//! Each module holds one check, which panics where something is not as it has to be. `fuzz_targets/` gives it to libFuzzer,
//! `bounded` runs it on seeded inputs, the same every time.

#[cfg(test)]
mod bounded;
mod edit;
mod feed;
pub mod formats;
pub mod frames;
mod law;
pub mod model_file;
pub mod motion;
pub mod pack;
pub mod recording;
pub mod rig;
mod wires;
