//! The blind trial: specimens whose effect, size, noise and test are drawn by a seed that the tracer never sees.

mod absorbed;
mod draw;
mod families;
mod programme;
mod test_rig;

pub use draw::{Class, GROUP, Secret, Sized, Trial, draw};
pub use programme::{Programme, Shape};
