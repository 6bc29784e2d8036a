//! The elastic part compared to CalculiX, which runs if it is installed. The repository contains only the form of its input.

use std::fmt::Write as _;
use std::io::Write as _;
use std::process::Command;
use std::sync::Once;

use super::{FOAM, SOFTENED, sheared_cube};
use crate::finite_element::drive::Drive;
use crate::finite_element::material::MooneyRivlin;
use crate::finite_element::ring::{Bore, Divisions, RingModel, is_on_bore};

/// Whether `ccx` can run; if not, a message says that the comparison is skipped. If `CI` is `true`, nothing may be skipped.
fn is_installed() -> bool {
    let installed = Command::new("ccx").arg("-v").output().is_ok();
    if !installed {
        assert_ne!(
            std::env::var("CI").as_deref(),
            Ok("true"),
            "ccx is not on the PATH; install calculix-ccx"
        );
        // Once for all tests, and past their harness, which hides the output of passing tests.
        static SAID: Once = Once::new();
        SAID.call_once(|| {
            let said = writeln!(
                std::io::stderr(),
                "left out, the elastic part is not compared with CalculiX: ccx is not on the PATH; install calculix-ccx"
            );
            said.unwrap();
        });
    }
    installed
}

/// A comma, a line's end, and the numbers between.
fn list(values: impl IntoIterator<Item = usize>) -> String {
    values.into_iter().fold(String::new(), |mut text, value| {
        let _ = writeln!(text, "{value},");
        text
    })
}

/// A case for comparison.
struct Case<'a> {
    drive: &'a Drive,
    material: MooneyRivlin,
    /// The direction of the motion.
    axis: usize,
    /// mm
    displacement: f64,
    /// Nodes that a rigid body around z holds at their radius, free to slide. Our model uses contact, CalculiX a constraint in
    /// cylindrical coordinates. The constraint keeps its directions, so the displacement has to be small.
    gliding: Vec<usize>,
}

/// The input for `case`, in ten increments.
fn input(case: &Case) -> String {
    let Case {
        drive,
        material,
        axis,
        displacement,
        gliding,
    } = case;
    let mesh = drive.body.mesh();
    let mut text = String::from("*NODE, NSET=ALL\n");
    for (node, at) in mesh.nodes.iter().enumerate() {
        let _ = writeln!(
            text,
            "{}, {:.12}, {:.12}, {:.12}",
            node + 1,
            at.x,
            at.y,
            at.z
        );
    }
    text += "*ELEMENT, TYPE=C3D8, ELSET=BODY\n";
    for (element, corners) in mesh.elements.iter().enumerate() {
        let corners: Vec<String> = corners.iter().map(|node| (node + 1).to_string()).collect();
        let _ = writeln!(text, "{}, {}", element + 1, corners.join(", "));
    }
    let _ = writeln!(
        text,
        "*NSET, NSET=MOVED\n{}",
        list(drive.moved.iter().map(|unknown| unknown / 3 + 1)).trim_end()
    );
    if !gliding.is_empty() {
        let nodes = list(gliding.iter().map(|node| node + 1));
        let _ = writeln!(
            text,
            "*NSET, NSET=GLIDING\n{}\n*TRANSFORM, NSET=GLIDING, TYPE=C\n0., 0., 0., 0., 0., 1.",
            nodes.trim_end()
        );
    }
    // C10, C01, C20, C11, C02 and (J − 1)²/D1, (J − 1)⁴/D2; the last one is practically zero.
    let MooneyRivlin { c10, c01, c11, d } = material;
    let _ = writeln!(
        text,
        "*MATERIAL, NAME=MESH\n*HYPERELASTIC, POLYNOMIAL, N=2\n{c10}, {c01}, 0., {c11}, 0., {:.12e}, 1.e12\n\
         *SOLID SECTION, ELSET=BODY, MATERIAL=MESH\n*STEP, NLGEOM, INC=100\n*STATIC\n0.1, 1.\n*BOUNDARY",
        1.0 / d
    );
    for unknown in drive.body.prescribed() {
        let at = if drive.moved.contains(&unknown) {
            *displacement
        } else {
            0.0
        };
        let (node, mut direction) = (unknown / 3, unknown % 3 + 1);
        if gliding.contains(&node) && direction == 1 {
            // Held on the plane of symmetry, where x is the circumferential direction.
            direction = 2;
        }
        let _ = writeln!(text, "{}, {direction}, {direction}, {at}", node + 1);
    }
    for node in gliding {
        let _ = writeln!(text, "{}, 1, 1, 0.", node + 1);
    }
    assert!(drive.moved.iter().all(|unknown| unknown % 3 == *axis));
    text += "*NODE PRINT, NSET=MOVED, TOTALS=ONLY\nRF\n*END STEP\n";
    text
}

