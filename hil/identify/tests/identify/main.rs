//! Traces of specimens with a known truth. `hil/trials/tests/traces` has those that take long.

mod correction;
mod fitted_law;
mod hidden;
mod support;
mod trace;
