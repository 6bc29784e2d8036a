//! Contact with the mandrel against closed forms: a thick ring in plane strain pressed on to it, pulled off it, and turned on it.

use nalgebra::{Rotation3, Vector3};

use super::{FOAM, INNER, OUTER, SMALL, SOFTENED, in_plane_strain, thick_ring, unknowns};
use crate::finite_element::body::Body;
use crate::finite_element::contact::Mandrel;
use crate::finite_element::material::MooneyRivlin;
use crate::finite_element::mesh::Mesh;

fn on_bore(at: &Vector3<f64>) -> bool {
    (at.xy().norm() - INNER).abs() < 1e-9
}

fn on_outside(at: &Vector3<f64>) -> bool {
    (at.xy().norm() - OUTER).abs() < 1e-9
}

/// Pressure over depth, MPa/mm, as `times` the wall's.
fn stiffness(material: &MooneyRivlin, times: f64) -> f64 {
    let modulus = material.bulk_modulus() + 4.0 / 3.0 * material.shear_modulus();
    times * modulus / (OUTER - INNER)
}

fn mandrel(mesh: &Mesh, stiffness: f64, separable: bool) -> Mandrel {
    Mandrel {
        radius: INNER,
        stiffness,
        surface: mesh.areas(on_bore),
        separable,
    }
}

/// Lamé's ring on an elastic bed of `bed` MPa/mm, its outer surface moved by `outward` mm: u = A·r + B/r, with
/// σ_r = 2(λ + G)·A − 2G·B/r² and σ_r = bed·u at the bore. Returns u there, mm, and the pressure on the mandrel, MPa.
fn lame(material: &MooneyRivlin, bed: f64, outward: f64) -> (f64, f64) {
    let shear = material.shear_modulus();
    let both = material.bulk_modulus() + shear / 3.0;
    let b_over_a = (2.0 * both - bed * INNER) / (2.0 * shear / (INNER * INNER) + bed / INNER);
    let a = outward / (OUTER + b_over_a / OUTER);
    let bore = a * INNER + a * b_over_a / INNER;
    (bore, -bed * bore)
}

/// The same from elements, `n` through the wall: mean over the bore's nodes.
fn by_elements(
    material: MooneyRivlin,
    (stiffness, separable): (f64, bool),
    outward: f64,
    n: usize,
) -> (f64, f64) {
    let mesh = thick_ring(n);
    let mandrel = mandrel(&mesh, stiffness, separable);
    let outside = unknowns(&mesh, &[0, 1], on_outside);
    let prescribed = in_plane_strain(&mesh)
        .into_iter()
        .chain(outside.iter().copied());
    let body = Body::new(mesh, material, Some(mandrel.clone()), prescribed).unwrap();
    let mut moved = body.undeformed();
    for unknown in outside {
        moved[unknown] = outward / OUTER * body.mesh().nodes[unknown / 3][unknown % 3];
    }
    body.rest(&mut moved, None).unwrap();
    let count = mandrel.surface.len() as f64;
    let (mut radial, mut pressure) = (0.0, 0.0);
    for &(node, area) in &mandrel.surface {
        let at =
            body.mesh().nodes[node] + Vector3::from_column_slice(&moved[3 * node..3 * node + 3]);
        radial += (at.xy().norm() - INNER) / count;
        let push = mandrel.push(area, &at);
        // The force that holds the node against the mandrel points to the axis.
        pressure -= push.map_or(0.0, |push| push.force.dot(&at.xy().normalize())) / area / count;
    }
    (radial, pressure)
}

