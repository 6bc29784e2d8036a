//! The model 2e1f6769ea42fc48 as a law for 2000 ticks a second.
//!
//! Written by `hil export` of mesh-damper 0.1.0: export the model again instead of changing this. It needs the crate
//! `mesh-damper` and nothing else. Keep a [`DamperLaw`] in a static and [`fill`] it before the first tick.

use mesh_damper::effects::{Equations as _, Drift, StickSlip, Relaxation, Stop, BoucWen, HardeningFriction, Yielding, ControlInput};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::power::PowerSeed;
use mesh_damper::static_law::StaticLaw;

/// Name of the model.
pub const NAME: &str = "second";
/// Identity of the model, as in a pack.
pub const IDENTITY: [u8; 8] = [46, 31, 103, 105, 234, 66, 252, 72];
/// Revision of this export.
pub const REVISION: u32 = 4;
/// Ticks per second that the law is for, Hz.
pub const TICK_RATE: f32 = 2000.0;
/// Displacement in mm of the motion that the law was fitted on: least and largest.
pub const DISPLACEMENT: [f32; 2] = [-0.2, 0.25];
/// Velocity in mm/s of the motion that the law was fitted on: least and largest.
pub const VELOCITY: [f32; 2] = [-6.3, 6.5];
/// Amplitude that the law was taken at, mm; none where it is the same at every one.
pub const AMPLITUDE: Option<f32> = Some(0.1);
/// Density of the specimen, g/cm³; none where it is not known.
pub const DENSITY: Option<f32> = Some(3.0);
/// Control inputs by their index in `Motion::controls`, with their units.
pub const CONTROLS: [&str; 1] = ["current_A"];
/// k1 in kN/mm, k3 in kN/mm³, c in kN·(s/mm)^α, and α.
pub const LAW: [f32; 4] = [1.2, 10.5, 0.1114, 0.3969];
/// Parameters of the effect drift: cycles, stiffness in kN/mm, elastic_change, damping_change.
pub const DRIFT: [f64; 4] = [30.0, 0.2, 0.1, -0.3];
/// Parameters of the effect stick_slip: stiffness in kN/mm, slip_limit in mm, of each element.
pub const STICK_SLIP: [f64; 12] = [0.9, 0.01, 0.8, 0.02, 0.7, 0.03, 0.6, 0.045, 0.5, 0.06, 0.4, 0.09];
/// Parameters of the effect relaxation: stiffness in kN/mm, time in s, of each element.
pub const RELAXATION: [f64; 2] = [0.8, 0.05];
/// Parameters of the effect stop: stiffness in kN/mm, gap in mm, of each element.
pub const STOP: [f64; 4] = [2.0, 0.06, 3.0, -0.08];
/// Parameters of the effect bouc_wen: stiffness in kN/mm, slip_limit in mm, sharpness.
pub const BOUC_WEN: [f64; 3] = [0.9, 0.02, 1.5];
/// Parameters of the effect hardening_friction: stiffness in kN/mm, stretch_limit in mm, sharpness, hardening, loss.
pub const HARDENING_FRICTION: [f64; 5] = [0.9, 0.4, 1.0, 2.0, 10.0];
/// Parameters of the effect yielding: stiffness in kN/mm, yield_stretch in mm, rate in mm/s, time in s.
pub const YIELDING: [f64; 4] = [2.0, 0.04, 0.3, 0.02];
/// Parameters of the effect control_input: stiffness in kN/mm, yield_stretch in mm, rate in mm/s, viscosity in kN*s/mm, lag in s, saturation, input.
pub const CONTROL_INPUT: [f64; 7] = [2.0, 0.04, 0.3, 0.01, 0.02, 1.5, 0.0];
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
pub type DamperLaw = StaticLaw<(Drift<f32>, StickSlip<f32>, Relaxation<f32>, Stop<f32>, BoucWen<f32>, HardeningFriction<f32>, Yielding<f32>, ControlInput<f32>)>;

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
        Drift::<f32>::from_parameters(&DRIFT, TICK)?,
        StickSlip::<f32>::from_parameters(&STICK_SLIP, TICK)?,
        Relaxation::<f32>::from_parameters(&RELAXATION, TICK)?,
        Stop::<f32>::from_parameters(&STOP, TICK)?,
        BoucWen::<f32>::from_parameters(&BOUC_WEN, TICK)?,
        HardeningFriction::<f32>::from_parameters(&HARDENING_FRICTION, TICK)?,
        Yielding::<f32>::from_parameters(&YIELDING, TICK)?,
        ControlInput::<f32>::from_parameters(&CONTROL_INPUT, TICK)?,
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
