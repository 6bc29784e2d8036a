//! Columns of control inputs.

use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_recording::check_consistency;
use mesh_damper_tables::files::Reading;

fn read(header: &str, cell: impl Fn(usize) -> String) -> Recording {
    let mut text = format!("time_s,displacement_mm,force_kN,{header}\n");
    for row in 0..200 {
        let y = 0.1 * (0.1 * row as f64).sin();
        text += &format!("{},{y},{},{}\n", 0.01 * row as f64, 2.0 * y, cell(row));
    }
    Recording::from_bytes(Path::new("rec.csv"), text.into_bytes()).unwrap()
}

fn only(recording: &Recording) -> &[f64] {
    let [control] = recording.controls.as_slice() else {
        panic!("one: {}", recording.controls.len())
    };
    assert_eq!(control.name, "current_A");
    &control.values
}

/// A logger that writes an input only when it changes: first in row 5, then in a row whose force is missing.
#[test]
fn an_empty_cell_is_as_the_one_before() {
    let mut text = String::from("time_s,displacement_mm,force_kN,current_A\n");
    for row in 0..200 {
        let y = 0.1 * (0.1 * f64::from(row)).sin();
        let force = if row == 50 {
            String::new()
        } else {
            (2.0 * y).to_string()
        };
        let current = match row {
            5 => "0.5",
            50 => "1",
            _ => "",
        };
        text += &format!("{},{y},{force},{current}\n", 0.01 * f64::from(row));
    }
    let recording = Recording::from_bytes(Path::new("rec.csv"), text.into_bytes()).unwrap();
    let current = only(&recording);
    assert_eq!(current.len(), 199);
    // Before its first value, the input is taken as equal to it.
    assert!(current[..50].iter().all(|&value| value == 0.5));
    assert!(current[50..].iter().all(|&value| value == 1.0));
}

/// A word in the column shows that it is a column of another kind. An empty column shows nothing.
#[test]
fn what_is_no_number_is_no_control() {
    let word = |row: usize| if row == 7 { "off".into() } else { "1".into() };
    assert!(read("current_A", word).controls.is_empty());
    assert!(read("current_A", |_| String::new()).controls.is_empty());
    assert!(read("force_command_V", |_| "1".into()).controls.is_empty());
}

#[test]
fn it_is_written_and_read_again_and_goes_by_lines() {
    let step = |row: usize| if row < 100 { 0.0 } else { 1.0 };
    let recording = read("current_A", |row| step(row).to_string());
    let bytes = recording.to_file(Path::new("again.csv")).unwrap();
    let again = Recording::from_bytes(Path::new("again.csv"), bytes).unwrap();
    assert_eq!(again.controls, recording.controls);
    let uniform = recording.uniform().unwrap();
    let values = &uniform.controls[0].values;
    assert_eq!(values.len(), uniform.len());
    assert!(values.iter().all(|value| (0.0..=1.0).contains(value)));
}

/// The same motion under two currents gives two forces, even if their means are equal.
#[test]
fn two_forces_of_one_motion_under_two_inputs_are_no_contradiction() {
    let under = |order: [f64; 2], factor: f64| {
        let mut recording = read("current_A", |row| order[row / 100].to_string());
        recording
            .force
            .iter_mut()
            .for_each(|force| *force *= factor);
        recording
    };
    let (rising, falling) = (under([0.0, 1.0], 1.0), under([1.0, 0.0], 3.0));
    assert!(check_consistency(&[&rising, &falling]).is_ok());
    let same = under([0.0, 1.0], 3.0);
    assert!(check_consistency(&[&rising, &same]).is_err());
}

/// A text of another program, whose columns after the force are `names` in `units`.
fn foreign(names: &str, units: &str, options: [&[(&str, &str)]; 2]) -> Result<Recording, String> {
    let mut text = format!("Time;Weg;Kraft;{names}\n[s];[mm];[N];{units}\n");
    let more = names.split(';').count();
    for row in 0..200 {
        let y = (0.1 * f64::from(row)).sin();
        text += &format!("{:.2};{y:.4};{:.4}", 0.01 * f64::from(row), 20.0 * y);
        text += &";1.5".repeat(more);
        text += "\n";
    }
    let pairs = |pairs: &[(&str, &str)]| {
        let owned = pairs
            .iter()
            .map(|&(of, what)| (of.to_owned(), what.to_owned()));
        owned.collect()
    };
    let [channels, units] = options.map(pairs);
    let reading = Reading {
        channels,
        units,
        ..Reading::default()
    };
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("rig.txt");
    std::fs::write(&path, text).unwrap();
    Recording::read_as(&path, &reading).map_err(|error| error.to_string())
}

