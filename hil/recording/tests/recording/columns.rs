//! Columns in memory give the same recording as a file with the same rows.

use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_recording::input::InputSignal;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::files::{GivenColumn, Needs, Reading, Unmarked};
use mesh_damper_tables::units::Units;
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
                // The header is the first line of the file.
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
        endless.starts_with("a test: sample 9, column force_N: \"inf\" is not finite"),
        "{endless}"
    );
    let lost = refused(|columns| columns[0].1[4] = f64::NAN);
    assert!(
        lost.starts_with("a test: sample 5, column time_s: the cell is empty or \"NaN\""),
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
    let plain = Reading::default();
    let motion =
        Recording::of_columns_for("a motion", columns.clone(), &plain, &Needs::motion()).unwrap();
    assert_eq!(motion.force, vec![0.0; 60]);
    let (_, time) = columns.remove(0);
    let drive = [("time_s", time), ("force_N", force.clone())];
    let signal =
        InputSignal::of_columns("a shaker", drive, Channel::Force, &plain, Unmarked::Refused)
            .unwrap();
    assert!((signal.tick - 0.01).abs() < 1e-12);
    assert!(
        signal
            .values
            .iter()
            .zip(&force)
            .all(|(kn, n)| (kn - 1e-3 * n).abs() < 1e-12)
    );
}

