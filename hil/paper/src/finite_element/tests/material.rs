use nalgebra::{Matrix3, Vector6};
use proptest::prelude::*;

use super::{FOAM, RUBBER, SOFTENED};
use crate::finite_element::material::{MooneyRivlin, column, tensor};
use crate::finite_element::published::Reading;

fn deformation() -> impl Strategy<Value = Matrix3<f64>> {
    prop::array::uniform9(-0.25..0.25)
        .prop_map(|x| Matrix3::identity() + Matrix3::from_row_slice(&x))
}

/// W at the right Cauchy–Green tensor `c`.
fn energy(material: &MooneyRivlin, c: &Matrix3<f64>) -> f64 {
    material.isochoric_energy(c) + material.volumetric_energy(c.determinant().sqrt())
}

/// S with its volumetric part, and its isochoric part alone.
fn stresses(material: &MooneyRivlin, c: &Matrix3<f64>) -> (Matrix3<f64>, Matrix3<f64>) {
    let inverse = c.try_inverse().unwrap();
    let volume_ratio = c.determinant().sqrt();
    let isochoric = tensor(&material.isochoric(c, &inverse, volume_ratio).stress);
    (
        isochoric + inverse * (volume_ratio * material.pressure(volume_ratio)),
        isochoric,
    )
}

/// The change of C that changes component `i` of the strain, for shear twice its value.
fn change(i: usize, by: f64) -> Matrix3<f64> {
    let mut unit = Vector6::zeros();
    unit[i] = if i < 3 { 2.0 * by } else { by };
    tensor(&unit)
}

proptest! {
    #[test]
    fn stress_is_the_slope_of_the_energy_and_the_tangent_that_of_the_stress(f in deformation()) {
        let c = f.tr_mul(&f);
        for material in [FOAM, SOFTENED] {
            let stress = column(&stresses(&material, &c).0);
            let volume_ratio = c.determinant().sqrt();
            let tangent = material.isochoric(&c, &c.try_inverse().unwrap(), volume_ratio).tangent;
            let h = 1e-5;
            for i in 0..6 {
                let (up, down) = (c + change(i, h), c - change(i, h));
                let slope = (energy(&material, &up) - energy(&material, &down)) / (2.0 * h);
                prop_assert!((slope - stress[i]).abs() < 1e-6 * (1.0 + stress.amax()));
                let slopes = (column(&stresses(&material, &up).1) - column(&stresses(&material, &down).1)) / (2.0 * h);
                prop_assert!((slopes - tangent.column(i)).amax() < 1e-6 * tangent.amax());
            }
        }
    }

    /// Eq 10, which leaves out C11: the Cauchy stress from the left Cauchy–Green tensor.
    #[test]
    fn stress_is_that_of_equation_10(f in deformation()) {
        let material = RUBBER;
        let volume_ratio = f.determinant();
        prop_assume!(volume_ratio > 0.3);
        let b = f * f.transpose() * volume_ratio.powf(-2.0 / 3.0);
        let first = b.trace();
        let second = 0.5 * (first * first - (b * b).trace());
        let MooneyRivlin { c10, c01, d, .. } = material;
        let cauchy = b * (2.0 / volume_ratio * (c10 + c01 * first)) - b * b * (2.0 * c01 / volume_ratio)
            + Matrix3::identity()
                * (2.0 * d * (volume_ratio - 1.0) - (2.0 * first * c10 + 4.0 * second * c01) / (3.0 * volume_ratio));
        let ours = f * stresses(&material, &f.tr_mul(&f)).0 * f.transpose() / volume_ratio;
        prop_assert!((cauchy - ours).amax() < 1e-10 * cauchy.amax());
    }

    #[test]
    fn isochoric_stress_has_no_pressure(f in deformation()) {
        let c = f.tr_mul(&f);
        let isochoric = stresses(&FOAM, &c).1;
        prop_assert!((isochoric * c).trace().abs() < 1e-12 * (1.0 + isochoric.norm()));
    }
}

#[test]
fn small_strains_meet_the_moduli() {
    let h = 1e-6;
    for material in [FOAM, RUBBER, SOFTENED] {
        let at = |e: Matrix3<f64>| stresses(&material, &(Matrix3::identity() + e * 2.0)).0 / h;
        let shear = at(Matrix3::new(0.0, h, 0.0, h, 0.0, 0.0, 0.0, 0.0, 0.0))[(0, 1)];
        assert!((shear / (2.0 * material.shear_modulus()) - 1.0).abs() < 1e-4);
        let pressure = at(Matrix3::identity() * h).trace() / 3.0;
        assert!((pressure / (3.0 * material.bulk_modulus()) - 1.0).abs() < 1e-4);
    }
}

#[test]
fn readings_differ_in_what_they_are_named_for() {
    for reading in Reading::ALL {
        for density in [2.0, 2.5, 3.0, 3.5, 4.0] {
            let material = reading.material(density).unwrap();
            assert!(
                material.shear_modulus() > 0.0 && material.bulk_modulus() > 0.0,
                "{reading:?} {density}"
            );
        }
        assert_eq!(reading.material(2.2), None);
    }
    let poisson: Vec<f64> = Reading::ALL
        .map(|reading| reading.material(4.0).unwrap().poisson_ratio())
        .into();
    // Calculated by hand for C10 + C01 = 26 MPa: K = 0.7 and 5.714 MPa give (3K − 2G)/(6K + 2G).
    for (ours, by_hand) in poisson.iter().zip([-0.9418, -0.6281, 0.35]) {
        assert!((ours - by_hand).abs() < 1e-3, "{poisson:?}");
    }
}
