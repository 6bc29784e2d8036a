//! Recordings that are written and read again.

use std::fs;
use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_recording::faults::{ChannelFault, ChannelFaultKind};
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::files::Reading;
use mesh_damper_tables::units;
use proptest::prelude::*;

fn unit_of(units: &[units::Unit], index: usize) -> &units::Unit {
    &units[index % units.len()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the units and the packing, reading returns the values that were written, to the nine digits of the file.
    #[test]
    fn comes_back_in_any_unit(
        picks in prop::array::uniform4(0_usize..16),
        gz: bool,
        measured: bool,
        channels in prop::collection::vec((-50.0..50.0, -10.0..10.0, -300.0..300.0, -40.0..90.0), 8..40),
    ) {
        let time: Vec<f64> = (0..channels.len()).map(|i| 12.0 + i as f64 * 0.002).collect();
        let pick = |of: fn(&(f64, f64, f64, f64)) -> f64| channels.iter().map(of).collect::<Vec<f64>>();
        let mut recording =
            Recording::new("made", time, pick(|c| c.0), pick(|c| c.1)).unwrap().with_comment("specimen: x");
        if measured {
            recording = recording.with_velocity(pick(|c| c.2)).unwrap();
            recording = recording.with_temperature(pick(|c| c.3)).unwrap();
        }
        recording.units.time = *unit_of(units::TIME, picks[0]);
        recording.units.displacement = *unit_of(units::DISPLACEMENT, picks[1]);
        recording.units.force = *unit_of(units::FORCE, picks[2]);
        recording.units.velocity = *unit_of(units::VELOCITY, picks[3]);

        let root = tempfile::tempdir().unwrap();
        let path = root.path().join(if gz { "a.csv.gz" } else { "a.csv" });
        let bytes = recording.to_file(&path).unwrap();
        fs::write(&path, &bytes).unwrap();
        let read = Recording::read(&path).unwrap();
        prop_assert_eq!(&read.comments, &recording.comments);
        prop_assert_eq!(read.units.force, recording.units.force);
        // Rounding to nine significant digits: at most half a unit of the ninth.
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 5e-9 * a.abs() + 1e-300);
        prop_assert!(close(&recording.time, &read.time));
        prop_assert!(close(&recording.displacement, &read.displacement));
        prop_assert!(close(&recording.force, &read.force));
        prop_assert_eq!(read.velocity.is_some(), measured);
        if measured {
            prop_assert!(close(recording.velocity.as_ref().unwrap(), read.velocity.as_ref().unwrap()));
            prop_assert!(close(recording.temperature.as_ref().unwrap(), read.temperature.as_ref().unwrap()));
        }
        // A recording that was read is written back unchanged.
        prop_assert_eq!(read.to_file(&path).unwrap(), bytes);
    }

    /// Bytes of any kind are read or refused, without a panic and without a message of two lines.
    #[test]
    fn any_bytes_are_refused_in_one_line(
        head in prop::sample::select(vec![
            "", "# c\n", "time_s,displacement_mm,force_kN\n", "time_s,force_N\n", "\u{1f}",
        ]),
        body in "[0-9.,eE+\\-\n\r #\"a-z]{0,200}",
        tail in prop::collection::vec(any::<u8>(), 0..8),
    ) {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.csv");
        fs::write(&path, [head.as_bytes(), body.as_bytes(), &tail].concat()).unwrap();
        if let Err(error) = Recording::read(&path) {
            prop_assert_eq!(error.to_string().lines().count(), 1);
        }
    }
}

#[test]
fn each_unit_is_what_it_says() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("a.csv");
    for (column, factor) in [
        ("displacement_mm", 1.0),
        ("displacement_m", 1e3),
        ("displacement_um", 1e-3),
        ("displacement_in", 25.4),
    ] {
        let rows: String = (0..8).map(|i| format!("{i},{i},{i}\n")).collect();
        fs::write(
            &path,
            format!("\u{feff}time_ms,{column},force_kip\r\n{rows}"),
        )
        .unwrap();
        let read = Recording::read(&path).unwrap();
        assert_eq!(read.displacement[2], 2.0 * factor);
        assert_eq!(read.time[3], 0.003);
        assert!((read.force[1] - 4.448_221_615_260_5).abs() < 1e-12);
        assert!((read.sample_period() - 0.001).abs() < 1e-15);
    }
}

#[test]
fn other_columns_are_kept_and_ignored() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("a.csv");
    let rows: String = (0..8).map(|i| format!("x{i},{i},{i},,{i},{i}\n")).collect();
    let text =
        format!("label,time_s,displacement_mm,force_command_kN,force_N,velocity_mm/s\n{rows}");
    fs::write(&path, &text).unwrap();
    let read = Recording::read(&path).unwrap();
    assert_eq!(read.force[7], 0.007);
    assert_eq!(read.velocity.as_ref().unwrap()[7], 7.0);
    assert_eq!(read.to_file(&path).unwrap(), text.as_bytes());
}

