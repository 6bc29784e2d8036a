//! The models and the picture that `hil amplitude-free` writes.

use mesh_damper_model::file::ModelFile;

use crate::command::{hil, words};
use crate::refusal::refuses;

#[test]
fn the_command_leaves_models_that_are_models() {
    let root = tempfile::tempdir().unwrap();
    let line = "amplitude-free --frequencies 1 --out free --json -";
    let output = hil(root.path(), &words(line));
    let json: serde_json::Value = serde_json::from_str(&output).unwrap();
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
    let zero = words("amplitude-free --frequencies 0");
    refuses(root.path(), &zero, &["0 Hz is outside 0.1…100"]);
}
