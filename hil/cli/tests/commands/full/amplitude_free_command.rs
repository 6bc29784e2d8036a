//! The models and the picture that `hil amplitude-free` writes.

use std::process::Command;

use mesh_damper_model::file::ModelFile;

#[test]
fn the_command_leaves_models_that_are_models() {
    let root = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_hil"))
            .arg("amplitude-free")
            .args(arguments)
            .current_dir(root.path())
            .output()
            .unwrap()
    };
    let output = run(&["--frequencies", "1", "--out", "free", "--json", "-"]);
    assert!(output.status.success(), "{output:?}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    crate::full::schema_command::is_as_its_schema_says("amplitude-free", &json);
    assert_eq!(json["densities"].as_array().unwrap().len(), 5);
    for density in ["2.0", "2.5", "3.0", "3.5", "4.0"] {
        let path = root.path().join(format!("free/model-{density}.json"));
        let file = ModelFile::read(path).unwrap();
        // One node: the amplitude makes no difference.
        assert_eq!(file.model().law.len(), 1);
        assert_eq!(file.fitted_range().displacement, [-0.25, 0.25]);
    }
    let picture = std::fs::read_to_string(root.path().join("free/loops-1Hz.svg")).unwrap();
    assert!(picture.contains("3.5 g/cm³"));
    let refused = run(&["--frequencies", "0"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.contains("0 Hz is outside 0.1…100"), "{said}");
}
