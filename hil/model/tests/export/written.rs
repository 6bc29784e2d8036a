//! What an earlier program wrote is read as it was meant.

use std::fs;
use std::path::Path;

use mesh_damper::pack::Identity;
use mesh_damper_model::file::ModelFile;
use serde_json::Value;

/// Model files that commit 3f3244e2 wrote: five traced ones, each named by the effect in it, and one with a table, with control inputs
/// and with two effects of one family. Nothing in them is lost, added or changed.
#[test]
fn model_files_of_an_earlier_program_load() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/written");
    let mut read = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let written: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        let file = ModelFile::read(&path).unwrap();
        assert_eq!(serde_json::to_value(&file).unwrap(), written);
        // Packs that were exported from it name the model by this.
        if path.ends_with("table-and-controls.json") {
            let identity = Identity([67, 25, 245, 225, 187, 36, 9, 21]);
            assert_eq!(file.identity(), identity);
        }
        read += 1;
    }
    assert_eq!(read, 6);
}
