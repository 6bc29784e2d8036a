//! Recordings of columns in memory are those of a file of the same rows.

use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_recording::faults::Channel;
use mesh_damper_recording::files::Reading;
use mesh_damper_recording::input::InputSignal;
use proptest::prelude::*;

type Columns = Vec<(&'static str, Vec<f64>)>;

/// A sine with its force in N, and a current that is not known at every row.
fn columns(rows: usize) -> Columns {
    let time: Vec<f64> = (0..rows).map(|row| 0.01 * row as f64).collect();
    let displacement: Vec<f64> = time.iter().map(|t| (6.3 * t).sin()).collect();
    let force = displacement.iter().map(|y| 8000.0 * y).collect();
    let current = (0..rows).map(|row| if row % 7 == 3 { row as f64 } else { f64::NAN });
    vec![
        ("time_s", time),
        ("displacement_mm", displacement),
        ("force_N", force),
        ("current_A", current.collect()),
        ("remark", vec![f64::NAN; rows]),
    ]
}

/// The same as the bytes of a file, a missing value as a blank cell.
fn file(columns: &Columns) -> Vec<u8> {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let mut text = names.join(",") + "\n";
    for row in 0..columns[0].1.len() {
        let cells = columns.iter().map(|(_, values)| match values[row] {
            value if value.is_nan() => String::new(),
            value => value.to_string(),
        });
        text += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    text.into_bytes()
}

fn both(columns: &Columns) -> [Result<Recording, String>; 2] {
    let read = Recording::from_bytes(Path::new("a test"), file(columns));
    let made = Recording::of_columns("a test", columns.clone(), &Reading::default());
    [read, made].map(|result| result.map_err(|error| error.problem))
}

fn channels(recording: &Recording) -> impl PartialEq + std::fmt::Debug + use<> {
    (
        (recording.time.clone(), recording.displacement.clone()),
        (recording.force.clone(), recording.controls.clone()),
        (recording.units, recording.faults().to_vec()),
    )
}

proptest! {
    #[test]
    fn missing_and_repeated_rows_are_taken_as_in_a_file(
        missing in proptest::collection::vec((0usize..60, 1usize..3), 0..40),
        repeated in proptest::collection::vec(1usize..60, 0..4),
    ) {
        let mut columns = columns(60);
        for row in repeated {
            for (_, values) in &mut columns[..3] {
                values[row] = values[row - 1];
            }
        }
        for (row, column) in missing {
            columns[column].1[row] = f64::NAN;
        }
        match both(&columns) {
            [Ok(read), Ok(made)] => {
                prop_assert_eq!(channels(&read), channels(&made));
                // The line of the header is the first of the file.
                let rows: Vec<usize> = read.rows().map(|line| line - 1).collect();
                prop_assert_eq!(rows, made.rows().collect::<Vec<_>>());
            }
            [Err(_), Err(_)] => {}
            [read, made] => prop_assert!(false, "{:?} {:?}", read.map(|_| ()), made.map(|_| ())),
        }
    }
}

#[test]
fn what_is_wrong_is_said_with_its_row_and_column() {
    let refused = |change: fn(&mut Columns)| {
        let mut columns = columns(60);
        change(&mut columns);
        Recording::of_columns("a test", columns, &Reading::default())
            .unwrap_err()
            .to_string()
    };
    let endless = refused(|columns| columns[2].1[8] = f64::INFINITY);
    assert!(
        endless.starts_with("a test: line 9, column force_N: \"inf\" is not finite"),
        "{endless}"
    );
    let lost = refused(|columns| columns[0].1[4] = f64::NAN);
    assert!(
        lost.starts_with("a test: line 5, column time_s: the cell is empty or \"NaN\""),
        "{lost}"
    );
    let short = refused(|columns| columns[1].1.truncate(3));
    assert!(
        short.starts_with("a test: column displacement_mm: 3 rows, and time_s has 60"),
        "{short}"
    );
    let none = refused(|columns| drop(columns.remove(2)));
    assert!(none.contains("there is no force column"), "{none}");
    let unit = refused(|columns| columns[2].0 = "force_stone");
    assert!(unit.contains("unknown unit \"stone\""), "{unit}");
    let empty = Recording::of_columns("a test", Columns::new(), &Reading::default()).unwrap_err();
    assert!(
        empty.to_string().contains("there is no time column"),
        "{empty}"
    );
}

#[test]
fn a_motion_needs_no_force_and_a_drive_nothing_else() {
    let mut columns = columns(60);
    let (_, force) = columns.remove(2);
    let motion =
        Recording::motion_of_columns("a motion", columns.clone(), &Reading::default()).unwrap();
    assert_eq!(motion.force, vec![0.0; 60]);
    let (_, time) = columns.remove(0);
    let drive = [("time_s", time), ("force_N", force.clone())];
    let signal =
        InputSignal::of_columns("a shaker", drive, Channel::Force, &Reading::default()).unwrap();
    assert!((signal.tick - 0.01).abs() < 1e-12);
    assert!(
        signal
            .values
            .iter()
            .zip(&force)
            .all(|(kn, n)| (kn - 1e-3 * n).abs() < 1e-12)
    );
}
