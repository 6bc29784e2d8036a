//! A written recording reads back equal in every bit.

use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_recording::write::Prediction;
use mesh_damper_tables::units;
use mesh_damper_tables::write::{WriteAs, table};

fn recording() -> Recording {
    let time: Vec<f64> = (0..300).map(|i| 1e-3 * f64::from(i)).collect();
    let displacement: Vec<f64> = time.iter().map(|t| 0.1 * (31.4 * t).sin()).collect();
    let force = displacement
        .iter()
        .map(|y| 8.0 * y + 0.1 * y.powi(3))
        .collect();
    let current = vec![0.25; time.len()];
    Recording::new("made", time, displacement, force)
        .unwrap()
        .with_control("current_A", current)
        .unwrap()
        .with_comment("specimen: D1 at 20 °C")
        .with_comment("a second line")
}

fn again(recording: &Recording, name: &str) -> Recording {
    let path = Path::new(name);
    Recording::from_bytes(path, recording.to_file(path).unwrap()).unwrap()
}

/// Formats that are written and read.
const NAMES: [&str; 2] = ["a.mat", "a.parquet"];

#[test]
fn a_recording_comes_back_bit_by_bit() {
    let recording = recording();
    for name in NAMES {
        let again = again(&recording, name);
        assert_eq!(again.time, recording.time, "{name}");
        assert_eq!(again.displacement, recording.displacement, "{name}");
        assert_eq!(again.force, recording.force, "{name}");
        assert_eq!(again.controls, recording.controls, "{name}");
        assert_eq!(again.comments, recording.comments, "{name}");
        assert_eq!(again.units, recording.units, "{name}");
        assert!(again.guesses().is_empty(), "{name}: {:?}", again.guesses());
    }
}

#[test]
fn a_text_is_written_with_all_its_columns_of_numbers() {
    let row = |n: u32| format!("{n},{}.5,{}e-1,{n},x\n", n % 3, n % 5);
    let rows: String = (0..20).map(row).collect();
    let text = format!("# specimen: D1\ntime_ms,displacement_mm,force_N,cycle,state\n{rows}");
    let read = Recording::from_bytes(Path::new("a.csv"), text.clone().into_bytes()).unwrap();
    assert_eq!(read.to_file(Path::new("b.csv")).unwrap(), text.as_bytes());
    for name in NAMES {
        let again = again(&read, name);
        assert_eq!(again.time, read.time, "{name}");
        assert_eq!(again.force, read.force, "{name}");
        assert_eq!(again.units, read.units, "{name}");
        let reading = Default::default();
        let file = tempfile::Builder::new().suffix(name).tempfile().unwrap();
        std::fs::write(&file, read.to_file(Path::new(name)).unwrap()).unwrap();
        let (_, opened) = mesh_damper_tables::files::open(file.path(), &reading).unwrap();
        let columns = &opened.tables()[0].columns;
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(
            names,
            ["time_ms", "displacement_mm", "force_N", "cycle"],
            "{name}"
        );
        assert_eq!(columns[2].unit.as_deref(), Some("N"), "{name}");
    }
}

/// A header, cells and a comment that a spreadsheet would compute are written with an apostrophe, and read without it.
#[test]
fn what_a_spreadsheet_would_compute_is_guarded_in_a_text() {
    let header = "time_s,displacement_mm,force_kN,\"=HYPERLINK(\"\"http://a\"\")\",@load,'+x";
    let row = |n: u32| format!("{n},-0.{n},-{n}.5,=1+{n},-{n},a;-b\n");
    let rows: String = (0..20).map(row).collect();
    // For a spreadsheet that reads commas, the comment has a second cell.
    let text = format!("# specimen: D1,=2+3\n{header}\n{rows}");
    let read = Recording::from_bytes(Path::new("a.csv"), text.into_bytes()).unwrap();
    let written = read.to_file(Path::new("b.csv")).unwrap();
    let text = String::from_utf8(written.clone()).unwrap();
    let lines: Vec<&str> = text.lines().take(4).collect();
    let [comment, header, _, second] = lines[..] else {
        panic!("{text}")
    };
    assert_eq!(comment, "# specimen: D1,'=2+3");
    // The last name was guarded in the file.
    let guarded = "time_s,displacement_mm,force_kN,\"'=HYPERLINK(\"\"http://a\"\")\",'@load,'+x";
    assert_eq!(header, guarded);
    assert_eq!(second, "1,-0.1,-1.5,'=1+1,-1,a;'-b");
    let again = Recording::from_bytes(Path::new("b.csv"), written.clone()).unwrap();
    assert_eq!(again.comments, ["specimen: D1,=2+3"]);
    assert_eq!(again.force, read.force);
    assert_eq!(again.to_file(Path::new("b.csv")).unwrap(), written);
    let names = |bytes| columns("c.csv", bytes).into_iter().map(|(name, _)| name);
    let names: Vec<String> = names(written).skip(3).collect();
    assert_eq!(names, ["=HYPERLINK(\"http://a\")", "@load", "+x"]);
}

/// The names of the columns of a file, each with its unit.
fn columns(name: &str, bytes: Vec<u8>) -> Vec<(String, Option<String>)> {
    let file = tempfile::Builder::new().suffix(name).tempfile().unwrap();
    std::fs::write(&file, bytes).unwrap();
    let (_, opened) = mesh_damper_tables::files::open(file.path(), &Default::default()).unwrap();
    let each = opened.tables()[0].columns.iter();
    each.map(|column| (column.name.clone(), column.unit.clone()))
        .collect()
}

