//! The linear hexahedron with one volume change for the whole element (mean dilatation, the finite-strain B-bar).
//!
//! It has eight corner nodes and eight integration points. The isochoric energy is evaluated at each point, and the volumetric
//! energy at the element's mean J. So an element has one volumetric condition for its 24 degrees of freedom and does not lock where
//! the material hardly changes its volume. Of the methods for that, this one derives from an energy: its tangent is symmetric, and
//! rigid motions cost nothing. No other mode needs stabilisation, as with reduced integration, or can become unstable under
//! compression, as with enhanced strains. It stays too stiff in bending over long thin elements, which a thick-walled ring does not
//! need.

use nalgebra::{Matrix3, Matrix6, SMatrix, SVector, Vector3, Vector6};

use super::FiniteElementError;
use super::material::{COMPONENTS, MooneyRivlin, column, symmetric_product, tensor};

/// Corners in the usual order: those of one face around, then those of the opposite face.
pub(super) const NODES: usize = 8;

/// Integration points.
pub(super) const POINTS: usize = 8;

/// Degrees of freedom: x, y, z of each corner in turn.
pub(super) const UNKNOWNS: usize = 3 * NODES;

/// The corners of the reference cube.
const CORNERS: [[f64; 3]; NODES] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// An undeformed element.
#[derive(Clone, Debug)]
pub(super) struct Element {
    points: [Point; POINTS],
    volume: f64,
}

/// An integration point.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Gradients of the shape functions, 1/mm.
    gradients: SMatrix<f64, 3, NODES>,
    /// Its share of the volume, mm³.
    weight: f64,
}

/// Displacements of an element's corners, mm, a column each.
pub(super) type Displacements = SMatrix<f64, 3, NODES>;

/// The effect of relaxation on the isochoric stress S: `factor`·S + the memory of each point, MPa.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relaxed<'a> {
    pub factor: f64,
    pub memory: &'a [Vector6<f64>; POINTS],
}

impl Relaxed<'static> {
    /// No relaxation.
    pub const NONE: Self = Self {
        factor: 1.0,
        memory: &[Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0); POINTS],
    };
}

/// The contribution of an element to the equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    /// Forces that keep the element in its state, N.
    pub force: SVector<f64, UNKNOWNS>,
    /// Their derivative, N/mm.
    pub tangent: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
}

/// The deformation at a point.
struct Deformation {
    gradient: Matrix3<f64>,
    right_cauchy_green: Matrix3<f64>,
    inverse: Matrix3<f64>,
    volume_ratio: f64,
}

impl Element {
    /// The element of `corners`, mm.
    ///
    /// # Errors
    /// [`FiniteElementError::Inverted`] if it is turned inside out anywhere.
    pub fn new(corners: &[Vector3<f64>; NODES]) -> Result<Self, FiniteElementError> {
        let positions = SMatrix::<f64, 3, NODES>::from_columns(corners);
        let mut points = [Point {
            gradients: SMatrix::zeros(),
            weight: 0.0,
        }; POINTS];
        for (point, at) in points.iter_mut().zip(CORNERS) {
            let at = at.map(|x| x / 3.0_f64.sqrt());
            let slopes = SMatrix::<f64, 3, NODES>::from_fn(|axis, node| {
                let factor = |k: usize| {
                    if k == axis {
                        CORNERS[node][k]
                    } else {
                        1.0 + CORNERS[node][k] * at[k]
                    }
                };
                factor(0) * factor(1) * factor(2) / 8.0
            });
            let jacobian = slopes * positions.transpose();
            let weight = jacobian.determinant();
            let inverse = jacobian.try_inverse().filter(|_| weight > 0.0);
            let inverse = inverse.ok_or(FiniteElementError::Inverted)?;
            *point = Point {
                gradients: inverse * slopes,
                weight,
            };
        }
        Ok(Self {
            points,
            volume: points.iter().map(|p| p.weight).sum(),
        })
    }

    /// Stored energy, N·mm, of a material without relaxation.
    ///
    /// # Errors
    /// As [`Element::contribution`].
    #[cfg(test)]
    pub fn energy(
        &self,
        moved: &Displacements,
        material: &MooneyRivlin,
    ) -> Result<f64, FiniteElementError> {
        let deformed = self.deformations(moved)?;
        let isochoric: f64 = self
            .points
            .iter()
            .zip(&deformed)
            .map(|(point, d)| point.weight * material.isochoric_energy(&d.right_cauchy_green))
            .sum();
        Ok(isochoric + self.volume * material.volumetric_energy(self.mean_volume_ratio(&deformed)))
    }

