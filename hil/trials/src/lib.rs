//! Trials of the tracer and of the firmware: each answers one question about this project.
//!
//! | module | question |
//! |---|---|
//! | [`mod@blind`] | does a trace name effects that it does not know? |
//! | [`mod@conditions`] | does the written model predict other conditions at least as well as the law alone? |
//! | [`mod@bouc_wen`] | does a trace find the oscillator of the Bouc–Wen benchmark? |
//! | [`size`] | how much time and memory does a trace take? |
//! | [`numbers`] | how much does each policy number matter? |
//! | [`mod@bench`] | how many instructions does the crate take, compared to its peers? |
#![forbid(unsafe_code)]

pub mod bench;
pub mod blind;
pub mod bouc_wen;
pub mod conditions;
pub mod numbers;
pub mod size;
