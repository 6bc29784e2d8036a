//! Mooney–Rivlin hyperelasticity, eqs 8–10, in the reference configuration.
//!
//! Symmetric tensors are columns of six, in the order 11, 22, 33, 12, 23, 13; strains have twice their shear components.

use nalgebra::{Matrix3, Matrix6, Vector6};

/// Row and column of each component of a symmetric tensor.
pub(super) const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// The constants of eq 9, all in MPa: W = C10·(I1 − 3) + C01·(I2 − 3) + C11·(I1 − 3)·(I2 − 3) + D·(J − 1)², with the invariants
/// of the isochoric part of the deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MooneyRivlin {
    /// MPa
    pub c10: f64,
    /// MPa
    pub c01: f64,
    /// MPa
    pub c11: f64,
    /// MPa; half the bulk modulus.
    pub d: f64,
}

/// The stress of an isochoric deformation, and its derivative with respect to the strain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Isochoric {
    /// Second Piola–Kirchhoff stress, MPa.
    pub stress: Vector6<f64>,
    /// Its derivative with respect to the Green–Lagrange strain, MPa.
    pub tangent: Matrix6<f64>,
}

impl MooneyRivlin {
    /// Shear modulus without deformation, MPa: 2·(C10 + C01). C11 stiffens with the fourth power of the strain and has no part in
    /// it.
    pub fn shear_modulus(&self) -> f64 {
        2.0 * (self.c10 + self.c01)
    }

    /// Bulk modulus, MPa: 2·D.
    pub fn bulk_modulus(&self) -> f64 {
        2.0 * self.d
    }

    /// Poisson's ratio without deformation.
    pub fn poisson_ratio(&self) -> f64 {
        let (bulk, shear) = (self.bulk_modulus(), self.shear_modulus());
        (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear))
    }

    /// The isochoric part of the energy at the right Cauchy–Green tensor `c`, MPa.
    pub(crate) fn isochoric_energy(&self, c: &Matrix3<f64>) -> f64 {
        let isochoric = c / c.determinant().cbrt();
        let first = isochoric.trace() - 3.0;
        let second = 0.5 * (isochoric.trace().powi(2) - isochoric.norm_squared()) - 3.0;
        self.c10 * first + self.c01 * second + self.c11 * first * second
    }

    /// D·(J − 1)², MPa.
    pub(crate) fn volumetric_energy(&self, volume_ratio: f64) -> f64 {
        self.d * (volume_ratio - 1.0).powi(2)
    }

    /// The derivative of D·(J − 1)² with respect to J, MPa.
    pub(super) fn pressure(&self, volume_ratio: f64) -> f64 {
        2.0 * self.d * (volume_ratio - 1.0)
    }

    /// The isochoric part at the right Cauchy–Green tensor `c`, whose determinant is the square of `volume_ratio`.
    pub(super) fn isochoric(
        &self,
        c: &Matrix3<f64>,
        inverse: &Matrix3<f64>,
        volume_ratio: f64,
    ) -> Isochoric {
        let first_scale = volume_ratio.powf(-2.0 / 3.0);
        let second_scale = first_scale * first_scale;
        let trace = c.trace();
        let first = first_scale * trace;
        let second = second_scale * 0.5 * (trace * trace - c.norm_squared());

        let identity = column(&Matrix3::identity());
        let inverse_column = column(inverse);
        let double_inverse = symmetric_product(inverse);

        // ∂I1/∂C and ∂I2/∂C of the isochoric invariants, split into the parts without and with C⁻¹.
        let first_plain = identity * first_scale;
        let second_plain = column(&(Matrix3::identity() * trace - c)) * second_scale;
        let first_slope = first_plain - inverse_column * (first / 3.0);
        let second_slope = second_plain - inverse_column * (2.0 / 3.0 * second);

        let by_first = self.c10 + self.c11 * (second - 3.0);
        let by_second = self.c01 + self.c11 * (first - 3.0);

        let both = |a: &Vector6<f64>, b: &Vector6<f64>| a * b.transpose() + b * a.transpose();
        let squared_inverse = inverse_column * inverse_column.transpose();
        let first_curvature = both(&first_plain, &inverse_column) * (-1.0 / 3.0)
            + squared_inverse * (first / 9.0)
            + double_inverse * (first / 3.0);
        let second_curvature = both(&second_plain, &inverse_column) * (-2.0 / 3.0)
            + squared_inverse * (4.0 / 9.0 * second)
            + (identity * identity.transpose() - symmetric_product(&Matrix3::identity()))
                * second_scale
            + double_inverse * (2.0 / 3.0 * second);

        Isochoric {
            stress: (first_slope * by_first + second_slope * by_second) * 2.0,
            tangent: (first_curvature * by_first
                + second_curvature * by_second
                + both(&first_slope, &second_slope) * self.c11)
                * 4.0,
        }
    }
}

/// A symmetric tensor as a column.
pub(super) fn column(tensor: &Matrix3<f64>) -> Vector6<f64> {
    Vector6::from_fn(|i, _| tensor[COMPONENTS[i]])
}

/// The symmetric tensor of a column.
pub(super) fn tensor(column: &Vector6<f64>) -> Matrix3<f64> {
    let [a, b, c, ab, bc, ac] = (*column).into();
    Matrix3::new(a, ab, ac, ab, b, bc, ac, bc, c)
}

/// ½·(A_ik·A_jl + A_il·A_jk), which maps a symmetric E to A·E·A.
pub(super) fn symmetric_product(a: &Matrix3<f64>) -> Matrix6<f64> {
    Matrix6::from_fn(|row, col| {
        let ((i, j), (k, l)) = (COMPONENTS[row], COMPONENTS[col]);
        0.5 * (a[(i, k)] * a[(j, l)] + a[(i, l)] * a[(j, k)])
    })
}