fn read(text: &str) -> Recording {
    Recording::from_bytes("a.csv".as_ref(), text.into()).unwrap()
}

/// Found by fuzzing: each of these came back as another recording after it was written.
#[test]
fn what_looks_like_a_comment_stays_what_it_is() {
    let rows: String = (0..9).map(|n| format!("{n},0.{n},1,a\n")).collect();
    let quoted_header = read(&format!(
        "\"#time\",time_s,displacement_mm,force_kN\n{}",
        rows.replace(",a", "")
            .lines()
            .map(|row| format!("x,{row}\n"))
            .collect::<String>()
    ));
    let in_a_cell = read(&format!(
        "# device: rig\ntime_s,displacement_mm,force_kN,note\n{}",
        rows.replacen(",a\n", ",\"a\n# specimen: none\"\n", 1)
    ));
    assert_eq!(in_a_cell.comments, ["device: rig"]);
    let lone_return = read(&format!(
        "# speci\rmen\ntime_s,displacement_mm,force_kN,note\n{rows}"
    ));
    assert_eq!(lone_return.comments, ["speci men"]);
    for recording in [quoted_header, in_a_cell, lone_return] {
        let bytes = recording.to_file("a.csv".as_ref()).unwrap();
        assert_eq!(
            Recording::from_bytes("a.csv".as_ref(), bytes).unwrap(),
            recording
        );
    }
}

#[test]
fn a_row_that_is_written_twice_is_read_once() {
    let row = |index: usize| format!("{},{},{}\n", 0.01 * index as f64, index % 7, index % 5);
    let rows = |twice: &[usize]| -> String {
        let each = (0..60).map(|index| row(index).repeat(1 + usize::from(twice.contains(&index))));
        each.collect()
    };
    let header = "time_s,displacement_mm,force_kN\n";
    let clean = read(&format!("{header}{}", rows(&[])));
    assert!(clean.faults().is_empty());
    let spoilt = read(&format!("{header}{}", rows(&[0, 20, 59])));
    assert_eq!(spoilt.time, clean.time);
    assert_eq!(spoilt.force, clean.force);
    let fault = ChannelFault {
        channel: Channel::Time,
        kind: ChannelFaultKind::Repeated { samples: 3 },
    };
    assert_eq!(spoilt.faults(), [fault]);
    let written = spoilt.to_file(Path::new("test.csv")).unwrap();
    let text = String::from_utf8(written).unwrap();
    assert_eq!(read(&text).time, clean.time);
}

/// Millimetres declared as metres, or swapped columns, give a force per displacement that no mesh damper has.
#[test]
fn a_force_that_is_far_too_small_for_its_displacement_is_mentioned() {
    let said = |stiffness: f64| {
        let row = |index: usize| {
            let y = 0.1 * (0.05 * index as f64).sin();
            format!("{},{y},{}\n", 0.01 * index as f64, stiffness * y)
        };
        let rows: String = (0..400).map(row).collect();
        let recording = read(&format!("time_s,displacement_mm,force_kN\n{rows}"));
        // A repaired recording is not searched again.
        let faults = recording.repaired().repaired().faults().to_vec();
        faults.iter().map(ToString::to_string).collect::<String>()
    };
    assert_eq!(
        said(0.0004).matches("4.0e-4 kN per mm").count(),
        1,
        "{}",
        said(0.0004)
    );
    for plausible in [0.006, 4.0, 200.0] {
        assert_eq!(said(plausible), "");
    }
    assert!(
        said(4000.0).contains("unit of the force or of the displacement"),
        "{}",
        said(4000.0)
    );
}

/// A logger writes an empty cell or NaN where it has no sample. The rows count as absent.
#[test]
fn a_cell_without_a_number_is_a_missing_sample() {
    let row = |i: i32| {
        format!(
            "{:.3},{:.4},{:.4}",
            0.01 * f64::from(i),
            (0.1 * f64::from(i)).sin(),
            0.2
        )
    };
    let text =
        |rows: Vec<String>| format!("time_s,displacement_mm,force_kN\n{}\n", rows.join("\n"));
    let read = |text: String| Recording::from_bytes("a.csv".as_ref(), text.into()).unwrap();
    let with = text(
        (0..200)
            .map(|i| match i {
                50..54 => format!("{:.3},,0.2", 0.01 * f64::from(i)),
                120 => "1.200,0.5,NaN".into(),
                _ => row(i),
            })
            .collect(),
    );
    let without = text(
        (0..200)
            .filter(|i| !(50..54).contains(i) && *i != 120)
            .map(row)
            .collect(),
    );
    let (with, without) = (read(with), read(without));
    assert_eq!(with.time, without.time);
    assert_eq!(with.displacement, without.displacement);
    assert_eq!(with.gaps(), [(49, 4), (115, 1)]);
}