/// The columns of [`columns`] under other names.
fn named(names: [&'static str; 4]) -> Columns {
    let values = columns(60).into_iter().map(|(_, values)| values);
    names.into_iter().zip(values).collect()
}

#[test]
fn names_of_a_lab_are_taken_as_in_a_file_and_guesses_are_said() {
    for names in [
        ["Zeit [s]", "Weg (mm)", "Kraft / N", "Spulenstrom [A]"],
        ["Time (s)", "Stroke [inch]", "Force [kip]", "current_A"],
        ["Time (s)", "Disp [mm]", "Force 1 [kN]", "Force 2 [kN]"],
    ] {
        let columns = named(names);
        match both(&columns) {
            [Ok(read), Ok(made)] => {
                assert_eq!(channels(&read), channels(&made), "{names:?}");
                // For the file, the guesses also contain its separator.
                for guess in made.guesses() {
                    assert!(read.guesses().contains(guess), "{guess}");
                }
                assert!(made.guesses().len() >= 3, "{:?}", made.guesses());
            }
            [Err(read), Err(made)] => {
                assert_eq!(read, made);
                assert!(made.starts_with("2 columns could be the force"), "{made}");
            }
            [read, made] => panic!("{:?} {:?}", read.map(|_| ()), made.map(|_| ())),
        }
    }
}

#[test]
fn a_unit_that_nothing_says_is_as_the_caller_has_it() {
    let columns = named(["time", "displacement", "force", "Speed"]);
    let made = |unmarked| {
        let needs = Needs {
            unmarked,
            ..Needs::default()
        };
        let reading = Reading::default();
        Recording::of_columns_for("a test", columns.clone(), &reading, &needs)
    };
    let refused = made(Unmarked::Refused).unwrap_err().to_string();
    assert!(refused.contains("the name carries no unit"), "{refused}");
    let said = made(Unmarked::Stated(Units::SI)).unwrap();
    assert_eq!(said.assumed(), None);
    assert_eq!(said.units.force, Units::SI.force);
    assert_eq!(said.displacement[3], 1e3 * columns[1].1[3]);
    let assumed = made(Unmarked::Assumed(Units::default())).unwrap();
    assert_eq!(assumed.units, Units::default());
    let words = "s for column \"time\", mm for column \"displacement\", kN for column \"force\"";
    assert!(assumed.assumed().unwrap().contains(words));
    // A channel that is not needed is not read on an assumption.
    assert_eq!(assumed.velocity, None);
}

#[test]
fn a_unit_that_contradicts_the_name_is_refused_of_our_own_names_and_else_said() {
    let reading = Reading {
        units: vec![("force".into(), "kN".into())],
        ..Reading::default()
    };
    let own = Recording::of_columns("a test", columns(60), &reading).unwrap_err();
    assert!(
        own.to_string()
            .contains("its name says N, and --unit force=kN says kN"),
        "{own}"
    );
    let foreign = named(["time_s", "displacement_mm", "Kraft [N]", "current_A"]);
    let foreign = Recording::of_columns("a test", foreign, &reading).unwrap();
    assert_eq!(foreign.units.force.symbol, "kN");
    assert!(foreign.guesses()[0].contains("is read in kN, as --unit says, not in N"));
}

#[test]
fn a_control_input_that_is_needed_must_be_there() {
    let made = |columns: Columns, inputs: &[&str]| {
        let needs = Needs {
            inputs: Some(inputs.iter().map(|&input| input.to_owned()).collect()),
            ..Needs::default()
        };
        Recording::of_columns_for("a test", columns, &Reading::default(), &needs)
    };
    let two = || {
        let mut columns = columns(60);
        columns[4] = ("Spannung [V]", vec![1.0; 60]);
        columns
    };
    let both = made(two(), &["voltage_V", "current_A"]).unwrap();
    let names: Vec<&str> = both
        .controls
        .iter()
        .map(|each| each.name.as_str())
        .collect();
    assert_eq!(names, ["voltage_V", "current_A"]);
    let one = made(two(), &["current_A"]).unwrap();
    assert_eq!((one.controls.len(), one.guesses().len()), (1, 0));
    for (columns, input, words) in [
        (
            columns(60),
            "voltage_V",
            "there is no control input voltage_V; found \"time_s\"",
        ),
        (
            named(["time_s", "displacement_mm", "force_N", "Druck A [bar]"])
                .into_iter()
                .chain([("Druck B [bar]", vec![1.0; 60])])
                .collect(),
            "pressure_bar",
            "2 columns could be the control input pressure_bar: \"Druck A [bar]\", \"Druck B [bar]\"; \
             say which: --channel pressure='Druck A [bar]'",
        ),
        (
            columns(60),
            "remark",
            "\"remark\" is not the name of a control input",
        ),
        (
            named(["time_s", "displacement_mm", "force_N", "current_A"]),
            "current_A",
            "the control input current_A holds no number",
        ),
    ] {
        let mut columns = columns;
        if input == "current_A" {
            columns[3].1.fill(f64::NAN);
        }
        let refused = made(columns, &[input]).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
    }
}

#[test]
fn words_are_no_channel_and_dates_of_the_table_are_its_times() {
    let given = |name: &str, values: Result<Vec<f64>, String>| {
        let mut given = GivenColumn::from((name, Vec::new()));
        given.values = values;
        given
    };
    let [(_, time), (_, displacement), (_, force), ..] = &columns(60)[..] else {
        unreachable!()
    };
    let words = || Err(String::from("holds words"));
    let mut index = given("index", Ok(time.clone()));
    index.column.unit = Some("s".into());
    (index.column.is_time, index.column.is_stamp) = (true, true);
    let rest = [
        given("displacement_mm", Ok(displacement.clone())),
        given("Force [N]", words()),
        given("Kraft [N]", Ok(force.clone())),
    ];
    let columns = std::iter::once(index.clone()).chain(rest.clone());
    let made = Recording::of_columns("a test", columns, &Reading::default()).unwrap();
    assert_eq!((&made.time, made.guesses().len()), (time, 1));
    // A column of seconds is more reliable than dates.
    let late: Vec<f64> = time.iter().map(|time| time + 5.0).collect();
    let columns = [index, given("time_s", Ok(late.clone()))]
        .into_iter()
        .chain(rest);
    let made = Recording::of_columns("a test", columns, &Reading::default()).unwrap();
    assert_eq!(made.time, late);
    let columns = [
        given("time_s", Ok(late)),
        given("displacement_mm", Ok(displacement.clone())),
        given("force_N", words()),
    ];
    let refused = Recording::of_columns("a test", columns, &Reading::default()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "a test: column force_N: holds words; give a column of numbers"
    );
}
