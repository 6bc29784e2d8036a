//! `hil export`: its files, its messages and its refusals.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::command;
use crate::command::words;
use crate::refusal::{self, refuses};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::pack::{Expectation, PackError, PackInfo, decode};
use mesh_damper::passivity::Active;

/// A model with `more` after its effects, one of which is a delay of 20 ms.
fn model(more: &str) -> String {
    format!(
        r#"{{ "format": "mesh-damper-model", "version": 1,
  "units": {{ "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" }},
  "law": [ {{ "amplitude": 0.1, "k1": 1.2, "k3": 30.0, "c": 0.1, "alpha": 0.3 }},
           {{ "amplitude": 0.2, "k1": 1.1, "k3": 31.0, "c": 0.1, "alpha": 0.3 }} ],
  "effects": [ {{ "family": "stick_slip", "parameters": {{ "stiffness": 1.2, "slip_limit": 0.03 }} }},
               {{ "family": "delay", "parameters": {{ "time": 0.02 }} }} ], {more}
  "fitted_range": {{ "displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3] }} }}"#
    )
}

fn directory() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), model("")).unwrap();
    root
}

const MODEL: [&str; 3] = ["export", "--model", "model.json"];

fn export(directory: &Path, arguments: &[&str]) -> String {
    command::hil(directory, &[&MODEL[..], arguments].concat())
}

fn decoded(pack: &[u8]) -> (FastLaw<8>, PackInfo) {
    let mut law = FastLaw::EMPTY;
    decode(pack, &mut law, &Expectation::at(1e4)).unwrap();
    (law, PackInfo::of(pack).unwrap().unwrap())
}

