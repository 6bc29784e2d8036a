//! Traces that take long: of motions of any kind, of channels with faults, under control inputs, and of recordings made elsewhere.

mod any_motion;
mod as_they_come;
mod channel_faults;
mod control_input;
#[allow(dead_code, reason = "shared with a program that uses the rest")]
#[path = "../../../identify/tests/identify/hidden.rs"]
mod hidden;
mod shared_faults;
mod shared_recordings;
#[path = "../../../identify/tests/identify/support.rs"]
mod support;
