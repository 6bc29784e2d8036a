//! One law for every amplitude, fitted to the published loops, for a motion of unknown amplitude.
//!
//! [`crate::table::PAPER`] gives the mixed damping law (eq 13, k1·y + k3·y³ + c·|v|^α·sgn v) for a cycle of known amplitude. Where
//! an external actuator moves the damper, as in a [`DamperEmulation`](crate::rig::DamperEmulation), the amplitude of a cycle is
//! known only at its end. The laws of this module need no amplitude: eq 13 with one set of coefficients, friction that grows with
//! the load, and stick-slip. They are fitted to Tables 6–9 at 1 and 10 Hz without the row of 0.15 mm, where their error is 8 to 19
//! % of the force's RMS. `cargo hil amplitude-free` fits them.

use crate::effects::{AugmentedLaw, Effect, LoadFriction, StickSlip};
use crate::error::ConfigError;
use crate::fast_law::FastLaw;
use crate::law::Law;
use crate::real::in_range;

/// Law of one density.
struct Row {
    /// g/cm³
    density: f32,
    law: Law<f32>,
    /// 1/mm
    load: f32,
    /// kN/mm and mm
    elements: [(f32, f32); 2],
}

/// Densities of the tables, increasing.
const ROWS: [Row; 5] = [
    Row {
        density: 2.0,
        law: Law::from_valid(-0.0907664, 18.5968, 0.0201075, 0.53),
        load: 9.5695,
        elements: [(0.272774, 0.0522953), (0.296001, 0.143017)],
    },
    Row {
        density: 2.5,
        law: Law::from_valid(-0.453724, 52.3079, 0.064388, 0.57),
        load: 4.89885,
        elements: [(0.471631, 0.10227), (0.518324, 0.143017)],
    },
    Row {
        density: 3.0,
        law: Law::from_valid(0.754392, -2.97053, 0.0916904, 0.44),
        load: 0.408319,
        elements: [(2.88099, 0.005), (0.795791, 0.0373956)],
    },
    Row {
        density: 3.5,
        law: Law::from_valid(2.27304, -14.9745, 0.077767, 0.33),
        load: 0.0,
        elements: [(5.02009, 0.005), (2.33898, 0.0373956)],
    },
    Row {
        density: 4.0,
        law: Law::from_valid(3.08859, 87.0159, 0.0865503, 0.36),
        load: 19.2527,
        elements: [(1.18474, 0.0731315), (4.14192, 0.143017)],
    },
];

/// The effects of these laws.
pub type Effects = (LoadFriction<f32>, StickSlip<f32>);

/// Eq 13 and the effects of the published density nearest to `density`, g/cm³, 2…4. Parameters of effects are not interpolated
/// between densities. The law holds up to 0.25 mm and 10 Hz. For a [`StaticLaw`](crate::static_law::StaticLaw).
///
/// # Errors
/// `density` not finite or out of range.
pub fn parts(density: f32) -> Result<(Law<f32>, Effects), ConfigError> {
    let density = in_range("density", density, 2.0, 4.0)?;
    let nearest = ROWS.iter().min_by(|a, b| {
        let away = |row: &Row| (row.density - density).abs();
        away(a).total_cmp(&away(b))
    });
    let Some(row) = nearest else {
        return Err(ConfigError::Empty("densities"));
    };
    let effects = (LoadFriction::new(row.load)?, StickSlip::new(&row.elements)?);
    Ok((row.law, effects))
}

/// [`parts`] as a law for a [`RunningLaw`](crate::fast_law::RunningLaw).
///
/// # Errors
/// `density` not finite or out of range.
pub fn law(density: f32) -> Result<FastLaw<2>, ConfigError> {
    let (law, (load_friction, stick_slip)) = parts(density)?;
    let law = AugmentedLaw::new(law)
        .with(Effect::LoadFriction(load_friction))?
        .with(Effect::StickSlip(stick_slip))?;
    Ok(FastLaw::new(law))
}
