//! Files with several tables: which one is read is asked for, never chosen, and what was found about the file is said of each.

use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_tables::files::{self, Reading, Source};
use mesh_damper_tables::read_limit::ReadLimit;

/// A group of a JSON file: 60 samples from `start` s on, whose force is called `force`.
fn group(start: f64, force: &str) -> String {
    let list = |value: &dyn Fn(f64) -> f64| -> String {
        let values: Vec<String> = (0..60).map(|n| value(f64::from(n)).to_string()).collect();
        values.join(",")
    };
    let time = list(&|n| start + 0.005 * n);
    let y = list(&|n| (0.3 * n).sin());
    let forces = list(&|n| 2.0 * (0.3 * n).sin());
    format!("{{\"time_s\":[{time}],\"displacement_mm\":[{y}],\"{force}\":[{forces}]}}")
}

fn read(text: &str, reading: &Reading) -> Result<Recording, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.json");
    std::fs::write(&path, text).unwrap();
    Recording::read_as(&path, reading).map_err(|error| error.to_string())
}

fn of_table(name: &str) -> Reading {
    Reading {
        table: Some(name.into()),
        ..Reading::default()
    }
}

#[test]
fn a_table_that_an_answer_would_complete_is_asked_for() {
    let whole = group(0.0, "force_kN");
    let unmarked = group(7.0, "force");
    let text = format!("{{\"run1\":{whole},\"run2\":{unmarked}}}");
    let question = read(&text, &Reading::default()).unwrap_err();
    for words in ["run1", "run2", "--table"] {
        assert!(question.contains(words), "{question}");
    }
    assert_eq!(read(&text, &of_table("run1")).unwrap().time[0], 0.0);
    let question = read(&text, &of_table("run2")).unwrap_err();
    assert!(question.contains("--unit force="), "{question}");
    // A table without a force is no recording.
    let spare = group(7.0, "Oil level");
    let text = format!("{{\"run1\":{whole},\"spare\":{spare}}}");
    assert_eq!(read(&text, &Reading::default()).unwrap().time[0], 0.0);
}

#[test]
fn a_group_that_is_called_unit_is_a_table() {
    let [one, other] = [0.0, 7.0].map(|start| group(start, "force_kN"));
    let text = format!("{{\"Unit\":{one},\"Reference\":{other}}}");
    let question = read(&text, &Reading::default()).unwrap_err();
    assert!(question.contains("2 tables hold a recording"), "{question}");
}

#[test]
fn an_error_in_the_values_names_the_table() {
    let whole = group(0.0, "force_kN");
    let backwards = group(7.0, "force_kN").replacen("7.01,", "6.01,", 1);
    let text = format!("{{\"run1\":{whole},\"run2\":{backwards}}}");
    let message = read(&text, &of_table("run2")).unwrap_err();
    assert!(message.contains("table \"run2\": "), "{message}");
}

#[test]
fn a_note_about_the_file_is_about_each_of_its_tables() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables/tests/formats/two_rates.tdms");
    // A TDMS file grows by segments, here by one that was cut.
    let segment = std::fs::read(&path).unwrap();
    let bytes = [&segment[..], &segment[..segment.len() - 8]].concat();
    let source = Source::of(&path, bytes.as_slice(), ReadLimit::default());
    let (_, file) = files::opened(source.unwrap(), &Reading::default()).unwrap();
    assert!(file.tables().len() > 1);
    for table in file.tables() {
        let is_cut = |note: &String| note.contains("its end was cut");
        assert!(table.guesses.iter().any(is_cut), "{table:?}");
    }
}

#[test]
fn a_control_input_with_two_units_is_none_until_one_is_given() {
    let current: Vec<String> = (0..60).map(|n| (n % 2).to_string()).collect();
    let current = current.join(",");
    let whole = group(0.0, "force_kN");
    let inside = whole.trim_start_matches('{').trim_end_matches('}');
    let controls = |name: &str, units: &str, reading: &Reading| {
        let text = format!("{{{inside},\"{name}\":[{current}],{units}}}");
        let recording = read(&text, reading).unwrap();
        let controls = recording.controls.iter().map(|each| each.name.clone());
        (controls.collect::<Vec<_>>(), recording.guesses().join("\n"))
    };
    let plain = Reading::default();
    let once = "\"units\":{\"Current\":\"A\"}";
    assert_eq!(controls("Current", once, &plain).0, ["current_A"]);
    for (name, units) in [
        (
            "Current",
            format!("{once},\"Units\":{{\"Current\":\"mA\"}}"),
        ),
        ("Current (mA)", once.replace("Current", "Current (mA)")),
        (
            "coil_current_mA",
            once.replace("Current", "coil_current_mA"),
        ),
    ] {
        let (found, guesses) = controls(name, &units, &plain);
        assert!(found.is_empty(), "{name}: {found:?}");
        assert!(guesses.contains("its unit is not clear: "), "{guesses}");
        assert!(
            guesses.contains("current=mA") && guesses.contains("so it is not read"),
            "{guesses}"
        );
        let given = Reading {
            channels: vec![("current".into(), name.into())],
            units: vec![("current".into(), "mA".into())],
            ..Reading::default()
        };
        assert_eq!(controls(name, &units, &given).0, ["current_mA"], "{name}");
    }
}