/// A length that stays where it was set is an input, as in the noise of its sensor; one that moves belongs to the motion.
#[test]
fn a_length_that_is_set_is_an_input() {
    let noise = |row: usize| 0.002 * (17.0 * row as f64).sin();
    let y = |row: usize| 0.1 * (0.1 * row as f64).sin();
    let read = read(
        "Slider [mm],preload_um,lvdt_2_mm,carriage_m,predicted_gap_mm",
        |row| {
            format!(
                "{},-150,{},{},1",
                12.5 + noise(row),
                0.5 * y(row),
                3.0 + 1e-3 * y(row)
            )
        },
    );
    let found: Vec<(&str, f64)> = (read.controls.iter())
        .map(|control| (control.name.as_str(), control.values[0]))
        .collect();
    // The carriage moves by much less than a hundredth of where it stands, but with the displacement.
    let [("slider_mm", slider), ("preload_um", preload)] = found[..] else {
        panic!("{found:?}")
    };
    assert!((slider - 12.5).abs() < 1e-3, "{slider}");
    assert_eq!(preload, -150.0);
    assert!(read.controls.iter().all(|control| !control.changes()));
}

/// Recordings at two settings of a slider do not contradict each other; at one setting they do.
#[test]
fn a_length_that_was_set_otherwise_explains_another_force() {
    let at = |slider: f64, factor: f64| {
        let mut recording = read("slider_mm", |_| slider.to_string());
        recording
            .force
            .iter_mut()
            .for_each(|force| *force *= factor);
        recording
    };
    assert!(check_consistency(&[&at(10.0, 1.0), &at(25.0, 1.5)]).is_ok());
    let error = check_consistency(&[&at(10.0, 1.0), &at(10.0, 1.5)]).unwrap_err();
    assert!(error.remedy.contains("slider_mm"), "{error}");
}

fn names(recording: &Recording) -> Vec<&str> {
    let controls = recording.controls.iter();
    controls.map(|control| control.name.as_str()).collect()
}

#[test]
fn a_column_that_may_be_another_unit_makes_its_like_ambiguous() {
    let read = foreign("Current A;Current B", "[mA];[mA]", [&[], &[]]).unwrap();
    assert!(read.controls.is_empty(), "{:?}", names(&read));
    let said = read.guesses().join("\n");
    for part in [
        "2 columns could be the control input current_mA: \"Current A\", \"Current B\"",
        "column \"Current A\" could be the control input current, but its unit is not clear: A beside mA",
    ] {
        assert!(said.contains(part), "{said}");
    }
    // Letters of phases and ports beside one unit are none.
    let read = foreign("I_A;I_B;Pressure A", "[A];[A];[bar]", [&[], &[]]).unwrap();
    assert_eq!(names(&read), ["pressure_bar"]);
}

#[test]
fn the_unit_of_a_column_that_the_user_names_is_asked_for_if_it_is_not_clear() {
    let channel: &[(&str, &str)] = &[("current", "Current (mA)")];
    let error = foreign("Current (mA)", "[A]", [channel, &[]]).unwrap_err();
    assert!(error.contains("is not clear: mA beside A"), "{error}");
    assert!(
        error.contains("such as --unit current=A or --unit current=mA"),
        "{error}"
    );
    let kiloampere: &[(&str, &str)] = &[("current", "kA")];
    let error = foreign("Current (mA)", "[A]", [channel, kiloampere]).unwrap_err();
    assert!(error.contains("current cannot be \"kA\""), "{error}");
    let read = foreign("Current (mA)", "[A]", [channel, &[("current", "A")]]).unwrap();
    assert_eq!(names(&read), ["current_A"]);
    let said = "column \"Current (mA)\" is read in A, as --unit says; it says mA beside A";
    assert!(
        read.guesses().iter().any(|note| note == said),
        "{:?}",
        read.guesses()
    );
    // The same column twice is one input.
    let twice = [channel, channel].concat();
    let read = foreign("Current (mA)", "[mA]", [&twice, &[]]).unwrap();
    assert_eq!(names(&read), ["current_mA"]);
}

#[test]
fn a_second_sensor_whose_letter_is_no_unit_stays_a_question() {
    let mut text = String::from("Time;Nominal displacement;probe_A;Kraft\n[s];[mm];[mm];[N]\n");
    for row in 0..200 {
        let y = (0.1 * f64::from(row)).sin();
        text += &format!(
            "{:.2};{y:.4};{y:.4};{:.4}\n",
            0.01 * f64::from(row),
            20.0 * y
        );
    }
    let error = Recording::from_bytes(Path::new("rig.txt"), text.into_bytes()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("2 columns could be the displacement"),
        "{error}"
    );
}
