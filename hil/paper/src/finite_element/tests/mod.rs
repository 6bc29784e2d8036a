//! The model compared to closed forms, invariants and another program.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;

use super::body::Body;
use super::drive::Drive;
use super::material::MooneyRivlin;
use super::mesh::Mesh;

mod calculix;
mod contact;
mod elastic;
mod element;
mod material;
mod relaxation;
mod ring;

/// Soft, and as compressible as rubber foam.
const FOAM: MooneyRivlin = MooneyRivlin {
    c10: 1.2,
    c01: 0.3,
    c11: 4.0,
    d: 2.5,
};

/// Hardly compressible: Poisson's ratio 0.4995.
const RUBBER: MooneyRivlin = MooneyRivlin {
    c10: 1.2,
    c01: 0.3,
    c11: 0.0,
    d: 1_500.0,
};

/// A material whose C01 is negative, as in Table 4.
const SOFTENED: MooneyRivlin = MooneyRivlin {
    c10: 1.9,
    c01: -0.5,
    c11: 31.0,
    d: 1.0 / 0.35,
};

/// Displacements small enough for small strains, and large compared to rounding, mm.
const SMALL: f64 = 3e-5;

/// Radius of the thick ring's bore, mm.
const INNER: f64 = 6.0;

/// Of its outer surface, mm.
const OUTER: f64 = 11.0;

/// A quarter of a thick ring around z, 1 mm high, in `n` elements through the wall.
fn thick_ring(n: usize) -> Mesh {
    Mesh::of_cube([n, 2 * n, 1], |at| {
        let (radius, angle) = (INNER + (OUTER - INNER) * at.x, FRAC_PI_2 * at.y);
        Vector3::new(radius * angle.cos(), radius * angle.sin(), at.z)
    })
}

/// The degrees of freedom held by plane strain and by the symmetry of the quarter.
fn in_plane_strain(mesh: &Mesh) -> Vec<usize> {
    let mut held = unknowns(mesh, &[2], |_| true);
    held.extend(unknowns(mesh, &[0], |at| at.x.abs() < 1e-9));
    held.extend(unknowns(mesh, &[1], |at| at.y.abs() < 1e-9));
    held
}

/// Degrees of freedom `axes` of the nodes for which `is_there` holds.
fn unknowns(mesh: &Mesh, axes: &[usize], is_there: impl Fn(&Vector3<f64>) -> bool) -> Vec<usize> {
    mesh.nodes_where(is_there)
        .flat_map(|node| axes.iter().map(move |axis| 3 * node + axis))
        .collect()
}

/// A unit cube in `counts` elements that stands on y = 0, sheared by moving its top along x.
fn sheared_cube(material: MooneyRivlin, counts: [usize; 3]) -> Drive {
    let mesh = Mesh::of_cube(counts, |at| at);
    let moved = unknowns(&mesh, &[0], |at| at.y == 1.0);
    let mut prescribed = unknowns(&mesh, &[0, 1, 2], |at| at.y == 0.0 || at.y == 1.0);
    prescribed.extend(unknowns(&mesh, &[2], |at| at.z == 0.0));
    Drive {
        body: Body::new(mesh, material, None, prescribed).unwrap(),
        moved,
        force_scale: 1.0,
    }
}
