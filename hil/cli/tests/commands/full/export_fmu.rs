//! `hil export --format fmu`: the contents of the archive, and the refusals.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read as _;
use std::path::Path;

use mesh_damper_fmu::contents::Contents;
use mesh_damper_fmu::{IDENTIFIER, MARK};
use zip::ZipArchive;

use crate::command;
use crate::command::words;
use crate::refusal::refuses;

const MODEL: &str = r#"{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.1, "k1": 8.0, "k3": 30.0, "c": 0.1, "alpha": 0.3 },
           { "amplitude": 0.2, "k1": 7.0, "k3": 31.0, "c": 0.1, "alpha": 0.3 } ],
  "effects": [ { "family": "stick_slip", "parameters": { "stiffness": 1.2, "slip_limit": 0.03 } } ],
  "fitted_range": { "displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3] } }"#;

const EXPORT: [&str; 7] = [
    "export",
    "--model",
    "model.json",
    "--format",
    "fmu",
    "--tick-rate",
    "12000",
];

/// A folder with the model, and a file that stands in for a library of each platform.
fn directory() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    let library = |name: &str, head: &[u8], mark: &str| {
        fs::write(root.path().join(name), [head, mark.as_bytes()].concat()).unwrap();
    };
    library("mac.dylib", b"\xcf\xfa\xed\xfe", MARK);
    library("other-mac.dylib", b"\xcf\xfa\xed\xfe", MARK);
    library("other.so", b"\x7fELF\x02\x01", "another library");
    library("text.so", b"a text", MARK);
    root
}

/// The files of an archive. All have the same fixed time stamp.
fn unpacked(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut archive = ZipArchive::new(File::open(path).unwrap()).unwrap();
    (0..archive.len())
        .map(|place| {
            let mut file = archive.by_index(place).unwrap();
            assert_eq!(file.last_modified(), Some(zip::DateTime::default()));
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).unwrap();
            (file.name().unwrap().into_owned(), bytes)
        })
        .collect()
}

#[test]
fn an_fmu_holds_the_model_the_description_and_the_library() {
    let root = directory();
    let arguments = words("--library mac.dylib --revision 7 --json export.json");
    let said = command::hil(
        root.path(),
        &[&EXPORT[..], &["--out", "mount.fmu"], &arguments].concat(),
    );
    let files = unpacked(&root.path().join("mount.fmu"));
    let mac = format!("binaries/darwin64/{IDENTIFIER}.dylib");
    assert_eq!(
        files[&mac],
        fs::read(root.path().join("mac.dylib")).unwrap()
    );
    // The library of this platform, which was built next to the command.
    let own = files
        .keys()
        .filter(|name| name.starts_with("binaries/") && **name != mac);
    let own: Vec<&String> = own.collect();
    assert!(own.len() == 1 && files[own[0]].len() > 100_000, "{own:?}");

    // The library accepts the packed resources.
    let resources = tempfile::tempdir().unwrap();
    for (name, bytes) in &files {
        if let Some(name) = name.strip_prefix("resources/") {
            fs::write(resources.path().join(name), bytes).unwrap();
        }
    }
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(root.path().join("export.json")).unwrap()).unwrap();
    let guid = json["guid"].as_str().unwrap();
    let contents = Contents::read(resources.path(), guid).unwrap();
    assert_eq!(contents.settings.tick_rate, 12e3);
    assert_eq!(contents.settings.amplitude, Some(0.2));
    assert_eq!(
        (contents.settings.name.as_str(), contents.settings.revision),
        ("mount", 7)
    );
    let description = String::from_utf8(files["modelDescription.xml"].clone()).unwrap();
    assert!(description.contains(guid) && description.contains("modelName=\"mount\""));
    assert_eq!(json["format"], "fmu");
    let platforms = json["platforms"].as_array().unwrap();
    assert!(
        platforms.len() == 2 && platforms.contains(&"darwin64".into()),
        "{platforms:?}"
    );
    assert!(said.contains("with steps that are multiples of"), "{said}");
}

#[test]
fn the_same_model_gives_the_same_bytes_and_another_another_guid() {
    let root = directory();
    let export = |out: &str, more: &[&str]| {
        command::hil(
            root.path(),
            &[&EXPORT[..], &["--name", "mount", "--out", out], more].concat(),
        );
        fs::read(root.path().join(out)).unwrap()
    };
    let first = export("first.fmu", &[]);
    assert!(first == export("again.fmu", &[]));
    let guid = |name: &str| {
        let files = unpacked(&root.path().join(name));
        let text = String::from_utf8(files["modelDescription.xml"].clone()).unwrap();
        text.split("guid=\"").nth(1).unwrap()[..38].to_owned()
    };
    export("amplitude.fmu", &["--amplitude", "0.1"]);
    assert_ne!(guid("first.fmu"), guid("amplitude.fmu"));
}

#[test]
fn what_is_no_library_is_refused() {
    let root = directory();
    for (more, said) in [
        (
            "--library other.so",
            &[
                "other.so: not the library of mesh-damper-fmu",
                "cargo build --release -p mesh-damper-fmu",
            ][..],
        ),
        ("--library text.so", &["text.so: no library for linux64"]),
        (
            "--library none.so",
            &["none.so: cannot read it: does not exist"],
        ),
        (
            "--library mac.dylib --library other-mac.dylib",
            &["other-mac.dylib: a second library for darwin64"],
        ),
    ] {
        let arguments: Vec<&str> = EXPORT
            .into_iter()
            .chain(["--out", "p"])
            .chain(more.split(' '))
            .collect();
        refuses(root.path(), &arguments, said);
    }
    let pack =
        "export --model model.json --format pack --tick-rate 1e4 --out p --library mac.dylib";
    let arguments: Vec<&str> = pack.split(' ').collect();
    refuses(
        root.path(),
        &arguments,
        &[
            "--library mac.dylib: only an FMU carries a library",
            "--format fmu",
        ],
    );
}

/// If the command is alone, without cargo, its message explains how to get the library.
#[test]
fn a_command_without_its_library_says_how_to_build_it() {
    let root = directory();
    let alone = root.path().join("hil-alone");
    fs::copy(env!("CARGO_BIN_EXE_hil"), &alone).unwrap();
    let run = |more: &[&str]| {
        std::process::Command::new(&alone)
            .args(EXPORT)
            .args(["--out", "mount.fmu"])
            .args(more)
            .current_dir(root.path())
            // No repository surrounds it, and no part of it is built.
            .env_remove("CARGO_MANIFEST_DIR")
            .env("XDG_CACHE_HOME", root.path().join("cache"))
            .env("CARGO", root.path().join("none"))
            .output()
            .unwrap()
    };
    let refused = run(&[]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(
        said.contains("cargo does not start")
            && said.contains("cargo build --release -p mesh-damper-fmu"),
        "{said}"
    );
    assert!(!root.path().join("mount.fmu").exists());
    assert!(run(&["--library", "mac.dylib"]).status.success());
}
