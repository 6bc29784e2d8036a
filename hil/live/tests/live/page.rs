//! The page's own tests, run by Node.

use std::path::Path;
use std::process::Command;

use crate::common::has;

#[test]
fn the_scripts_of_the_page_pass_their_tests() {
    if !has("node", "nodejs") {
        return;
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
    let files = |folder: &str| -> Vec<_> {
        let entries = std::fs::read_dir(page.join(folder)).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        paths
            .filter(|path| path.extension().is_some_and(|end| end == "js"))
            .collect()
    };
    let tested = Command::new("node")
        .arg("--test")
        .args(files("test"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&tested.stdout).into_owned();
    assert!(tested.status.success(), "{said}");
    // Older versions of Node succeed even if they find no test.
    assert!(said.contains("a pause freezes what is shown"), "{said}");
    for script in files("js") {
        let checked = Command::new("node")
            .arg("--check")
            .arg(&script)
            .output()
            .unwrap();
        assert!(checked.status.success(), "{}", script.display());
    }
}