/// A stiff mandrel, with negligible depth, and one that yields as much as the ring.
#[test]
fn a_ring_pressed_on_to_a_mandrel_is_lames() {
    for material in [FOAM, SOFTENED] {
        for (times, separable) in [(1000.0, true), (1.0, true), (1.0, false)] {
            let stiffness = stiffness(&material, times);
            let (bore, pressure) = lame(&material, stiffness, -SMALL);
            assert!(bore < 0.0 && pressure > 0.0);
            let errors = [4, 8, 16].map(|n| {
                let ours = by_elements(material, (stiffness, separable), -SMALL, n);
                [ours.0 / bore - 1.0, ours.1 / pressure - 1.0]
            });
            println!("mandrel of {times} times the wall: bore and pressure {errors:?}");
            for figure in 0..2 {
                let errors = errors.map(|error| error[figure].abs());
                assert!(errors[2] < 1e-3, "{errors:?}");
                for pair in errors.windows(2) {
                    assert!(
                        (1.9..2.3).contains(&(pair[0] / pair[1]).log2()),
                        "{errors:?}"
                    );
                }
            }
        }
    }
    // The stiff one compared to a rigid one, which takes −2A·(λ + 2G) with u = 0 at the bore.
    let wall = FOAM.bulk_modulus() + 4.0 / 3.0 * FOAM.shear_modulus();
    let rigid = 2.0 * SMALL * OUTER / (OUTER * OUTER - INNER * INNER) * wall;
    let stiff = by_elements(FOAM, (stiffness(&FOAM, 1000.0), true), -SMALL, 16).1;
    assert!((stiff / rigid - 1.0).abs() < 3e-3, "{stiff} {rigid}");
}

/// On a separable mandrel the bore moves off freely; on an inseparable one a tension holds it.
#[test]
fn a_ring_pulled_off_its_mandrel_is_free_and_one_that_is_held_is_not() {
    let stiffness = stiffness(&FOAM, 1000.0);
    let (free, held) = (lame(&FOAM, 0.0, SMALL), lame(&FOAM, stiffness, SMALL));
    let ours = by_elements(FOAM, (stiffness, true), SMALL, 16);
    assert!((ours.0 / free.0 - 1.0).abs() < 1e-3, "{ours:?} {free:?}");
    assert_eq!(ours.1, 0.0);
    let ours = by_elements(FOAM, (stiffness, false), SMALL, 16);
    assert!(held.1 < 0.0);
    assert!((ours.1 / held.1 - 1.0).abs() < 1e-3, "{ours:?} {held:?}");
}

/// Without friction, a ring that was pressed on to its mandrel and is then rotated moves as a whole, and its forces rotate with it.
#[test]
fn a_ring_turned_on_its_mandrel_glides() {
    for separable in [true, false] {
        let mesh = thick_ring(2);
        let mandrel = mandrel(&mesh, stiffness(&FOAM, 1000.0), separable);
        let outside = unknowns(&mesh, &[0, 1, 2], on_outside);
        let body = Body::new(mesh, FOAM, Some(mandrel), outside.iter().copied()).unwrap();
        let nodes = &body.mesh().nodes;
        let mut moved = body.undeformed();
        for &unknown in outside.iter().filter(|&unknown| unknown % 3 < 2) {
            moved[unknown] = -0.1 / OUTER * nodes[unknown / 3][unknown % 3];
        }
        let pressed_forces = body.rest(&mut moved, None).unwrap();
        let pressed = moved.clone();
        let at = |of: &[f64], node: usize| Vector3::from_column_slice(&of[3 * node..3 * node + 3]);
        let mut forces = vec![];
        let mut turn = Rotation3::identity();
        for _ in 0..4 {
            turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.05) * turn;
            for &unknown in &outside {
                let node = unknown / 3;
                let turned = turn * (nodes[node] + at(&pressed, node)) - nodes[node];
                moved[unknown] = turned[unknown % 3];
            }
            forces = body.rest(&mut moved, None).unwrap();
        }
        let largest = pressed_forces
            .iter()
            .fold(0.0_f64, |most, f| most.max(f.abs()));
        for (node, place) in nodes.iter().enumerate() {
            let turned = turn * (place + at(&pressed, node)) - place;
            assert!((at(&moved, node) - turned).amax() < 1e-5, "{node}");
            let off = at(&forces, node) - turn * at(&pressed_forces, node);
            assert!(off.amax() < 1e-4 * largest, "{node}: {off} of {largest}");
        }
    }
}
