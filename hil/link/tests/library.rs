//! The crate is a library: everything that an image needs is in `firmware/`, so that it reaches no other firmware.

use std::process::Command;

use serde_json::Value;

/// The root package, as cargo describes it.
fn root_package() -> Value {
    let output = Command::new(env!("CARGO"))
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .args(["metadata", "--no-deps", "--offline", "--format-version=1"])
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let root = packages.iter().find(|p| p["name"] == "mesh-damper");
    root.unwrap().clone()
}

#[test]
fn the_crate_has_no_build_script_no_binaries_and_no_feature_of_an_image() {
    let root = root_package();
    for target in root["targets"].as_array().unwrap() {
        let kind = target["kind"][0].as_str().unwrap();
        assert!(["lib", "test"].contains(&kind), "{target}");
    }
    let features = root["features"].as_object().unwrap();
    let names: Vec<&String> = features.keys().collect();
    let expected = ["async", "defmt", "fixed-point", "serde", "std"];
    assert_eq!(names, expected);
}
