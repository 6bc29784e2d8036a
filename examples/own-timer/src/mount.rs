//! The model ccecd85ba181376b as a law for 10000 ticks a second.
//!
//! Written by `hil export` of mesh-damper 0.1.0: export the model again instead of changing this. It needs the crate
//! `mesh-damper` and nothing else. Keep a [`DamperLaw`] in a static and [`fill`] it before the first tick.

use mesh_damper::effects::{Equations as _, StickSlip};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::power::PowerSeed;
use mesh_damper::static_law::StaticLaw;

/// Name of the model.
pub const NAME: &str = "mount";
/// Identity of the model, as in a pack.
pub const IDENTITY: [u8; 8] = [204, 236, 216, 91, 161, 129, 55, 107];
/// Revision of this export.
pub const REVISION: u32 = 0;
/// Ticks per second that the law is for, Hz.
pub const TICK_RATE: f32 = 10000.0;
/// Displacement in mm of the motion that the law was fitted on: least and largest.
pub const DISPLACEMENT: [f32; 2] = [-0.25, 0.25];
/// Velocity in mm/s of the motion that the law was fitted on: least and largest.
pub const VELOCITY: [f32; 2] = [-12.6, 12.6];
/// Amplitude that the law was taken at, mm; none where it is the same at every one.
pub const AMPLITUDE: Option<f32> = None;
/// Density of the specimen, g/cm³; none where it is not known.
pub const DENSITY: Option<f32> = None;
/// k1 in kN/mm, k3 in kN/mm³, c in kN·(s/mm)^α, and α.
pub const LAW: [f32; 4] = [1.2, 30.0, 0.1, 0.3];
/// Parameters of the effect stick_slip: stiffness in kN/mm, slip_limit in mm, of each element.
pub const STICK_SLIP: [f64; 2] = [1.2, 0.03];
/// One tick, s.
const TICK: f64 = 0.0001;
/// Seed of the table of c·|v|^α, computed in f64 on the host.
const OCTAVE: [[f32; 4]; 8] = [
    [0.54508185, 0.66045636, -0.2561416, 0.050603464],
    [0.50100243, 0.54300565, -0.18839642, 0.033300836],
    [0.46467638, 0.45558253, -0.14299597, 0.022868153],
    [0.43414208, 0.38857782, -0.111350395, 0.016258609],
    [0.40805948, 0.33597723, -0.08856965, 0.011897587],
    [0.38547963, 0.29385066, -0.07172278, 0.008920786],
    [0.36571047, 0.25953653, -0.05897637, 0.006829459],
    [0.34823442, 0.23117709, -0.049141355, 0.0053233975],
];
/// Its factor in each octave.
const SCALE: [f32; 32] = [
    2661.5881, 1638.3998, 1008.55334, 620.8374,
    382.17026, 235.2534, 144.81546, 89.14437,
    54.874798, 33.7794, 20.79366, 12.799999,
    7.879324, 4.8502927, 2.9857054, 1.8379173,
    1.1313708, 0.69644046, 0.4287094, 0.2639016,
    0.16245048, 0.1, 0.061557222, 0.037892915,
    0.023325825, 0.01435873, 0.008838835, 0.0054409415,
    0.0033492923, 0.0020617312, 0.0012691445, 0.00078125007,
];

/// The law with the effects that it has, and no others.
pub type DamperLaw = StaticLaw<(StickSlip<f32>,)>;

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
        StickSlip::<f32>::from_parameters(&STICK_SLIP, TICK)?,
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
