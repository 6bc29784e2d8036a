use nalgebra::{Rotation3, SMatrix, SVector, Vector3};
use proptest::prelude::*;

use super::{FOAM, RUBBER, SOFTENED, unknowns};
use crate::finite_element::FiniteElementError;
use crate::finite_element::body::Body;
use crate::finite_element::element::{Displacements, Element, NODES, Relaxed, UNKNOWNS};
use crate::finite_element::mesh::Mesh;

/// A cube with its corners moved randomly near their places.
fn corners() -> impl Strategy<Value = [Vector3<f64>; NODES]> {
    prop::array::uniform8(prop::array::uniform3(-0.15..0.15)).prop_map(|shift| {
        let mesh = Mesh::of_cube([1, 1, 1], |at| at);
        let mut places = mesh.elements[0].map(|node| mesh.nodes[node]);
        places
            .iter_mut()
            .zip(shift)
            .for_each(|(place, shift)| *place += Vector3::from(shift));
        places
    })
}

fn displacements() -> impl Strategy<Value = Displacements> {
    prop::array::uniform24(-0.1..0.1).prop_map(|x| Displacements::from_column_slice(&x))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn forces_are_the_slope_of_the_energy_and_the_tangent_that_of_the_forces(corners in corners(), moved in displacements()) {
        let element = Element::new(&corners).unwrap();
        for material in [FOAM, RUBBER, SOFTENED] {
            let at = |moved: &Displacements| element.contribution(moved, &material, Relaxed::NONE).unwrap();
            let here = at(&moved);
            let h = 1e-6;
            for unknown in 0..UNKNOWNS {
                let mut step = SVector::<f64, UNKNOWNS>::zeros();
                step[unknown] = h;
                let step = Displacements::from_column_slice(step.as_slice());
                let (up, down) = (moved + step, moved - step);
                let slope = (element.energy(&up, &material).unwrap() - element.energy(&down, &material).unwrap()) / (2.0 * h);
                prop_assert!((slope - here.force[unknown]).abs() < 1e-6 * here.tangent.amax());
                let slopes = (at(&up).force - at(&down).force) / (2.0 * h);
                prop_assert!((slopes - here.tangent.column(unknown)).amax() < 1e-6 * here.tangent.amax());
            }
            prop_assert!((here.tangent - here.tangent.transpose()).amax() < 1e-12 * here.tangent.amax());
        }
    }

    /// Rotated and shifted as a whole, a deformed element stores the same energy, and its forces rotate with it.
    #[test]
    fn a_rigid_motion_changes_nothing(corners in corners(), moved in displacements(), turn in prop::array::uniform3(-3.0..3.0), shift in prop::array::uniform3(-9.0..9.0)) {
        let element = Element::new(&corners).unwrap();
        let turn = Rotation3::new(Vector3::from(turn));
        let place = SMatrix::<f64, 3, NODES>::from_columns(&corners);
        let mut after = turn * (place + moved) - place;
        after.column_iter_mut().for_each(|mut column| column += Vector3::from(shift));
        let energies = (element.energy(&moved, &FOAM).unwrap(), element.energy(&after, &FOAM).unwrap());
        prop_assert!((energies.0 - energies.1).abs() < 1e-10 * (1.0 + energies.0));
        let force = |moved: &Displacements| {
            let force = element.contribution(moved, &FOAM, Relaxed::NONE).unwrap().force;
            Displacements::from_column_slice(force.as_slice())
        };
        prop_assert!((turn * force(&moved) - force(&after)).amax() < 1e-10);
    }

    /// The forces of an element balance, and so do their moments.
    #[test]
    fn an_element_pushes_neither_itself_nor_turns(corners in corners(), moved in displacements()) {
        let element = Element::new(&corners).unwrap();
        let force = element.contribution(&moved, &FOAM, Relaxed::NONE).unwrap().force;
        let force = Displacements::from_column_slice(force.as_slice());
        let place = SMatrix::<f64, 3, NODES>::from_columns(&corners) + moved;
        prop_assert!(force.column_sum().amax() < 1e-12);
        let moment: Vector3<f64> = (0..NODES).map(|n| place.column(n).cross(&force.column(n))).sum();
        prop_assert!(moment.amax() < 1e-12);
    }
}

/// Six motions without force, and 18 with one: no other mode lacks stiffness.
#[test]
fn no_motion_but_a_rigid_one_is_free() {
    let mesh = Mesh::of_cube([1, 1, 1], |at| at);
    let element = Element::new(&mesh.elements[0].map(|node| mesh.nodes[node])).unwrap();
    for material in [FOAM, RUBBER] {
        let tangent = element
            .contribution(&Displacements::zeros(), &material, Relaxed::NONE)
            .unwrap()
            .tangent;
        let mut values: Vec<f64> = tangent.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
        assert!(
            values[..6].iter().all(|v| v.abs() < 1e-9 * values[23]),
            "{values:?}"
        );
        assert!(values[6] > 1e-2 * material.shear_modulus(), "{values:?}");
    }
}

/// The patch test at finite strains: a homogeneous deformation of the surface of a distorted mesh also moves its inner nodes.
#[test]
fn a_distorted_patch_deforms_homogeneously() {
    let inside = |x: f64| x > 0.0 && x < 1.0;
    let mesh = Mesh::of_cube([3, 3, 3], |at| {
        if inside(at.x) && inside(at.y) && inside(at.z) {
            let wave = |x: f64| 0.09 * (19.0 * x).sin();
            at + Vector3::new(
                wave(at.y + at.z),
                wave(at.z - 2.0 * at.x),
                wave(at.x + 3.0 * at.y),
            )
        } else {
            at
        }
    });
    let gradient = nalgebra::Matrix3::new(0.12, 0.08, 0.0, -0.03, -0.15, 0.05, 0.02, 0.0, 0.06);
    for material in [FOAM, RUBBER, SOFTENED] {
        let exact: Vec<f64> = mesh
            .nodes
            .iter()
            .flat_map(|at| {
                let u: [f64; 3] = (gradient * at).into();
                u
            })
            .collect();
        let surface = unknowns(&mesh, &[0, 1, 2], |at| {
            !(inside(at.x) && inside(at.y) && inside(at.z))
        });
        let body = Body::new(mesh.clone(), material, None, surface.iter().copied()).unwrap();
        let mut at = exact.clone();
        for (unknown, displacement) in at
            .iter_mut()
            .enumerate()
            .filter(|(unknown, _)| !surface.contains(unknown))
        {
            *displacement += 3e-4 * (unknown as f64).sin();
        }
        body.rest(&mut at, None).unwrap();
        let error = at
            .iter()
            .zip(&exact)
            .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(error < 1e-8, "{error}");
    }
}

#[test]
fn refuses_what_is_inside_out() {
    let mesh = Mesh::of_cube([1, 1, 1], |at| Vector3::new(-at.x, at.y, at.z));
    let corners = mesh.elements[0].map(|node| mesh.nodes[node]);
    assert_eq!(
        Element::new(&corners).err(),
        Some(FiniteElementError::Inverted)
    );
    let mesh = Mesh::of_cube([1, 1, 1], |at| at);
    let element = Element::new(&mesh.elements[0].map(|node| mesh.nodes[node])).unwrap();
    let mut crushed = Displacements::zeros();
    crushed
        .row_mut(0)
        .iter_mut()
        .zip(mesh.elements[0])
        .for_each(|(u, node)| *u = -1.5 * mesh.nodes[node].x);
    assert_eq!(
        element.stresses(&crushed, &FOAM).err(),
        Some(FiniteElementError::Inverted)
    );
}
