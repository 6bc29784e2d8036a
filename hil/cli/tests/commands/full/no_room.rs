//! Full disks, files that must not grow, read-only folders: one message, and no partial file.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Output;

use crate::command::shell;

/// `script` with separate file systems; `None`, with a message, if they cannot be mounted.
fn with_mounts(directory: &Path, script: &str) -> Option<Output> {
    const UNSHARE: &str = "exec unshare --user --map-root-user --mount sh -c";
    let tried = shell(
        "sh",
        directory,
        &format!("{UNSHARE} 'mount -t tmpfs tmpfs {}'", directory.display()),
    );
    if !tried.status.success() {
        // Past the test harness, which hides the output of passing tests.
        let said = writeln!(
            std::io::stderr(),
            "left out, no file system may be mounted here"
        );
        said.unwrap();
        return None;
    }
    Some(shell("sh", directory, &format!("{UNSHARE} '{script}'")))
}

#[track_caller]
fn said_once(output: &Output, what: &str) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.starts_with("error: ") && said.contains(what), "{said}");
}

const RUN: &str = "\"$HIL\" run --blocks 0.1:5:40";

#[test]
fn a_full_disk_is_said_and_what_was_recorded_stays() {
    let root = tempfile::tempdir().unwrap();
    // The recording so far has 60 KiB or more.
    let script = format!(
        "mount -t tmpfs -o size=32k tmpfs . && cd \"$PWD\" && {RUN}; code=$?; ls -A run-out; exit $code"
    );
    let Some(output) = with_mounts(root.path(), &script) else {
        return;
    };
    said_once(&output, "no space left on the device; make room");
    assert_eq!(output.stdout, b"recording.partial.csv\n");
}

#[test]
fn where_one_file_has_no_room_none_is_written() {
    let root = tempfile::tempdir().unwrap();
    let script = format!(
        "mkdir full && mount -t tmpfs -o size=8k tmpfs full && {RUN} --json full/big.json; \
         code=$?; ls -A full run-out; exit $code"
    );
    let Some(output) = with_mounts(root.path(), &script) else {
        return;
    };
    said_once(
        &output,
        "full/big.json: cannot write it: no space left on the device; make room",
    );
    // No file is lost.
    let listed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(listed, "full:\n\nrun-out:\nrecording.partial.csv\n");
}

#[test]
fn a_read_only_file_system_is_said() {
    let root = tempfile::tempdir().unwrap();
    let script = format!("mount -t tmpfs -o ro tmpfs . && cd \"$PWD\" && {RUN}");
    let Some(output) = with_mounts(root.path(), &script) else {
        return;
    };
    said_once(
        &output,
        "the file system is read-only; name another directory",
    );
}

#[test]
fn a_folder_without_permission_is_said() {
    use std::os::unix::fs::PermissionsExt as _;
    let root = tempfile::tempdir().unwrap();
    let closed = root.path().join("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(closed.join("tried"), "").is_ok() {
        // A user with all permissions is never refused.
        writeln!(
            std::io::stderr(),
            "left out, permissions do not bind this user"
        )
        .unwrap();
        return;
    }
    let output = shell("sh", root.path(), &format!("{RUN} --out closed/run-out"));
    said_once(
        &output,
        "permission denied; check the permissions of the file and its directory",
    );
    assert_eq!(fs::read_dir(&closed).unwrap().count(), 0);
}

#[test]
fn a_file_that_may_not_grow_is_said() {
    let root = tempfile::tempdir().unwrap();
    // In blocks of 512 bytes. The signal for the limit is ignored, which children of the shell inherit.
    let output = shell(
        "sh",
        root.path(),
        &format!("trap '' XFSZ; ulimit -f 8; {RUN}"),
    );
    said_once(
        &output,
        "the file would exceed the largest size that the system allows",
    );
}

#[test]
fn a_full_device_is_said() {
    let root = tempfile::tempdir().unwrap();
    // The recorded data exist, so the folder accepts another run.
    for to in ["--json /dev/full", "--json - > /dev/full"] {
        let output = shell("sh", root.path(), &format!("{RUN} --out out {to}"));
        said_once(&output, "no space left on the device");
        assert!(root.path().join("out/recording.csv.gz").is_file());
    }
}

/// Standard output on a full device fails like a file.
#[test]
fn standard_output_that_takes_nothing_is_said() {
    let root = tempfile::tempdir().unwrap();
    let made = shell("sh", root.path(), &format!("{RUN} --out made"));
    assert_eq!(made.status.code(), Some(0));
    for command in [
        "characterize made/recording.csv.gz --dynamic",
        "design --stiffness 4 --loss-factor 0.3",
    ] {
        let output = shell(
            "sh",
            root.path(),
            &format!("\"$HIL\" {command} > /dev/full"),
        );
        said_once(&output, "no space left on the device");
    }
    // A user who closes standard output wants no text. A user who requests the JSON there gets an error.
    let output = shell("sh", root.path(), &format!("{RUN} --json - >&-"));
    said_once(&output, "standard output is closed");
    let output = shell("sh", root.path(), &format!("{RUN} --out said >&-"));
    assert_eq!(output.status.code(), Some(0));
    // A reader of one line may close the pipe.
    let output = shell("sh", root.path(), &format!("{RUN} --out piped | head -n 1"));
    assert_eq!(output.status.code(), Some(0));
    assert!(
        output.stderr.is_empty(),
        "{:?}",
        String::from_utf8_lossy(&output.stderr)
    );
}
