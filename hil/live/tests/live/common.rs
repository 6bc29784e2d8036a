//! What the tests share.

use std::io::Write as _;
use std::process::Command;
use std::sync::Mutex;

/// Whether `program` is there. Without it what needs it is left out, and a line says so; where `CI` is `true` nothing may be left out.
pub fn has(program: &str, package: &str) -> bool {
    if Command::new(program).arg("--help").output().is_ok() {
        return true;
    }
    let missing = format!("there is no {program}: apt-get install {package}");
    assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{missing}");
    static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let mut said = SAID.lock().unwrap();
    if !said.contains(&missing) {
        // Past the tests' harness, which keeps what passing tests print to itself.
        let written = writeln!(std::io::stderr(), "left out, {missing}");
        written.unwrap();
        said.push(missing);
    }
    false
}
