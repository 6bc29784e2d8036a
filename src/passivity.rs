//! Whether a law is passive: whether it can give out more energy in a closed cycle than it absorbs. Every specimen is passive, and a
//! rig driven by an active law does not stay where it should.
//!
//! A law is accepted if it is the sum of parts that cannot supply energy, whatever the motion; the exceptions are named below. No
//! motion is tried, so that the answer holds for every displacement and speed, whatever operating range the law is said to have. A
//! closed cycle is a motion after which displacement and memory are as before. Temperature, cycles and control inputs are constant in it.
//!
//! - **Elastic forces** depend on the displacement alone, and a mass on the acceleration: ∮F dy = 0.
//! - **The law's damping** has the sign of the velocity, because c ≥ 0 and the part of it that remains is not below 0: 1 plus the
//!   changes by all effects of [`Energy::ScalesDamping`], each at its least. A temperature is taken from −60 to 200 °C, those that a
//!   [`rig`](crate::rig::RigSettings::temperature_range) accepts by default.
//! - **Every other effect** stores energy or dissipates it, as the page of its type shows, if the parameters that
//!   [`Energy::Below0`] names are at least 0. A force of another effect is not set against one that is below 0.
//! - **A play** ([`Gap`](crate::effects::Gap)) before such an effect absorbs energy too.
//! - **A residual table** drives no motion: where the displacement rises its force is at least as high as where it falls, at every
//!   pair of values of its variable between which a cycle may lead; of a stretch, slip or lag, where it falls at the smaller one. A
//!   table over speed may lack of that what the law's own damping
//!   has at the two speeds. A largest displacement and an age are constant in a cycle as defined above. While they grow, which they
//!   do only once, a table whose force changes with them can give out energy: at most its change of force times the displacement.
//!
//! Not judged are effects of [`Energy::Active`], which supply energy by their nature, in measurement or drive: a tone, a delay and a
//! low-pass of the force channel. A spring in series returns the energy that it absorbs if the law behind it is nowhere softer than −K:
//! k1 > −K and k3 ≥ 0. But its step takes the forces of other effects from the tick before, which may supply energy where
//! these are stiffer than the spring ([`Compliance`](crate::effects::Compliance)); this is not judged.
//!
//! All of it is shown for the equations. Their steps are of second order, so that a coarse tick changes the energy of a cycle a little.
//!
//! ```
//! use mesh_damper::effects::{AugmentedLaw, Effect, Viscous};
//! use mesh_damper::law::Law;
//! use mesh_damper::passivity;
//!
//! // A dashpot below 0 parallel to friction: it drives a motion that is fast enough.
//! let law = AugmentedLaw::<f32, 1>::new(Law::new(1.6, 0.0, 0.1, 0.3)?);
//! let law = law.with(Effect::Viscous(Viscous::new(-0.5)?))?;
//! let active = passivity::check(&law).unwrap_err();
//! assert_eq!((active.effect, active.field, active.value), ("viscous", "c1", -0.5));
//! # Ok::<(), mesh_damper::error::ConfigError>(())
//! ```
//!
//! [`Energy::ScalesDamping`]: crate::effects::description::Energy::ScalesDamping
//! [`Energy::Below0`]: crate::effects::description::Energy::Below0
//! [`Energy::Active`]: crate::effects::description::Energy::Active

use core::fmt;

use crate::effects::AugmentedLaw;
use crate::effects::residual_table::{GROUPS, RUNS};
use crate::real::Real;

/// The part of a law with which it can give out more energy than it absorbs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Active {
    /// Name of the effect, or `residual_table`.
    pub effect: &'static str,
    /// Its parameter. `cells` for a residual table.
    pub field: &'static str,
    /// The parameter's value, in its unit. For a residual table the force in kN by which the cells drive the motion.
    pub value: f64,
}

impl fmt::Display for Active {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            effect,
            field,
            value,
        } = self;
        write!(
            f,
            "with {field} = {value}, {effect} can give more energy than it takes"
        )
    }
}

impl core::error::Error for Active {}

/// Parts of the check, each of at most a few hundred instructions: the effects, and each run of each group of the residual table's
/// cells.
const PARTS: usize = 1 + GROUPS * RUNS;

/// Checks that `law` is passive.
///
/// # Errors
/// The first part found with which it can be active.
pub fn check<R: Real, const N: usize>(law: &AugmentedLaw<R, N>) -> Result<(), Active> {
    let mut bounds = [R::ZERO; 2];
    (0..PARTS).try_for_each(|part| check_part(law, part, &mut bounds).map(|_| ()))
}

/// The least force in kN that the law's own damping has at this speed in mm/s, by which a residual table may drive the motion there.
pub fn damping_beside_table<R: Real, const N: usize>(law: &AugmentedLaw<R, N>, speed: R) -> R {
    let (left, _) = law.least_damping();
    // A stage may take velocity from the law that the table still sees.
    if law.has_stages() || left < R::ZERO {
        return R::ZERO;
    }
    left * law.law().damping_force(speed)
}

/// Part `part` of [`check`]. Returns whether it is the last one. `bounds` is kept from part to part.
///
/// # Errors
/// As [`check`], for this part.
#[inline(never)]
pub(crate) fn check_part<R: Real, const N: usize>(
    law: &AugmentedLaw<R, N>,
    part: usize,
    bounds: &mut [R; 2],
) -> Result<bool, Active> {
    let table = law.residual_table();
    let Some(run) = part.checked_sub(1) else {
        if let Some(active) = law.supplies() {
            return Err(active);
        }
        let (left, by) = law.least_damping();
        if left < R::ZERO && law.law().c() > R::ZERO {
            return Err(by);
        }
        return Ok(table.is_none());
    };
    if let Some(table) = table {
        let damping = |speed| damping_beside_table(law, speed);
        let drives = table.drives(run / RUNS, run % RUNS, damping, bounds);
        if drives > R::ZERO {
            return Err(Active {
                effect: "residual_table",
                field: "cells",
                value: drives.to_f64(),
            });
        }
    }
    Ok(part + 1 >= PARTS)
}
