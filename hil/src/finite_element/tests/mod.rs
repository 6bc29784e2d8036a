//! The model against closed forms, invariants and another program.

use nalgebra::Vector3;

use super::body::Body;
use super::drive::Drive;
use super::material::MooneyRivlin;
use super::mesh::Mesh;

mod calculix;
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

/// Degrees of freedom `axes` of the nodes at which `is_there`.
fn unknowns(mesh: &Mesh, axes: &[usize], is_there: impl Fn(&Vector3<f64>) -> bool) -> Vec<usize> {
    mesh.nodes_where(is_there)
        .flat_map(|node| axes.iter().map(move |axis| 3 * node + axis))
        .collect()
}

/// A unit cube in `counts` elements that stands on y = 0 and is sheared by moving its top along x.
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