#[test]
fn a_motion_needs_no_force_and_a_recording_does() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let rows: String = (0..20).map(|i| format!("{i},{}\n", i % 3)).collect();
    fs::write(file.path(), format!("time_ms,displacement_um\n{rows}")).unwrap();
    let motion = Recording::read_motion(file.path(), &Reading::default()).unwrap();
    assert_eq!(motion.displacement[1], 1e-3);
    assert_eq!(motion.force, vec![0.0; 20]);
    let error = Recording::read(file.path()).unwrap_err().to_string();
    assert!(error.contains("there is no force column"), "{error}");
    // A force is read if it is there, and without a displacement there is no motion.
    fs::write(file.path(), format!("time_ms,force_kN\n{rows}")).unwrap();
    let error = Recording::read_motion(file.path(), &Reading::default()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("there is no displacement column"),
        "{error}"
    );
}

/// Seconds since 1970, as some loggers write them, in a file of another dialect: with nine digits all times would be equal.
#[test]
fn times_from_far_away_are_written_with_the_digits_of_their_steps() {
    let rows: String = (0..20)
        .map(|n| {
            format!(
                "{};{};{}\n",
                1_700_000_000.0 + 0.001 * f64::from(n),
                f64::from(n % 3),
                n
            )
        })
        .collect();
    let recording = read(&format!("Time [s];Disp [mm];Load [kN]\n{rows}"));
    assert!(
        recording
            .guesses()
            .iter()
            .any(|guess| guess.contains("semicolon"))
    );
    let written = recording.to_file(Path::new("again.csv")).unwrap();
    let again = Recording::from_bytes(Path::new("again.csv"), written).unwrap();
    assert_eq!(again.time, recording.time);
    assert!(again.guesses().is_empty());
}

#[cfg(feature = "formats")]
/// The notes about a MAT file with these variables and two channels.
fn notes_of_mat(more: &[(&str, Vec<f64>)]) -> Vec<String> {
    let wave = |n: i32| (0.3 * f64::from(n)).sin();
    let mut columns = vec![
        ("disp_mm", (0..60).map(wave).collect()),
        ("force_kN", (0..60).map(|n| 2.0 * wave(n)).collect()),
    ];
    columns.extend_from_slice(more);
    let bytes = mesh_damper_tables::write::table("a.mat".as_ref(), &[], &columns).unwrap();
    let read = Recording::from_bytes("a.mat".as_ref(), bytes).unwrap();
    assert!((read.sample_period() - 0.005).abs() < 1e-12);
    read.guesses().to_vec()
}

#[cfg(feature = "formats")]
#[test]
fn the_step_of_a_mat_file_may_be_called_ts() {
    let said = "there is no time column; the times are computed from the number Ts = 0.005 s";
    let notes = notes_of_mat(&[("Ts", vec![0.005])]);
    assert!(notes.iter().any(|note| note == said), "{notes:?}");
    // A series of temperatures is none.
    let times: Vec<f64> = (0..60).map(|n| 0.005 * f64::from(n)).collect();
    let notes = notes_of_mat(&[("Ts", vec![0.02; 60]), ("time_s", times)]);
    assert!(!notes.iter().any(|note| note.contains("Ts")), "{notes:?}");
}

#[test]
fn a_number_that_our_own_format_does_not_take_is_rewritten() {
    let row = |n: i32| format!("0.{n:02},{}.25,{}.5,{n}\n", n % 7, n % 5);
    let [rows, more] = [10..40, 41..45].map(|rows| rows.map(row).collect::<String>());
    for cell in ["0.013D4", "1.5d-3", "n/a", "-"] {
        let text =
            format!("Time (s),Disp (mm),Load (N),Oil level\n{rows}0.40,0.5,{cell},40\n{more}");
        let recording = read(&text);
        let written = recording.to_file("a.csv".as_ref()).unwrap();
        // The other columns stay, and so do their cells.
        let lines = String::from_utf8(written.clone()).unwrap();
        let is_there = |n: i32| lines.lines().any(|line| line.ends_with(&format!(",{n}")));
        assert!(lines.contains(",Oil level\n"), "{cell}: {lines}");
        assert!(
            (10..45).all(|n| is_there(n) || (n == 40 && cell.len() < 4)),
            "{cell}: {lines}"
        );
        let again = Recording::from_bytes("a.csv".as_ref(), written).unwrap();
        for (one, other) in recording.force.iter().zip(&again.force) {
            assert!(
                (one - other).abs() <= 1e-8 * one.abs(),
                "{cell}: {one} {other}"
            );
        }
    }
}

