//! The memory that a trace takes for each row of its recording: a bound of one run over another, so that what the command takes
//! besides does not count.
#![cfg(target_os = "linux")]

use mesh_damper_studies::size::{BYTES_PER_ROW, Measured, Motion, measure};

/// So many rows more make what is kept of each of them stand out of what an allocator keeps for later.
const ROWS: [usize; 2] = [50_000, 250_000];

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
fn of_blocks_of_sines() {
    takes_no_more_than_it_may(Motion::Sines);
}

#[test]
fn of_a_random_motion() {
    takes_no_more_than_it_may(Motion::Random);
}