/// The force from CalculiX, N.
fn theirs(case: &Case) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("body.inp"), input(case)).unwrap();
    let run = Command::new("ccx")
        .arg("-i")
        .arg("body")
        .current_dir(folder.path())
        .output()
        .unwrap();
    let output = String::from_utf8_lossy(&run.stdout);
    let printed = std::fs::read_to_string(folder.path().join("body.dat")).unwrap_or_default();
    // After the last heading: fx, fy and fz.
    let totals = printed.rsplit("total force").next().unwrap_or_default();
    let values: Vec<f64> = totals
        .lines()
        .skip(1)
        .flat_map(str::split_whitespace)
        .map_while(|v| v.parse().ok())
        .collect();
    assert_eq!(values.len(), 3, "ccx gave no force: {output}\n{printed}");
    values[case.axis]
}

/// Our force, N.
fn ours(case: &Case) -> f64 {
    let curve = case.drive.static_curve(case.displacement, 10).unwrap();
    curve.force[10] / case.drive.force_scale
}

/// The relative difference of our force, without its sign.
fn difference(what: &str, case: &Case) -> f64 {
    let (ours, theirs) = (ours(case), theirs(case));
    let difference = ours / theirs - 1.0;
    println!(
        "{what}: ours {ours:.4} N, CalculiX {theirs:.4} N: {:+.2} %",
        100.0 * difference
    );
    difference.abs()
}

/// Increasingly fine meshes of one kind; the last has to be within `bound`.
fn agrees(differences: &[f64], bound: f64) {
    assert!(
        differences.windows(2).all(|pair| pair[1] < pair[0]),
        "no nearer with a finer mesh: {differences:?}"
    );
    assert!(differences.last().unwrap() < &bound, "{differences:?}");
}

#[test]
fn a_sheared_block_agrees_within_a_percent() {
    if !is_installed() {
        return;
    }
    for material in [FOAM, SOFTENED] {
        let differences = [2, 4, 8].map(|n| {
            let case = Case {
                drive: &sheared_cube(material, [n; 3]),
                material,
                axis: 0,
                displacement: 0.2,
                gliding: vec![],
            };
            difference(&format!("block of {n}"), &case)
        });
        agrees(&differences, 0.01);
    }
}

/// The ring, moved by `displacement` mm, with 2, 4 and 6 elements through the wall.
fn differences_of_ring(bore: Bore, displacement: f64) -> [f64; 3] {
    [2, 4, 6].map(|n| {
        let model = RingModel {
            bore,
            divisions: Divisions::through_wall(n),
            ..RingModel::new(2.0)
        };
        let drive = model.drive().unwrap();
        let gliding = match bore {
            Bore::Bonded => vec![],
            Bore::Gliding | Bore::Separable => drive.body.mesh().nodes_where(is_on_bore).collect(),
        };
        let case = Case {
            drive: &drive,
            material: model.material().unwrap(),
            axis: 1,
            displacement,
            gliding,
        };
        difference(
            &format!("{bore:?} ring, {n} elements through the wall"),
            &case,
        )
    })
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn the_bonded_ring_agrees_within_three_percent() {
    if is_installed() {
        agrees(&differences_of_ring(Bore::Bonded, 0.25), 0.03);
    }
}

/// Contact against a constraint.
#[test]
#[ignore = "half a minute: in the full tier"]
fn the_ring_that_glides_agrees_within_three_percent() {
    if is_installed() {
        agrees(&differences_of_ring(Bore::Gliding, 0.05), 0.03);
    }
}
