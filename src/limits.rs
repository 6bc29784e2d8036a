//! Limits to which inputs are clamped, so that every force stays finite.
//!
//! They are far beyond any rig, and small enough for `f32`: the largest force of the mixed damping law (eq 13) is below
//! 1e9·(1e4 + 1e12 + 1e6) ≈ 1e21 kN, and that of the highest power, k5·y⁵, is 1e29 kN.

/// Displacements beyond ±this many mm are clamped.
pub const DISPLACEMENT: f64 = 1e4;
/// Velocities beyond ±this many mm/s are clamped.
pub const VELOCITY: f64 = 1e6;
/// Accelerations beyond ±this many mm/s² are clamped.
pub const ACCELERATION: f64 = 1e9;
/// Largest number of cycles over which anything changes.
pub const CYCLES: f64 = 1e9;
/// Largest relative change of a force.
pub const CHANGE: f64 = 1e3;
/// Temperatures are clamped to ±this many °C.
pub const TEMPERATURE: f64 = 1e4;
/// Control inputs beyond ±this are clamped, whatever their unit.
pub const CONTROL: f64 = 1e6;
/// Largest magnitude of a stiffness, damping or force coefficient, each in its own unit.
pub const COEFFICIENT: f64 = 1e9;
/// Measured forces beyond ±this many kN are clamped.
pub const FORCE: f64 = 1e12;
/// Largest mass, kg.
pub const MASS: f64 = 1e6;
/// Largest relative increase of the friction per mm of displacement, 1/mm.
pub const LOAD: f64 = 1e6;
