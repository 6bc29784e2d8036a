//! The full scales that the integers are parts of.

use super::Part;
use crate::error::ConfigError;
use crate::law::Law;
use crate::limits;
use crate::real::in_range;

/// Smallest full scale, in its own unit.
pub const SCALE_MIN: f64 = 1e-9;

/// Factor by which the full scale of force must exceed a law's largest force, so that no rounding of coefficients and products
/// reaches −1 or 1.
pub(super) const HEADROOM: f64 = 1.0 + 1.0 / 1024.0;

/// Full scales of displacement, velocity and force.
///
/// The finest step is 2⁻³¹ of each. Errors of the law are parts of the full scale of force. A scale of displacement beyond the
/// specimen's range therefore costs accuracy; one of velocity hardly does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    displacement: f64,
    velocity: f64,
    force: f64,
}

impl Scales {
    /// * `displacement`: mm, [`SCALE_MIN`]…[`limits::DISPLACEMENT`]
    /// * `velocity`: mm/s, [`SCALE_MIN`]…[`limits::VELOCITY`]
    /// * `force`: kN, [`SCALE_MIN`]…[`limits::FORCE`]
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(displacement: f64, velocity: f64, force: f64) -> Result<Self, ConfigError> {
        Ok(Self {
            displacement: in_range(
                "displacement",
                displacement,
                SCALE_MIN,
                limits::DISPLACEMENT,
            )?,
            velocity: in_range("velocity", velocity, SCALE_MIN, limits::VELOCITY)?,
            force: in_range("force", force, SCALE_MIN, limits::FORCE)?,
        })
    }

    /// With the smallest full scale of force for `law` on the other two scales, in mm and mm/s as in [`Scales::new`].
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn covering(law: &Law<f64>, displacement: f64, velocity: f64) -> Result<Self, ConfigError> {
        let unit = Self::new(displacement, velocity, 1.0)?;
        let force = HEADROOM * unit.largest_force(law);
        let force = if force > SCALE_MIN { force } else { SCALE_MIN };
        Self::new(displacement, velocity, force)
    }

    /// |k1|·Y + |k3|·Y³ + c·V^α, kN.
    pub(super) fn largest_force(&self, law: &Law<f64>) -> f64 {
        let (y, v) = (self.displacement, self.velocity);
        (law.k1().abs() + law.k3().abs() * y * y) * y + law.damping_force(v)
    }

    /// `value` mm as a part of full scale, saturated; 0 for NaN.
    pub fn displacement_part(&self, value: f64) -> Part {
        part(value, self.displacement)
    }

    /// `value` mm/s as a part of full scale, saturated; 0 for NaN.
    pub fn velocity_part(&self, value: f64) -> Part {
        part(value, self.velocity)
    }

    /// `value` kN as a part of full scale, saturated; 0 for NaN.
    pub fn force_part(&self, value: f64) -> Part {
        part(value, self.force)
    }

    /// Full scale of displacement, mm.
    pub fn displacement(&self) -> f64 {
        self.displacement
    }

    /// Full scale of velocity, mm/s.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// Full scale of force, kN.
    pub fn force(&self) -> f64 {
        self.force
    }
}

/// The nearest part of `scale`.
fn part(value: f64, scale: f64) -> Part {
    let bits = rounded(value / scale, 31);
    Part::from_bits(bits.clamp(i32::MIN.into(), i32::MAX.into()) as i32)
}

/// The nearest integer to `value`·2^`bits`, saturated; 0 for NaN.
pub(super) fn rounded(value: f64, bits: i32) -> i64 {
    libm::round(libm::ldexp(value, bits)) as i64
}