#[test]
fn a_column_that_turns_out_to_be_words_is_not_half_rewritten() {
    let row = |n: i32, current: &str| format!("{}.25,{}.5,{}.5,{current}\n", n, n % 7, n % 5);
    let written = |cell: &str, word: &str| {
        let rows = (0..400).map(|n| match n {
            300 => row(n, cell),
            350 => row(n, word),
            _ => row(n, "0.5"),
        });
        let text = format!(
            "Time (s),Disp (mm),Load (N),Current (A)\n{}",
            rows.collect::<String>()
        );
        let recording = read(&text);
        let bytes = recording.to_file("a.csv".as_ref()).unwrap();
        (recording, String::from_utf8(bytes).unwrap())
    };
    let (recording, text) = written("1.5d-3", "0.5");
    assert_eq!(recording.controls[0].name, "current_A");
    assert!(text.contains(",0.0015\n"), "{text}");
    // Cells that need no rewriting stay with the words.
    let (recording, text) = written("0.5", "on");
    assert!(recording.controls.is_empty());
    assert!(
        text.contains(",current_A\n") && text.contains(",on\n"),
        "{text}"
    );
    // Otherwise the column is left out.
    let (recording, text) = written("1.5d-3", "on");
    assert!(recording.controls.is_empty());
    assert_eq!(recording.time.len(), 400);
    assert!(!text.contains("urrent") && !text.contains("on\n"), "{text}");
    let said = |note: &String| note.contains("a written file will lack it");
    assert!(recording.guesses().iter().any(said));
}

#[cfg(feature = "formats")]
#[test]
fn a_rate_that_contradicts_the_times_is_said() {
    let times: Vec<f64> = (0..60).map(|n| 0.005 * f64::from(n)).collect();
    let said = "the times are those of column \"time_s\" in s; the number sample_rate = 500 Hz contradicts them and is not used";
    let notes = notes_of_mat(&[("time_s", times.clone()), ("sample_rate", vec![500.0])]);
    assert!(notes.iter().any(|note| note == said), "{notes:?}");
    // Also if a unit of time is between them.
    let notes = notes_of_mat(&[("time_s", times.clone()), ("fs", vec![2e5])]);
    let said = "they would agree if the times were in ms: rename the column to time_ms";
    assert!(notes.iter().any(|note| note.ends_with(said)), "{notes:?}");
    let notes = notes_of_mat(&[("time_s", times), ("sample_rate", vec![200.0])]);
    assert!(
        !notes.iter().any(|note| note.contains("contradicts")),
        "{notes:?}"
    );
}

#[test]
fn a_repeated_header_needs_a_column_of_times() {
    let rows = |from: i32| -> String {
        let each = (from..from + 30).map(|n| format!("{n},0.{n:02},{}\n", n % 7));
        each.collect()
    };
    let header = "time_s,displacement_mm,force_kN\n";
    let twice = format!("{header}{}{header}{}", rows(0), rows(30));
    let once = read(&format!("{header}{}{}", rows(0), rows(30)));
    let read = read(&twice);
    assert_eq!((&read.time, &read.force), (&once.time, &once.force));
    // Written again, it has one header.
    let written = String::from_utf8(read.to_file("a.csv".as_ref()).unwrap()).unwrap();
    assert_eq!(written.matches(header).count(), 1);
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), &twice).unwrap();
    let rate = Reading {
        rate: Some(10.0),
        ..Reading::default()
    };
    let error = Recording::read_as(file.path(), &rate)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("line 32: a second block of rows begins"),
        "{error}"
    );
    // Words alone stay an error, and so does another header.
    for words in ["the pump was off,,\n", "time_s,displacement_mm,force_N\n"] {
        let text = format!("{header}{}{words}{}", rows(0), rows(30));
        let error = Recording::from_bytes("a.csv".as_ref(), text.into()).unwrap_err();
        assert!(
            error.to_string().contains("line 32, column time_s"),
            "{error}"
        );
    }
}

#[test]
fn a_column_without_a_name_has_one_to_type() {
    let rows: String = (0..30)
        .map(|n| format!("{n},{},{}\n", 0.1 * f64::from(n % 7), n % 5))
        .collect();
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), format!("time_s,displacement_mm,\n{rows}")).unwrap();
    let error = Recording::read(file.path()).unwrap_err().to_string();
    assert!(error.contains("--channel force='column 3'"), "{error}");
    let said = Reading {
        channels: vec![("force".into(), "column 3".into())],
        units: vec![("force".into(), "kN".into())],
        ..Reading::default()
    };
    let read = Recording::read_as(file.path(), &said).unwrap();
    assert_eq!(read.force[6], 1.0);
    let written = read.to_file("a.csv".as_ref()).unwrap();
    assert!(written.starts_with(b"time_s,displacement_mm,force_kN\n"));
}
