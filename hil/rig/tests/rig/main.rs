//! The simulated rig: specimens, actuator and signals, motions that it follows, and what its monitor finds.

mod actuator;
mod attacks;
mod drive;
mod faults;
mod link;
mod specimen;
