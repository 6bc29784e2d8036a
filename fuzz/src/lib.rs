//! Properties of mesh-damper that hold for any input: nothing panics, each input is read correctly or refused, and no output is
//! infinite or NaN.
//!
//! Each module contains one check, which panics if a property does not hold. `fuzz_targets/` passes it to libFuzzer. `bounded` runs
//! it on seeded inputs, the same every time.

#[cfg(test)]
mod bounded;
mod edit;
mod feed;
pub mod formats;
pub mod frames;
pub mod grown;
mod law;
pub mod model_file;
pub mod motion;
pub mod pack;
pub mod recording;
pub mod rig;
mod wires;
