//! Which columns are chosen, which are missing, and which are refused.

use super::*;
use crate::files::Column;

fn table(names: &[&str]) -> Table {
    let column = |name: &&str| Column {
        name: (*name).into(),
        is_numeric: true,
        ..Column::default()
    };
    Table {
        columns: names.iter().map(column).collect(),
        ..Table::default()
    }
}

fn chosen(names: &[&str], reading: &Reading) -> Result<Chosen, String> {
    let chosen = choose("a.csv", &[table(names)], reading, &Needs::default());
    chosen.map_err(|error| error.to_string())
}

fn pair(of: &str, what: &str) -> (String, String) {
    (of.into(), what.into())
}

#[test]
fn equal_candidates_are_asked_for_and_lesser_ones_are_not() {
    let plain = Reading::default();
    let columns = |names: &[&str]| {
        let chosen = chosen(names, &plain).unwrap();
        chosen
            .used
            .iter()
            .map(|used| used.column)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        columns(&["Time [s]", "x [mm]", "Disp [mm]", "Load [kN]"]),
        [0, 2, 3]
    );
    assert_eq!(
        columns(&[
            "Time [s]",
            "Disp [mm]",
            "Axial Displacement Command [mm]",
            "Load [kN]"
        ]),
        [0, 1, 3]
    );
    assert_eq!(
        columns(&[
            "Cycle time [s]",
            "Time [s]",
            "Disp [mm]",
            "Load [MPa]",
            "Force [kN]"
        ]),
        [1, 2, 4]
    );
    for (names, option) in [
        (
            &["Time [s]", "Disp [mm]", "Force 1 [kN]", "Force 2 [kN]"][..],
            "--channel force='Force 1 [kN]'",
        ),
        (
            &["Time [s]", "Stroke [mm]", "Disp [mm]", "Load [kN]"],
            "--channel displacement='Disp [mm]'",
        ),
        (
            &["Time [s]", "Disp [mm]", "Pull [kN]"],
            "--channel force='Pull [kN]'",
        ),
        (&["Time [s]", "Disp", "Load [kN]"], "--unit displacement=mm"),
        (&["Disp [mm]", "Load [kN]"], "--rate"),
    ] {
        let error = chosen(names, &plain).unwrap_err();
        assert!(error.contains(option), "{error}");
    }
}

#[test]
fn what_the_user_says_counts_and_a_word_of_no_use_is_refused() {
    let said = Reading {
        channels: vec![pair("force", "force 2 [kN]"), pair("valve", "Ch 4")],
        units: vec![pair("valve", "V")],
        ..Reading::default()
    };
    let names = [
        "Time [s]",
        "Disp [mm]",
        "Force 1 [kN]",
        "Force 2 [kN]",
        "Ch 4",
    ];
    let found = chosen(&names, &said).unwrap();
    assert_eq!(found.used[2].column, 3);
    assert_eq!(found.controls[0].name, "valve_V");
    let wrong = Reading {
        units: vec![pair("froce", "N")],
        ..Reading::default()
    };
    let error = chosen(&names, &wrong).unwrap_err();
    assert!(
        error.contains("--unit froce=N") && error.contains("is not a channel"),
        "{error}"
    );
    let wrong = Reading {
        channels: vec![pair("force", "Kraft")],
        ..Reading::default()
    };
    let error = chosen(&names, &wrong).unwrap_err();
    assert!(error.contains("there is no column \"Kraft\""), "{error}");
    // The word would be a control input, which the force depends on.
    for (word, remedy) in [
        ("Kraft", "--channel force='Force 1 [kN]'"),
        ("load", "--channel force='Force 1 [kN]'"),
        ("weg", "--channel displacement='Force 1 [kN]'"),
    ] {
        let wrong = Reading {
            channels: vec![pair(word, "Force 1 [kN]")],
            ..Reading::default()
        };
        let error = chosen(&names, &wrong).unwrap_err();
        assert!(error.contains(remedy), "{error}");
    }
}

#[test]
fn a_unit_that_is_not_understood_is_asked_for_and_said() {
    let plain = Reading::default();
    let error = |names: &[&str]| chosen(names, &plain).unwrap_err();
    // No option states a factor, so that none is offered.
    let scaled = error(&["Time [s]", "Weg [1/100 mm]", "Kraft [kN]"]);
    assert!(scaled.contains("has a factor"), "{scaled}");
    assert!(!scaled.contains("--unit"), "{scaled}");
    for (force, offered) in [
        ("KRAFT [MN]", "--unit force=MN or --unit force=mN"),
        ("Load (kg)", "--unit force=kgf;"),
        ("Load [mm]", "mm is no unit of a force"),
    ] {
        let error = error(&["Time [s]", "Disp [mm]", force]);
        assert!(error.contains(offered), "{error}");
    }
    let said = |force: &str, unit: &str| Reading {
        channels: vec![pair("force", force)],
        units: vec![pair("force", unit)],
        ..Reading::default()
    };
    let names = ["Time [s]", "Disp [mm]", "Load (kg)"];
    let read = chosen(&names, &said("Load (kg)", "kgf")).unwrap();
    let note = "its own unit, \"kg\", is not understood";
    assert!(read.guesses.join("\n").contains(note), "{:?}", read.guesses);
    // The message is about the wrong option, not about the column.
    let wrong = chosen(&names, &said("Load (kg)", "mm")).unwrap_err();
    assert!(
        wrong.starts_with("--unit force=mm: mm is no unit of a force"),
        "{wrong}"
    );
}

#[test]
fn a_raw_signal_in_volts_is_no_second_force() {
    let plain = Reading::default();
    let read = chosen(
        &["time_s", "displacement_mm", "force_kN", "force_V"],
        &plain,
    );
    assert_eq!(read.unwrap().used[2].column, 2);
    let both = chosen(
        &["time_s", "displacement_mm", "force_kN", "force_N"],
        &plain,
    );
    assert!(both.unwrap_err().contains("is also a force"));
    let alone = chosen(&["time_s", "displacement_mm", "force_V"], &plain).unwrap_err();
    assert!(alone.contains("V is no unit of a force"), "{alone}");
}

#[test]
fn a_rate_in_place_of_times_is_said() {
    let said = Reading {
        rate: Some(100.0),
        ..Reading::default()
    };
    let read = chosen(&["Zeit [s]", "Disp [mm]", "Force [kN]"], &said).unwrap();
    let note = "the times in column \"Zeit [s]\" are not used, because --rate replaces them";
    assert!(
        read.guesses.iter().any(|guess| guess == note),
        "{:?}",
        read.guesses
    );
    let said = Reading {
        table: Some("x".into()),
        ..Reading::default()
    };
    let error = chosen(&["Zeit [s]", "Disp [mm]", "Force [kN]"], &said).unwrap_err();
    assert!(error.contains("leave out --table"), "{error}");
}

#[test]
fn a_unit_in_other_letters_is_said() {
    let names = ["Time [s]", "Disp", "Force [kN]"];
    let guesses = |unit: &str| {
        let said = Reading {
            units: vec![pair("displacement", unit)],
            ..Reading::default()
        };
        chosen(&names, &said).unwrap().guesses.join("\n")
    };
    let note = "unit \"M\" of displacement is read as m";
    assert!(guesses("M").contains(note), "{}", guesses("M"));
    for unit in ["m", "metre", "µm"] {
        assert!(!guesses(unit).contains("is read as"), "{}", guesses(unit));
    }
}
