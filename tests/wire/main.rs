//! Packs, messages, frames and formats.

#[cfg(feature = "serde")]
mod formats;
mod frame;
mod message;
mod pack;
mod pack_info;
mod pack_refused;
mod pack_slices;
mod pack_table;
mod support;
mod telemetry;