#[test]
fn a_pack_says_its_rate_range_model_and_name() {
    let root = directory();
    let said = export(
        root.path(),
        &[
            "--format",
            "pack",
            "--tick-rate",
            "10000",
            "--out",
            "mount 4.mdcp",
            "--revision",
            "3",
            "--density",
            "2.5",
            "--json",
            "export.json",
        ],
    );
    let pack = fs::read(root.path().join("mount 4.mdcp")).unwrap();
    let (law, info) = decoded(&pack);
    assert_eq!(law.augmented().effects().count(), 2);
    assert_eq!(law.augmented().law().k1(), 1.1);
    assert_eq!((&*info.name, info.stamp.revision), ("mount 4", 3));
    assert_eq!((info.amplitude, info.density), (Some(0.2), Some(2.5)));
    assert_eq!(info.operating_range.unwrap().velocity(), [-6.3, 6.3]);
    assert_ne!(info.stamp.identity.0, [0; 8]);

    let json = fs::read(root.path().join("export.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["format"], "pack");
    assert_eq!(json["identity"], info.stamp.identity.to_string());
    assert_eq!(json["tick_rate"], 10_000.0);
    assert_eq!(json["files"][0]["path"], "mount 4.mdcp");
    assert_eq!(json["files"][0]["bytes"], pack.len());
    assert_eq!(json["passive"], true);
    let first = format!(
        "mount 4.mdcp ({} bytes): model {}, revision 3, for 10000 ticks a second, at an amplitude of 0.2 mm, within -0.2 to 0.2 mm and \
         -6.3 to 6.3 mm/s, passive",
        pack.len(),
        info.stamp.identity
    );
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines[0], first);
    assert!(lines[1].contains("Expectation::at(10000.0)"), "{said}");
    // Again with existing files, at another amplitude.
    export(
        root.path(),
        &[
            "--format",
            "pack",
            "--tick-rate",
            "1e4",
            "--out",
            "mount 4.mdcp",
            "--amplitude",
            "0.1",
        ],
    );
    let (law, info) = decoded(&fs::read(root.path().join("mount 4.mdcp")).unwrap());
    assert_eq!(
        (law.augmented().law().k1(), info.amplitude),
        (1.2, Some(0.1))
    );
}

/// A dashpot below 0 together with the friction.
#[test]
fn an_active_law_is_refused_unless_it_is_allowed() {
    let root = tempfile::tempdir().unwrap();
    let dashpot = r#"[ { "family": "viscous", "parameters": { "c1": -0.5 } },"#;
    fs::write(
        root.path().join("model.json"),
        model("").replace(r#""effects": ["#, &format!(r#""effects": {dashpot}"#)),
    )
    .unwrap();
    let arguments = words("--format pack --tick-rate 10000 --out mount.mdcp --amplitude 0.2");
    let refused = refusal::hil(root.path(), &[&MODEL[..], &arguments].concat());
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    for part in [
        "model.json: field viscous.c1: ",
        "with c1 = -0.5, viscous can give more energy than it takes",
        "--allow-active",
    ] {
        assert!(said.contains(part), "{said}");
    }
    assert!(!root.path().join("mount.mdcp").exists());

    let more = ["--allow-active", "--json", "export.json"];
    let allowed = refusal::hil(root.path(), &[&MODEL[..], &arguments, &more].concat());
    assert!(allowed.status.success());
    let said = String::from_utf8(allowed.stderr).unwrap();
    assert!(
        said.starts_with(
            "warning: the law is active: with c1 = -0.5, viscous can give more energy"
        ),
        "{said}"
    );
    let json = fs::read(root.path().join("export.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["passive"], false);
    let pack = fs::read(root.path().join("mount.mdcp")).unwrap();
    let mut law = FastLaw::<8>::EMPTY;
    let expected = Expectation::at(1e4);
    assert!(matches!(
        decode(&pack, &mut law, &expected),
        Err(PackError::Active(Active { field: "c1", .. }))
    ));
    let expected = Expectation {
        allow_active: true,
        ..expected
    };
    decode(&pack, &mut law, &expected).unwrap();
}

/// An amplitude that was chosen by default is reported.
#[test]
fn a_law_over_amplitude_is_warned_of() {
    let root = directory();
    let out = |more: &[&str]| {
        let arguments = ["--format", "pack", "--tick-rate", "10000", "--out", "-"];
        let output = refusal::hil(root.path(), &[&MODEL[..], &arguments, more].concat());
        assert!(output.status.success());
        // Only the pack.
        decoded(&output.stdout);
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(
        out(&[]),
        "warning: the coefficients depend on the amplitude; the export uses those of 0.2 mm; --amplitude selects others\n"
    );
    assert_eq!(out(&["--amplitude", "0.15"]), "");
}

#[test]
fn a_module_is_written_whose_name_is_one() {
    let root = directory();
    let said = export(
        root.path(),
        &words("--format rust --tick-rate 10000 --out 4th-mount.rs"),
    );
    let module = fs::read_to_string(root.path().join("4th-mount.rs")).unwrap();
    assert!(module.contains("pub const NAME: &str = \"4th-mount\";"));
    assert!(module.contains("pub type DamperLaw = StaticLaw<(StickSlip<f32>, Delay<f32>)>;"));
    let used =
        "`#[path = \"4th-mount.rs\"] mod model_4th_mount;`, then `model_4th_mount::fill(&mut law)`";
    assert!(said.contains(used), "{said}");
}

/// Header and source compile separately without a warning, and contain the pack.
#[test]
fn c_compiles_and_holds_the_pack() {
    let root = directory();
    let common = [
        "--tick-rate",
        "10000",
        "--name",
        "3. Mount \"??/\" ä",
        "--revision",
        "4294967295",
    ];
    export(
        root.path(),
        &[&["--format", "pack", "--out", "pack"], &common[..]].concat(),
    );
    let said = export(
        root.path(),
        &[&["--format", "c", "--out", "sub/mount-4.c"], &common[..]].concat(),
    );
    assert!(said.starts_with("sub/mount-4.h ("), "{said}");
    assert!(
        said.contains("model_3_Mount_pack has MODEL_3_MOUNT_PACK_LENGTH bytes"),
        "{said}"
    );
    let main = r#"#include <stdio.h>
#include "sub/mount-4.h"
int main(void) {
    if (MODEL_3_MOUNT_TICK_RATE != 10000.0f || MODEL_3_MOUNT_REVISION != 4294967295u) return 1;
    if (model_3_Mount_displacement[1] != 0.2f || model_3_Mount_velocity[0] != -6.3f) return 2;
    fwrite(MODEL_3_MOUNT_NAME, 1, sizeof MODEL_3_MOUNT_NAME - 1, stderr);
    return fwrite(model_3_Mount_pack, 1, MODEL_3_MOUNT_PACK_LENGTH, stdout) == MODEL_3_MOUNT_PACK_LENGTH ? 0 : 3;
}
"#;
    fs::write(root.path().join("main.c"), main).unwrap();
    let compiled = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"])
        .args(["main.c", "sub/mount-4.c", "-o", "main"])
        .current_dir(root.path())
        .output()
        .expect("Rust links by a C compiler");
    let error = String::from_utf8_lossy(&compiled.stderr).into_owned();
    assert!(compiled.status.success(), "{error}");
    let ran = Command::new(root.path().join("main")).output().unwrap();
    assert_eq!(ran.status.code(), Some(0));
    let pack = fs::read(root.path().join("pack")).unwrap();
    assert!(ran.stdout == pack);
    assert_eq!(String::from_utf8(ran.stderr).unwrap(), common[3]);
}

#[test]
fn what_cannot_be_exported_is_refused_in_one_line() {
    let root = directory();
    let table = r#""correction": { "reach": 0.2, "speed": 6.0, "unit": 1e-6, "cells": [CELLS], "memory": null },"#;
    let cells = vec!["1"; mesh_damper::effects::residual_table::CELLS].join(",");
    let with_table = model(&table.replace("CELLS", &cells));
    fs::write(root.path().join("table.json"), with_table).unwrap();
    let long = "x".repeat(40) + ".rs";
    for (arguments, said) in [
        (
            "--model model.json --format pack --tick-rate 0 --out p",
            &["--tick-rate: tick_rate = 0 is outside 1…1000000"][..],
        ),
        (
            "--model model.json --format pack --tick-rate NaN --out p",
            &["--tick-rate: tick_rate is not a finite number"],
        ),
        (
            "--model model.json --format pack --tick-rate 20000 --out p",
            &[
                "model.json: field effects[1] (delay): time",
                "give a --tick-rate other than 20000",
            ],
        ),
        (
            "--model model.json --format pack --tick-rate 1e4 --out p --amplitude 0.3",
            &["--amplitude: amplitude = 0.3 is outside 0.1…0.2"],
        ),
        (
            "--model model.json --format pack --tick-rate 1e4 --out p --density -1",
            &["--density: density = -1 is outside"],
        ),
        (
            "--model table.json --format rust --tick-rate 1e4 --out p",
            &[
                "table.json: field correction: ",
                "residual table",
                "--format pack",
            ],
        ),
        (
            "--model missing.json --format c --tick-rate 1e4 --out p",
            &["missing.json: cannot"],
        ),
        (
            "--model model.json --format pack --tick-rate 1e4 --out model.json",
            &["would replace the input"],
        ),
        (
            "--model model.json --format c --tick-rate 1e4 --out -",
            &["--out: C needs two files"],
        ),
        (
            &format!("--model model.json --format rust --tick-rate 1e4 --out {long}"),
            &[
                "--out: the name has 40 bytes, and a pack holds 32",
                "give --name",
            ],
        ),
    ] {
        let arguments: Vec<&str> = ["export"].into_iter().chain(arguments.split(' ')).collect();
        refuses(root.path(), &arguments, said);
    }
    let unknown = "--model model.json --format paper --tick-rate 1e4 --out p";
    let arguments: Vec<&str> = ["export"].into_iter().chain(unknown.split(' ')).collect();
    let output = refusal::hil(root.path(), &arguments);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("[possible values: pack, rust, c, fmu]"),
        "{error}"
    );
}
