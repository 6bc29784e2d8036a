//! What inputs are clamped to, so that every force stays finite.
//!
//! Far beyond any rig, and small enough for `f32`: the largest force of eq 13 is below 1e9·(1e4 + 1e12 + 1e6) ≈ 1e21 kN,
//! that of the highest power, k5·y⁵, 1e29 kN.

/// Displacements beyond ±this many mm are treated as this many.
pub const DISPLACEMENT: f64 = 1e4;
/// Velocities beyond ±this many mm/s are treated as this many.
pub const VELOCITY: f64 = 1e6;
/// Accelerations beyond ±this many mm/s² are treated as this many.
pub const ACCELERATION: f64 = 1e9;
/// Largest number of cycles over which anything changes.
pub const CYCLES: f64 = 1e9;
/// Largest change of a force, as a part of it.
pub const CHANGE: f64 = 1e3;
/// Temperatures are taken as within ±this many °C.
pub const TEMPERATURE: f64 = 1e4;
/// Control inputs beyond ±this are treated as this, whatever their unit.
pub const CONTROL: f64 = 1e6;
/// Largest magnitude of a stiffness, damping or force coefficient, each in its own unit.
pub const COEFFICIENT: f64 = 1e9;
/// Measured forces beyond ±this many kN are treated as this many.
pub const FORCE: f64 = 1e12;
/// Largest mass, kg.
pub const MASS: f64 = 1e6;
/// Largest part by which a mm of displacement adds to the friction, 1/mm.
pub const LOAD: f64 = 1e6;
