//! Manifests as they are where only a part of the repository is.

/// The packages that are unpacked.
const MEMBERS: &str = r#"members = ["bindings/fmu", "firmware", "firmware/mps2-an386", "hil/model", "hil/output", "hil/recording", "hil/tables"]"#;

/// `manifest` without what it says of packages that are not there: the members of the workspace that are none here, and what tests
/// alone depend on.
pub fn trimmed(manifest: &str) -> String {
    let mut is_of_tests = false;
    let mut lines = Vec::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            is_of_tests = line.starts_with("[dev-dependencies");
        }
        if is_of_tests || line.starts_with("default-members = ") {
            continue;
        }
        lines.push(if line.starts_with("members = ") {
            MEMBERS
        } else {
            line
        });
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_not_named() {
        let manifest = "[package]\nname = \"a\"\n\n[dev-dependencies]\nb.workspace = true\n\n[workspace]\n\
            default-members = [\".\"]\nmembers = [\"hil/*\"]\nresolver = \"3\"\n";
        let expected =
            format!("[package]\nname = \"a\"\n\n[workspace]\n{MEMBERS}\nresolver = \"3\"\n");
        assert_eq!(trimmed(manifest), expected);
    }
}
