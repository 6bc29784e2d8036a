//! The model 8a84ddc1ee81254f as a law for 2000 ticks a second.
//!
//! Written by `hil export` of mesh-damper 0.1.0: export the model again instead of changing this. It needs the crate
//! `mesh-damper` and nothing else. Keep a [`DamperLaw`] in a static and [`fill`] it before the first tick.

use mesh_damper::effects::{Equations as _, Offset, Asymmetry, Hardening, Viscous, Inertia, LoadFriction, Directional, Temperature};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::power::PowerSeed;
use mesh_damper::static_law::StaticLaw;

/// Name of the model.
pub const NAME: &str = "first";
/// Identity of the model, as in a pack.
pub const IDENTITY: [u8; 8] = [138, 132, 221, 193, 238, 129, 37, 79];
/// Revision of this export.
pub const REVISION: u32 = 4;
/// Ticks per second that the law is for, Hz.
pub const TICK_RATE: f32 = 2000.0;
/// Displacement in mm of the motion that the law was fitted on: least and largest.
pub const DISPLACEMENT: [f32; 2] = [-0.2, 0.25];
/// Velocity in mm/s of the motion that the law was fitted on: least and largest.
pub const VELOCITY: [f32; 2] = [-6.3, 6.5];
/// Amplitude that the law was taken at, mm; none where it is the same at every one.
pub const AMPLITUDE: Option<f32> = None;
/// Density of the specimen, g/cm³; none where it is not known.
pub const DENSITY: Option<f32> = Some(3.0);
/// k1 in kN/mm, k3 in kN/mm³, c in kN·(s/mm)^α, and α.
pub const LAW: [f32; 4] = [1.0539, 10.5, 0.1114, 0.3969];
/// Parameters of the effect offset: force in kN.
pub const OFFSET: [f64; 1] = [0.05];
/// Parameters of the effect asymmetry: k2 in kN/mm^2.
pub const ASYMMETRY: [f64; 1] = [2.0];
/// Parameters of the effect hardening: k5 in kN/mm^5.
pub const HARDENING: [f64; 1] = [90.0];
/// Parameters of the effect viscous: c1 in kN*s/mm.
pub const VISCOUS: [f64; 1] = [0.02];
/// Parameters of the effect inertia: mass in kg.
pub const INERTIA: [f64; 1] = [50.0];
/// Parameters of the effect load_friction: load in 1/mm.
pub const LOAD_FRICTION: [f64; 1] = [4.0];
/// Parameters of the effect directional: difference.
pub const DIRECTIONAL: [f64; 1] = [0.3];
/// Parameters of the effect temperature: beta in 1/degC, reference in degC, beta_damping in 1/degC.
pub const TEMPERATURE: [f64; 3] = [0.005, 20.0, -0.002];
/// One tick, s.
const TICK: f64 = 0.0005;
/// Seed of the table of c·|v|^α, computed in f64 on the host.
const OCTAVE: [[f32; 4]; 8] = [
    [0.42942026, 0.79898447, -0.28311235, 0.054707695],
    [0.39898214, 0.6640341, -0.2104952, 0.036392607],
    [0.3736671, 0.5625654, -0.16132903, 0.02523525],
    [0.35220954, 0.48408142, -0.1267402, 0.018100614],
    [0.33373883, 0.4219528, -0.101629734, 0.013353086],
    [0.31763434, 0.37181178, -0.082915395, 0.010087131],
    [0.3034407, 0.33067787, -0.068654016, 0.007776076],
    [0.29081535, 0.2964561, -0.057576302, 0.006100587],
];
/// Its factor in each octave.
const SCALE: [f32; 32] = [
    723.5361, 476.33118, 313.58682, 206.44608,
    135.91125, 89.475525, 58.90512, 38.77947,
    25.529991, 16.80736, 11.06492, 7.284456,
    4.795633, 3.1571465, 2.0784688, 1.3683347,
    0.9008265, 0.59304816, 0.39042604, 0.25703222,
    0.16921404, 0.1114, 0.07333884, 0.04828173,
    0.03178569, 0.020925721, 0.013776193, 0.00906939,
    0.005970722, 0.003930752, 0.002587763, 0.0017036222,
];

/// The law with the effects that it has, and no others.
pub type DamperLaw = StaticLaw<(Offset<f32>, Asymmetry<f32>, Hardening<f32>, Viscous<f32>, Inertia<f32>, LoadFriction<f32>, Directional<f32>, Temperature<f32>)>;

/// Fills `law` where it is, at rest.
///
/// # Errors
/// A number that this version of the crate refuses.
pub fn fill(law: &mut DamperLaw) -> Result<(), ConfigError> {
    let [k1, k3, c, alpha] = LAW;
    let seed = const {
        match PowerSeed::from_parts(LAW[2], LAW[3], OCTAVE, SCALE) {
            Ok(seed) => seed,
            Err(_) => panic!("LAW, OCTAVE or SCALE was changed: export the model again"),
        }
    };
    let effects = (
        Offset::<f32>::from_parameters(&OFFSET, TICK)?,
        Asymmetry::<f32>::from_parameters(&ASYMMETRY, TICK)?,
        Hardening::<f32>::from_parameters(&HARDENING, TICK)?,
        Viscous::<f32>::from_parameters(&VISCOUS, TICK)?,
        Inertia::<f32>::from_parameters(&INERTIA, TICK)?,
        LoadFriction::<f32>::from_parameters(&LOAD_FRICTION, TICK)?,
        Directional::<f32>::from_parameters(&DIRECTIONAL, TICK)?,
        Temperature::<f32>::from_parameters(&TEMPERATURE, TICK)?,
    );
    law.set_with_seed(Law::new(k1, k3, c, alpha)?, &seed, effects)
}

/// The motion that the law was fitted on, without a margin for overshoot and noise.
///
/// # Errors
/// None for the constants as they were exported.
pub fn operating_range() -> Result<OperatingRange<f32>, ConfigError> {
    OperatingRange::new(DISPLACEMENT, VELOCITY)
}
