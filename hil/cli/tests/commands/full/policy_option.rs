//! Decision thresholds in a policy file.

use crate::refusal::refuses;

#[test]
fn a_number_that_there_is_not_is_refused_with_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("numbers.json");
    std::fs::write(file, r#"{"identify": {"select": {"beem": 2}}}"#).unwrap();
    refuses(
        directory.path(),
        &["blind", "--seeds", "1", "--policy", "numbers.json"],
        &["identify.select.beem", "docs/numbers.md"],
    );
}