    /// S at each point, MPa, without relaxation.
    ///
    /// # Errors
    /// As [`Element::contribution`].
    pub fn stresses(
        &self,
        moved: &Displacements,
        material: &MooneyRivlin,
    ) -> Result<[Vector6<f64>; POINTS], FiniteElementError> {
        Ok(self
            .deformations(moved)?
            .map(|d| d.isochoric(material).stress))
    }

    /// Forces and tangent at `moved`.
    ///
    /// # Errors
    /// [`FiniteElementError::Inverted`] if it is turned inside out at a point.
    pub fn contribution(
        &self,
        moved: &Displacements,
        material: &MooneyRivlin,
        relaxed: Relaxed,
    ) -> Result<Contribution, FiniteElementError> {
        let deformed = self.deformations(moved)?;
        let pressure = material.pressure(self.mean_volume_ratio(&deformed));
        let mut force = SVector::zeros();
        let mut tangent = SMatrix::zeros();
        // Derivative of the element's volume with respect to the displacements.
        let mut volume_slope = SVector::<f64, UNKNOWNS>::zeros();
        for ((point, d), memory) in self.points.iter().zip(&deformed).zip(relaxed.memory) {
            let isochoric = d.isochoric(material);
            let inverse = column(&d.inverse);
            let stress =
                isochoric.stress * relaxed.factor + memory + inverse * (pressure * d.volume_ratio);
            let modulus = isochoric.tangent * relaxed.factor
                + (inverse * inverse.transpose() - symmetric_product(&d.inverse) * 2.0)
                    * (pressure * d.volume_ratio);
            let strain = point.strain_by_displacement(&d.gradient);
            force += strain.tr_mul(&(stress * point.weight));
            volume_slope += strain.tr_mul(&(inverse * (d.volume_ratio * point.weight)));
            point.add_stiffness(&mut tangent, &strain, &modulus, &tensor(&stress));
        }
        // The element has one pressure: it depends only on the mean of J.
        tangent +=
            volume_slope * volume_slope.transpose() * (material.bulk_modulus() / self.volume);
        Ok(Contribution { force, tangent })
    }

    fn deformations(
        &self,
        moved: &Displacements,
    ) -> Result<[Deformation; POINTS], FiniteElementError> {
        let mut inverted = false;
        let deformed = self.points.map(|point| {
            let gradient = Matrix3::identity() + moved * point.gradients.transpose();
            let volume_ratio = gradient.determinant();
            inverted |= volume_ratio <= 0.0 || volume_ratio.is_nan();
            let right_cauchy_green = gradient.tr_mul(&gradient);
            Deformation {
                gradient,
                right_cauchy_green,
                inverse: right_cauchy_green.try_inverse().unwrap_or_default(),
                volume_ratio,
            }
        });
        if inverted {
            Err(FiniteElementError::Inverted)
        } else {
            Ok(deformed)
        }
    }

    fn mean_volume_ratio(&self, deformed: &[Deformation; POINTS]) -> f64 {
        let points = self.points.iter().zip(deformed);
        points
            .map(|(point, d)| point.weight * d.volume_ratio)
            .sum::<f64>()
            / self.volume
    }
}

impl Deformation {
    fn isochoric(&self, material: &MooneyRivlin) -> super::material::Isochoric {
        material.isochoric(&self.right_cauchy_green, &self.inverse, self.volume_ratio)
    }
}

impl Point {
    /// Derivative of the Green–Lagrange strain with respect to the corners' displacements, at the deformation gradient `f`.
    fn strain_by_displacement(&self, f: &Matrix3<f64>) -> SMatrix<f64, 6, UNKNOWNS> {
        SMatrix::from_fn(|row, unknown| {
            let (node, axis) = (unknown / 3, unknown % 3);
            let (i, j) = COMPONENTS[row];
            let along = |a: usize, b: usize| f[(axis, a)] * self.gradients[(b, node)];
            if i == j {
                along(i, i)
            } else {
                along(i, j) + along(j, i)
            }
        })
    }

    /// Adds the contributions of the change of stress and of the rotation of `stress`.
    fn add_stiffness(
        &self,
        tangent: &mut SMatrix<f64, UNKNOWNS, UNKNOWNS>,
        strain: &SMatrix<f64, 6, UNKNOWNS>,
        modulus: &Matrix6<f64>,
        stress: &Matrix3<f64>,
    ) {
        *tangent += strain.tr_mul(&(modulus * strain * self.weight));
        let turning = self
            .gradients
            .tr_mul(&(stress * self.gradients * self.weight));
        for a in 0..NODES {
            for b in 0..NODES {
                for axis in 0..3 {
                    tangent[(3 * a + axis, 3 * b + axis)] += turning[(a, b)];
                }
            }
        }
    }
}
