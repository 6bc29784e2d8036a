//! The memory that a trace takes for each row of its recording: the difference of two runs, so that the memory of the command itself
//! does not count. Also tests the command that measures it.
#![cfg(target_os = "linux")]

use std::process::Command;

use mesh_damper_trials::size::{BYTES_PER_ROW, Measured, Motion, measure};

use crate::command::hil;

/// Far enough apart for the memory of the rows to exceed the memory that an allocator keeps in reserve.
const ROWS: [usize; 2] = [50_000, 450_000];

#[track_caller]
fn takes_no_more_than_it_may(motion: Motion) {
    let folder = tempfile::tempdir().unwrap();
    let hil = env!("CARGO_BIN_EXE_hil");
    let [few, many]: [Measured; 2] =
        ROWS.map(|rows| measure(hil, folder.path(), motion, rows).unwrap());
    let more = many.memory.saturating_sub(few.memory);
    let rows = (many.rows - few.rows) as u64;
    assert!(
        (20 * rows..BYTES_PER_ROW * rows).contains(&more),
        "{} bytes a row: {few:?}, {many:?}",
        more / rows
    );
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn of_blocks_of_sines() {
    takes_no_more_than_it_may(Motion::Sines);
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn of_a_random_motion() {
    takes_no_more_than_it_may(Motion::Random);
}

#[test]
fn the_study_writes_what_it_measures() {
    let root = tempfile::tempdir().unwrap();
    let arguments = "study size --rows 1e4 --json size.json --picture size.svg";
    let said = hil(root.path(), &arguments.split(' ').collect::<Vec<_>>());
    let read = |name: &str| std::fs::read_to_string(root.path().join(name)).unwrap();
    let all: Vec<Measured> = serde_json::from_str(&read("size.json")).unwrap();
    assert_eq!(
        all.iter().map(|one| one.motion).collect::<Vec<_>>(),
        Motion::ALL
    );
    for one in all {
        assert!((8_000..12_000).contains(&one.rows), "{one:?}");
        // A build with debug information takes more memory; twice the limit would indicate a wrong unit.
        assert!(
            (4 << 20..2 * one.memory_limit()).contains(&one.memory),
            "{one:?}"
        );
        assert!(said.contains(&format!("| {} |", one.rows)), "{said}");
    }
    assert!(read("size.svg").starts_with("<svg"));
    for rows in ["5", "1e9", "many"] {
        let mut refused = Command::new(env!("CARGO_BIN_EXE_hil"));
        let output = refused.args(["study", "size", "--rows", rows]).output();
        assert_eq!(output.unwrap().status.code(), Some(2), "{rows}");
    }
}
