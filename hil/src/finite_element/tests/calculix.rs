//! The elastic part against CalculiX, which is run where it is installed. Nothing of it is here but the form of its input.

use std::fmt::Write as _;
use std::io::Write as _;
use std::process::Command;
use std::sync::Once;

use super::{FOAM, SOFTENED, sheared_cube};
use crate::finite_element::drive::Drive;
use crate::finite_element::material::MooneyRivlin;
use crate::finite_element::ring::{Bore, Divisions, RingModel};

/// Whether `ccx` can be run; if not, says that the comparison is left out. Where `CI` is `true` nothing may be left out.
fn is_installed() -> bool {
    let installed = Command::new("ccx").arg("-v").output().is_ok();
    if !installed {
        assert_ne!(
            std::env::var("CI").as_deref(),
            Ok("true"),
            "ccx is not on the PATH; install calculix-ccx"
        );
        // Once for all tests, and past their harness, which keeps what passing tests print to itself.
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

/// The input for `drive` moved by `displacement` along `axis`, in ten increments.
fn input(drive: &Drive, material: &MooneyRivlin, axis: usize, displacement: f64) -> String {
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
    // C10, C01, C20, C11, C02 and (J − 1)²/D1, (J − 1)⁴/D2; of the last as good as nothing.
    let MooneyRivlin { c10, c01, c11, d } = material;
    let _ = writeln!(
        text,
        "*MATERIAL, NAME=MESH\n*HYPERELASTIC, POLYNOMIAL, N=2\n{c10}, {c01}, 0., {c11}, 0., {:.12e}, 1.e12\n\
         *SOLID SECTION, ELSET=BODY, MATERIAL=MESH\n*STEP, NLGEOM, INC=100\n*STATIC\n0.1, 1.\n*BOUNDARY",
        1.0 / d
    );
    for unknown in drive.body.prescribed() {
        let at = if drive.moved.contains(&unknown) {
            displacement
        } else {
            0.0
        };
        let _ = writeln!(
            text,
            "{}, {}, {}, {at}",
            unknown / 3 + 1,
            unknown % 3 + 1,
            unknown % 3 + 1
        );
    }
    assert!(drive.moved.iter().all(|unknown| unknown % 3 == axis));
    text += "*NODE PRINT, NSET=MOVED, TOTALS=ONLY\nRF\n*END STEP\n";
    text
}

/// The force along `axis` that CalculiX finds, N.
fn force(drive: &Drive, material: &MooneyRivlin, axis: usize, displacement: f64) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("body.inp"),
        input(drive, material, axis, displacement),
    )
    .unwrap();
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
    values[axis]
}

/// Ours, N.
fn ours(drive: &Drive, displacement: f64) -> f64 {
    drive.static_curve(displacement, 10).unwrap().force[10] / drive.force_scale
}

#[test]
fn a_sheared_block_agrees_within_a_percent() {
    if !is_installed() {
        return;
    }
    for (material, n) in [(FOAM, 4), (FOAM, 8), (SOFTENED, 8)] {
        let drive = sheared_cube(material, [n; 3]);
        let (ours, theirs) = (ours(&drive, 0.2), force(&drive, &material, 0, 0.2));
        println!(
            "block of {n}: ours {ours:.4} N, CalculiX {theirs:.4} N: {:+.2} %",
            100.0 * (ours / theirs - 1.0)
        );
        assert!(
            n < 8 || (ours / theirs - 1.0).abs() < 0.01,
            "{ours} {theirs}"
        );
    }
}

/// The bonded ring: between meshes of one kind, finer and finer, down to 3 % at the finest.
#[test]
fn the_ring_agrees_within_three_percent() {
    if !is_installed() {
        return;
    }
    let differences = [2, 4, 6].map(|n| {
        let model = RingModel { bore: Bore::Bonded, divisions: Divisions::through_wall(n), ..RingModel::new(2.0) };
        let drive = model.drive().unwrap();
        let (ours, theirs) = (ours(&drive, 0.25), force(&drive, &model.material().unwrap(), 1, 0.25));
        let difference = ours / theirs - 1.0;
        println!("ring, {n} elements through the wall: ours {ours:.3} N, CalculiX {theirs:.3} N: {:+.2} %", 100.0 * difference);
        difference.abs()
    });
    assert!(differences[2] < 0.03, "{differences:?}");
}
