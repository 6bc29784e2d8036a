//! Every function of the library in C, on this machine and on an emulated Cortex-M4F; and the symbols that the library defines.

mod build;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use build::{On, Program, can, declared, library, run, source};
use mesh_damper_model::export::{Export, ExportSettings};
use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_model::{AddedEffect, Family, LawNode, Model};

/// The packs of [`write_packs`].
const PACKS: [&str; 4] = ["mount", "linear", "active", "silent"];

/// Writes the packs of the checks: a demo's model, a linear law, the same with a dashpot below 0, and a pack of version 6, which
/// has no description.
fn write_packs(folder: &Path) {
    let mount = ModelFile::read(build::example().join("model.json")).unwrap();
    let settings = ExportSettings {
        density: Some(4.0),
        revision: 3,
        ..ExportSettings::at(10_000.0, "mount")
    };
    write(folder, &mount, &settings);
    let node = LawNode {
        amplitude: 0.0,
        k1: 10.0,
        k3: 0.0,
        c: 0.05,
        alpha: 1.0,
    };
    let linear = Model {
        law: vec![node],
        effects: Vec::new(),
        correction: None,
        controls: Vec::new(),
    };
    let range = FittedRange {
        displacement: [-0.2, 0.2],
        velocity: [-6.3, 6.3],
    };
    write(
        folder,
        &ModelFile::new(linear.clone(), range),
        &ExportSettings::at(10_000.0, "linear"),
    );
    let dashpot = AddedEffect {
        family: Family::named("viscous").unwrap(),
        parameters: [("c1".to_owned(), -0.5)].into(),
    };
    let active = Model {
        effects: vec![dashpot],
        ..linear
    };
    let allowed = ExportSettings {
        allow_active: true,
        ..ExportSettings::at(10_000.0, "active")
    };
    write(folder, &ModelFile::new(active, range), &allowed);
    const SILENT: &[u8] = include_bytes!("../../../tests/wire/packs/version-6-effects.mdcp");
    let header = format!(
        "#include <stdint.h>\n#define SILENT_PACK_LENGTH {}u\nextern const uint8_t silent_pack[SILENT_PACK_LENGTH];\n",
        SILENT.len()
    );
    let bytes: Vec<String> = SILENT.iter().map(u8::to_string).collect();
    let source = format!(
        "#include \"silent.h\"\nconst uint8_t silent_pack[SILENT_PACK_LENGTH] = {{{}}};\n",
        bytes.join(", ")
    );
    std::fs::write(folder.join("silent.h"), header).unwrap();
    std::fs::write(folder.join("silent.c"), source).unwrap();
}

fn write(folder: &Path, file: &ModelFile, settings: &ExportSettings) {
    let export = Export::new(file, settings).unwrap();
    let stem = &settings.name;
    let [header, source] = export.c(stem).unwrap();
    std::fs::write(folder.join(format!("{stem}.h")), header).unwrap();
    std::fs::write(folder.join(format!("{stem}.c")), source).unwrap();
}

fn sources() -> Vec<PathBuf> {
    [
        "main.c",
        "packs.c",
        "cycles.c",
        "converters.c",
        "emulation.c",
        "rig.c",
    ]
    .map(source)
    .into()
}

#[test]
fn every_check_holds_and_prints_the_same_bits_on_both() {
    let mut said = Vec::new();
    for on in On::BOTH.into_iter().filter(|on| can(*on)) {
        let folder = tempfile::tempdir().unwrap();
        write_packs(folder.path());
        let program = Program {
            on,
            folder: folder.path(),
            sources: &sources(),
            packs: &PACKS,
            map: None,
        };
        let printed = program.run();
        assert!(printed.ends_with("all checks hold\n"), "{printed}");
        said.push(printed);
    }
    assert!(said.windows(2).all(|pair| pair[0] == pair[1]), "{said:#?}");
}

/// Names in the table of symbols that `nm` of `on` prints with `flag`.
fn symbols(on: On, archive: &Path, flag: &str) -> BTreeSet<String> {
    let listed = run(Command::new(on.tool("nm"))
        .args(["--extern-only", "--format=posix", flag])
        .arg(archive));
    let names = listed.lines().filter_map(|line| line.split(' ').next());
    names
        .filter(|name| !name.contains('['))
        .map(str::to_owned)
        .collect()
}

/// A C program links its own C library and compiler support: the library defines none of their names.
#[test]
fn the_library_defines_what_its_header_declares_and_nothing_else() {
    for on in On::BOTH.into_iter().filter(|on| can(*on)) {
        let archive = library(on);
        let declared = declared();
        assert!(declared.len() > 30, "{declared:?}");
        assert_eq!(symbols(on, &archive, "--defined-only"), declared, "{on:?}");
        // No code that could panic was linked.
        let all = run(Command::new(on.tool("nm")).arg(&archive));
        assert!(!all.contains("panic"), "{on:?}: {all}");
    }
}

/// In a linked image, functions that both the library and the program call come from newlib and libgcc.
#[test]
fn a_program_has_its_own_c_librarys_functions() {
    if !can(On::Emulator) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    write_packs(folder.path());
    let program = Program {
        on: On::Emulator,
        folder: folder.path(),
        sources: &sources(),
        packs: &PACKS,
        map: Some("checks.map"),
    };
    program.build();
    let map = std::fs::read_to_string(folder.path().join("checks.map")).unwrap();
    // "Archive member included to satisfy reference by file (symbol)": each member stands at the beginning of a line.
    let (members, _) = map.split_once("Discarded input sections").unwrap();
    let members = || {
        members
            .lines()
            .filter(|line| line.contains(".a(") && !line.starts_with(' '))
            .filter_map(|line| line.split(' ').next()?.rsplit('/').next())
    };
    for member in ["libc.a(lib_a-memcpy", "libgcc.a(_arm_muldivdf3", "libm.a("] {
        assert!(
            members().any(|each| each.starts_with(member)),
            "{member}: {map}"
        );
    }
    let ours: Vec<&str> = members()
        .filter(|member| member.contains("mesh_damper"))
        .collect();
    assert_eq!(ours, ["libmesh_damper.a(mesh_damper.o)"]);
}
