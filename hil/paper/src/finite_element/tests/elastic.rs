//! Small strains compared to closed forms: order of convergence, and no locking where the volume hardly changes.

use nalgebra::Vector3;

use super::{FOAM, INNER, OUTER, RUBBER, SMALL, SOFTENED, in_plane_strain, thick_ring, unknowns};
use crate::finite_element::body::Body;
use crate::finite_element::material::MooneyRivlin;
use crate::finite_element::mesh::Mesh;

/// Relative error of the displacements of a thick ring in plane strain with a widened bore: u = A·r + B/r (Lamé), with no traction
/// on the outer surface. `n` elements through the wall.
fn error_of_thick_ring(material: MooneyRivlin, n: usize) -> f64 {
    let mesh = thick_ring(n);
    let shear = material.shear_modulus();
    // No radial stress at the outer surface: (λ + G)·A = G·B/b².
    let b_over_a = OUTER * OUTER * (material.bulk_modulus() + shear / 3.0) / shear;
    let a = SMALL / (INNER + b_over_a / INNER);
    let exact = |at: &Vector3<f64>| {
        let radius = at.xy().norm();
        Vector3::new(at.x, at.y, 0.0) / radius * (a * radius + a * b_over_a / radius)
    };
    let prescribed = in_plane_strain(&mesh);
    let bore = unknowns(&mesh, &[0, 1], |at| (at.xy().norm() - INNER).abs() < 1e-9);
    let body = Body::new(
        mesh,
        material,
        None,
        prescribed.into_iter().chain(bore.iter().copied()),
    )
    .unwrap();
    let mut moved = body.undeformed();
    for unknown in bore {
        moved[unknown] = exact(&body.mesh().nodes[unknown / 3])[unknown % 3];
    }
    body.rest(&mut moved, None).unwrap();
    let (mut error, mut size) = (0.0, 0.0);
    for (node, at) in body.mesh().nodes.iter().enumerate() {
        let ours = Vector3::from_column_slice(&moved[3 * node..3 * node + 3]);
        error += (ours - exact(at)).norm_squared();
        size += exact(at).norm_squared();
    }
    (error / size).sqrt()
}

/// Relative difference between the moment of a beam bent to a curvature and E·I·κ. `n` elements along each edge.
fn error_of_bending(material: MooneyRivlin, n: usize) -> f64 {
    const LENGTH: f64 = 2.0;
    let mesh = Mesh::of_cube([2 * n, 2 * n, n], |at| {
        Vector3::new(LENGTH * at.x, 2.0 * at.y - 1.0, at.z)
    });
    let mut prescribed = unknowns(&mesh, &[0], |at| at.x == 0.0);
    let end = unknowns(&mesh, &[0], |at| at.x == LENGTH);
    prescribed.extend(unknowns(&mesh, &[1], |at| *at == Vector3::zeros()));
    prescribed.extend(unknowns(&mesh, &[2], |at| at.z == 0.0));
    let body = Body::new(
        mesh,
        material,
        None,
        prescribed.into_iter().chain(end.iter().copied()),
    )
    .unwrap();
    let mut moved = body.undeformed();
    let height = |unknown: usize| body.mesh().nodes[unknown / 3].y;
    end.iter()
        .for_each(|&unknown| moved[unknown] = SMALL * LENGTH * height(unknown));
    let forces = body.rest(&mut moved, None).unwrap();
    let moment: f64 = end
        .iter()
        .map(|&unknown| forces[unknown] * height(unknown))
        .sum();
    let modulus = 2.0 * material.shear_modulus() * (1.0 + material.poisson_ratio());
    // Width 1, height 2.
    moment / (modulus * 8.0 / 12.0 * SMALL) - 1.0
}

#[test]
fn displacements_converge_with_the_square_of_the_size() {
    for material in [FOAM, SOFTENED] {
        let errors = [4, 8, 16].map(|n| error_of_thick_ring(material, n));
        println!(
            "thick ring, Poisson's ratio {:.5}: {errors:?}",
            material.poisson_ratio()
        );
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((1.9..2.3).contains(&order), "{errors:?}");
        }
    }
}

#[test]
fn a_thick_ring_that_keeps_its_volume_does_not_lock() {
    let (foam, rubber) = (error_of_thick_ring(FOAM, 4), error_of_thick_ring(RUBBER, 4));
    assert!(rubber < foam && foam < 1e-3, "{foam} {rubber}");
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn bending_converges_with_the_square_of_the_size_and_does_not_lock() {
    for material in [FOAM, RUBBER] {
        let errors = [2, 4, 8].map(|n| error_of_bending(material, n));
        println!(
            "bending, Poisson's ratio {:.5}: {errors:?}",
            material.poisson_ratio()
        );
        assert!(
            errors[0].abs() < 0.2 && errors[2].abs() < 0.015,
            "{errors:?}"
        );
        for pair in errors.windows(2) {
            assert!((pair[0] / pair[1]).log2() > 1.8, "{errors:?}");
        }
    }
}
