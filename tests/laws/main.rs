//! The law in f32 and in integers against f64.

#[path = "../common/drawn.rs"]
mod drawn;
mod fast_law;
mod finite;
#[cfg(feature = "fixed-point")]
mod fixed;
mod floats;
mod largest;
mod passivity;
mod power;
mod ranges;
mod static_law;
mod table;
