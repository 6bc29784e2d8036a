//! Traces of specimens and channels with a known truth, and of recordings made elsewhere.

mod any_motion;
mod channel_faults;
mod control_input;
mod correction;
mod fitted_law;
mod hidden;
mod shared_faults;
mod shared_recordings;
mod support;
mod trace;
