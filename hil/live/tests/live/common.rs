//! Functions shared by the tests.

use std::io::Write as _;
use std::process::Command;
use std::sync::Mutex;

/// Whether `program` is installed. Without it, the tests that need it are skipped with a message; if `CI` is `true`, no test may be
/// skipped.
pub fn has(program: &str, package: &str) -> bool {
    if Command::new(program).arg("--help").output().is_ok() {
        return true;
    }
    let missing = format!("there is no {program}: apt-get install {package}");
    assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{missing}");
    static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let mut said = SAID.lock().unwrap();
    if !said.contains(&missing) {
        // Written past the test harness, which hides the output of passing tests.
        let written = writeln!(std::io::stderr(), "left out, {missing}");
        written.unwrap();
        said.push(missing);
    }
    false
}
