//! `hil run --on image`: its message if the compiler or the emulator is missing, and the end of the emulator.

use crate::full::emulated;
use mesh_damper_link::image::{Board, FIRMWARE};

/// The one line of a `hil run --on image` that finds neither compiler nor emulator other than the given one.
fn said_where_missing(compiler: &std::ffi::OsStr) -> String {
    let root = tempfile::tempdir().unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_hil"))
        .args(["run", "--on", "image"])
        .current_dir(root.path())
        .env("PATH", root.path())
        .env("RUSTC", compiler)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 0);
    said
}

#[test]
fn what_is_missing_is_said_in_one_line_with_how_to_get_it() {
    let said = said_where_missing("no-compiler".as_ref());
    assert!(
        said.contains("rustup target add thumbv7em-none-eabihf"),
        "{said}"
    );
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let sysroot = std::process::Command::new(rustc)
        .args(["--print", "sysroot"])
        .output();
    let sysroot = String::from_utf8(sysroot.unwrap().stdout).unwrap();
    let sysroot = std::path::Path::new(sysroot.trim());
    let target = sysroot.join("lib/rustlib").join(Board::Mps2An386.target());
    if target.is_dir() {
        let said = said_where_missing(sysroot.join("bin/rustc").as_os_str());
        assert!(said.contains("apt-get install qemu-system-arm"), "{said}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_emulator_ends_with_the_harness_even_when_that_is_killed() {
    use crate::command::wait_for;
    use crate::full::interrupted_run::emulator_of;

    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let root = tempfile::tempdir().unwrap();
    let mut harness = std::process::Command::new(env!("CARGO_BIN_EXE_hil"))
        .args(["run", "--on", "image", "--blocks", "0.1:1:1000"])
        .current_dir(root.path())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let emulator = emulator_of(&harness);
    harness.kill().unwrap();
    harness.wait().unwrap();
    wait_for("the emulator outlived the harness", || {
        (!emulated::lives(emulator)).then_some(())
    });
}
