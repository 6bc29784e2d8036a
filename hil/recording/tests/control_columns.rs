//! Columns of control inputs.

use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_recording::check_consistency;

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