#[test]
fn what_was_found_out_of_a_foreign_text_need_not_be_found_out_again() {
    let rows = |separator: char| -> String {
        let row = |n: u32| format!("{n},{}.5,{}e-1,{},{n}\n", n % 3, n % 5, n % 2);
        let rows: String = (0..20).map(row).collect();
        rows.replace(',', &separator.to_string())
    };
    let quoted: Vec<String> = [
        "Running Time (ms)",
        "8800 (0,1):Position [mm]",
        "8800 (0,1):Load [kN]",
        "Coil current [A]",
        "Cycle [-]",
    ]
    .map(|name| format!("\"{name}\""))
    .to_vec();
    for separator in [',', ';', '\t'] {
        let header = quoted.join(&separator.to_string());
        let text = format!("{header}\n{}", rows(separator));
        let read = Recording::from_bytes(Path::new("lab.csv"), text.into_bytes()).unwrap();
        assert!(!read.guesses().is_empty());
        for name in NAMES.into_iter().chain(["a.csv"]) {
            let again = again(&read, name);
            assert_eq!(again.time, read.time, "{name}");
            assert_eq!(again.force, read.force, "{name}");
            assert_eq!(again.units, read.units, "{name}");
            assert_eq!(again.controls, read.controls, "{name}");
            assert!(again.guesses().is_empty(), "{name}: {:?}", again.guesses());
            let said = columns(name, read.to_file(Path::new(name)).unwrap());
            let ours = [
                ("time_ms", "ms"),
                ("displacement_mm", "mm"),
                ("force_kN", "kN"),
                ("current_A", "A"),
            ];
            for ((name_of, unit_of), (own, unit)) in said.iter().zip(ours) {
                assert_eq!(name_of, own, "{name}");
                assert!(
                    name == "a.csv" || unit_of.as_deref() == Some(unit),
                    "{name} {own}"
                );
            }
        }
    }
}

#[test]
fn no_column_is_lost_by_its_name() {
    let rows: String = (0..20)
        .map(|n| format!("{n},{}.5,{n},{n},1,2\n", n % 3))
        .collect();
    let text = format!("time_s,displacement_mm,force_kN,A 1,A-1,units\n{rows}");
    let read = Recording::from_bytes(Path::new("a.csv"), text.into_bytes()).unwrap();
    let said = columns("a.mat", read.to_file(Path::new("a.mat")).unwrap());
    let names: Vec<&str> = said.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[3..], ["A_1", "A_1_2", "units_2"]);
    // A column that the user assigned to no channel.
    let rows: String = (0..20)
        .map(|n| format!("{n},{}.5,{n},{}\n", n % 3, n % 7))
        .collect();
    let text = format!("time_s,displacement_mm,force_kN,Load cell\n{rows}");
    let file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
    std::fs::write(&file, text).unwrap();
    let reading = mesh_damper_tables::files::Reading {
        channels: vec![("force".into(), "Load cell".into())],
        units: vec![("force".into(), "kN".into())],
        ..Default::default()
    };
    let read = Recording::read_as(file.path(), &reading).unwrap();
    for name in ["a.csv", "a.mat"] {
        assert_eq!(again(&read, name).force, read.force, "{name}");
    }
}

#[test]
fn a_prediction_has_the_units_of_the_recording() {
    let mut recording = recording();
    recording.units.force = units::FORCE[1];
    let force: Vec<f64> = recording.force.iter().map(|force| force + 0.5).collect();
    let prediction = Prediction {
        band: vec![0.002; force.len()],
        beyond: vec![0.0; force.len()],
        force: force.clone(),
    };
    for name in NAMES {
        let path = Path::new(name);
        let bytes = recording
            .to_file_with_prediction(path, &prediction)
            .unwrap();
        let file = tempfile::Builder::new().suffix(name).tempfile().unwrap();
        std::fs::write(&file, bytes).unwrap();
        let reading = mesh_damper_tables::files::Reading {
            channels: vec![("force".into(), "predicted_force_N".into())],
            units: vec![("force".into(), "N".into())],
            ..Default::default()
        };
        let predicted = Recording::read_as(file.path(), &reading).unwrap();
        for (read, force) in predicted.force.iter().zip(&force) {
            assert!(
                (read - force).abs() < 1e-15 * force.abs().max(1.0),
                "{name}"
            );
        }
    }
}

/// An error of the library that writes a format is no empty file.
#[test]
fn a_table_that_a_format_does_not_hold_is_refused() {
    let path = Path::new("a.parquet");
    let columns = |second: &[f64]| [("time_s", vec![0.0, 1.0]), ("force_kN", second.to_vec())];
    let written = table(path, &[], &columns(&[1.0, 2.0])).unwrap();
    assert!(written.starts_with(b"PAR1"));
    let refused = table(path, &[], &columns(&[1.0])).unwrap_err().to_string();
    assert!(
        refused.starts_with("a.parquet: not to be written in its format: "),
        "{refused}"
    );
}

#[test]
fn the_ending_of_a_name_says_the_format() {
    for (name, format) in [
        ("a.csv", WriteAs::Csv),
        ("A.CSV", WriteAs::Csv),
        ("a.csv.gz", WriteAs::CsvGz),
        ("run.2/a.mat", WriteAs::Mat),
        ("-", WriteAs::Csv),
        ("/dev/stdout", WriteAs::Csv),
    ] {
        assert_eq!(WriteAs::of(Path::new(name)), Ok(format), "{name}");
    }
    for name in ["a.xlsx", "a.gz", "a.h5", "mat.txt", "a."] {
        let error = WriteAs::of(Path::new(name)).unwrap_err().to_string();
        assert!(
            error.contains("of no format") && error.contains(".csv.gz"),
            "{error}"
        );
    }
    for (format, word) in WriteAs::ALL {
        assert_eq!(format.to_string(), word);
    }
    assert_eq!("csv.gz".parse(), Ok(WriteAs::CsvGz));
    assert!("xlsx".parse::<WriteAs>().is_err());
}
