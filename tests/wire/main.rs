//! Packs, messages, frames and formats.

#[path = "../common/drawn.rs"]
mod drawn;
#[cfg(feature = "serde")]
mod formats;
mod frame;
mod message;
mod pack;
mod pack_forged;
mod pack_info;
mod pack_refused;
mod pack_slices;
mod pack_table;
mod support;
mod telemetry;
