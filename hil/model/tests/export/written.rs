//! What an earlier version wrote is read as it was meant.

use std::fs;
use std::path::Path;

use mesh_damper_model::file::ModelFile;
use serde_json::Value;

/// Model files that commit 3f3244e2 wrote, each named by the effect in it.
#[test]
fn model_files_of_an_earlier_version_load() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/written");
    let mut read = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let written: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        let model = ModelFile::read(&path).unwrap().model();
        let [effect] = &model.effects[..] else {
            panic!("{}: one effect was written", path.display());
        };
        assert_eq!(path.file_stem().unwrap(), effect.family.name());
        let of_effect = &written["effects"][0]["parameters"];
        for (name, value) in &effect.parameters {
            assert_eq!(of_effect[name].as_f64(), Some(*value), "{name}");
        }
        for (node, written) in model.law.iter().zip(written["law"].as_array().unwrap()) {
            for (name, value) in [("k1", node.k1), ("k3", node.k3), ("alpha", node.alpha)] {
                assert_eq!(written[name].as_f64(), Some(value), "{name}");
            }
        }
        read += 1;
    }
    assert_eq!(read, 5);
}
