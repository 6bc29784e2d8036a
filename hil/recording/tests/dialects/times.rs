//! How the times of samples are given.

use mesh_damper_tables::files::Reading;

use super::corpus::{
    Column, Dialect, KN, MM, OWN, Outcome, S, SAMPLES, displacement, force, rows, time,
};

/// Times in tenths of a millisecond, counted from the first sample.
const STAMPED: Column = S.of(1.0, 4);

fn stamped(names: &str, stamp: impl Fn(i64) -> String) -> Vec<u8> {
    let row = |index: usize| {
        let ticks = (time(index) * 1e4).round() as i64;
        format!(
            "{};{:.5};{:.5}\n",
            stamp(ticks),
            displacement(index),
            force(index)
        )
    };
    (names.to_owned() + "\n" + &(0..SAMPLES).map(row).collect::<String>()).into_bytes()
}

fn clock(ticks: i64, from: i64) -> (i64, i64, i64, i64) {
    let ticks = ticks + from * 10_000;
    let seconds = ticks / 10_000;
    (
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60,
        ticks % 10_000,
    )
}

/// The reader does not believe a user's statement about a column of times of day if it cannot be true.
#[test]
fn times_of_day_are_in_no_unit_that_the_user_says() {
    let bytes = stamped("Time (ms);Disp [mm];Load [kN]", |ticks| {
        let (h, m, s, f) = clock(ticks, 62);
        format!("{h:02}:{m:02}:{s:02}.{f:04}")
    });
    let said = |unit: &str| Reading {
        units: vec![("time".into(), unit.into())],
        ..Reading::default()
    };
    let error = super::corpus::read(&bytes, &said("ms")).unwrap_err();
    assert!(
        error.contains("read as seconds") && error.contains("leave the unit out"),
        "{error}"
    );
    let read = super::corpus::read(&bytes, &said("s")).unwrap();
    super::corpus::is_true(&read, [STAMPED, MM, KN]).unwrap();
}

pub fn dialects() -> Vec<Dialect> {
    let dialect = |name, bytes: Vec<u8>, outcome: Outcome| Dialect {
        family: "time",
        name,
        bytes,
        columns: [STAMPED, MM, KN],
        outcome,
    };
    let read = |said: &[&'static str]| Outcome::Read(said.to_vec());
    let without = |preamble: &str| {
        format!(
            "{preamble}Weg [mm];Kraft [kN]\n{}",
            rows(&[MM, KN], ";", ',', "\n")
        )
        .into_bytes()
    };
    let names = "Time;Disp [mm];Load [kN]";
    // As pandas writes a frame with dates, or its index.
    let own = |times: &str, behind: &str| {
        stamped(&format!("{times};displacement_mm;force_kN"), |ticks| {
            let (h, m, s, f) = clock(ticks, 36_000);
            format!("2026-04-03 {h:02}:{m:02}:{s:02}.{f:04}{behind}")
        })
        .into_iter()
        .map(|byte| if byte == b';' { b',' } else { byte })
        .collect()
    };
    let of_dates = |column: &'static str| read(&[column, "holds dates or times of day"]);
    let without_times = |preamble: &str| {
        let rows = rows(&[MM, KN], ",", '.', "\n");
        format!("{preamble}displacement_mm,force_kN\n{rows}").into_bytes()
    };
    vec![
        dialect(
            "own names, dates under timestamp",
            own("timestamp", ""),
            of_dates("column \"timestamp\""),
        ),
        dialect(
            "own names, dates with an offset under time",
            own("time", "+00:00"),
            of_dates("column \"time\""),
        ),
        dialect(
            "own names, dates under zeit",
            own("zeit", ""),
            of_dates("column \"zeit\""),
        ),
        dialect(
            "own names, dates under time_s",
            own("time_s", ""),
            of_dates("column \"time_s\""),
        ),
        dialect(
            "own names, dates in an index without a name",
            own("", ""),
            of_dates("column \"column 1\""),
        ),
        dialect(
            "own names, a rate in a comment",
            without_times("# fs = 80 Hz\n"),
            read(&["the step of 0.0125 s is from line 1, \"fs = 80 Hz\""]),
        ),
        dialect(
            "own names, no times at all",
            without_times("# specimen 4\n"),
            Outcome::Asked(vec!["--rate 80"]),
        ),
        dialect(
            "own names, seconds in an index without a name",
            ("".to_owned() + ",displacement_mm,force_kN\n" + &rows(&OWN, ",", '.', "\n"))
                .into_bytes(),
            Outcome::Asked(vec!["--channel time='column 1'", "--unit time=s"]),
        ),
        dialect(
            "dates and times of day",
            stamped(names, |ticks| {
                let (h, m, s, f) = clock(ticks, 43_200);
                format!("2024-03-01 {h:02}:{m:02}:{s:02}.{f:04}")
            }),
            read(&["dates or times of day"]),
        ),
        dialect(
            "dates of Germany, over midnight",
            stamped("Datum;Weg [mm];Kraft [kN]", |ticks| {
                let (h, m, s, f) = clock(ticks + 5_000, 86_400 - 1 + 86_400);
                format!("{:02}.12.2024 {:02}:{m:02}:{s:02},{f:04}", h / 24, h % 24)
            }),
            Outcome::Read(vec!["dates or times of day", "by its unit alone"]),
        ),
        dialect(
            "times of day alone",
            stamped(names, |ticks| {
                let (h, m, s, f) = clock(ticks, 62);
                format!("{h:02}:{m:02}:{s:02}.{f:04}")
            }),
            read(&["dates or times of day"]),
        ),
        dialect(
            "times of day under a name in ms",
            stamped("Time (ms);Disp [mm];Load [kN]", |ticks| {
                let (h, m, s, f) = clock(ticks, 62);
                format!("{h:02}:{m:02}:{s:02}.{f:04}")
            }),
            read(&["\"Time (ms)\" in s"]),
        ),
        dialect(
            "times of day under their form",
            stamped("Time [hh:mm:ss];Disp [mm];Load [kN]", |ticks| {
                let (h, m, s, f) = clock(ticks, 62);
                format!("{h:02}:{m:02}:{s:02}.{f:04}")
            }),
            read(&["\"Time [hh:mm:ss]\" in s"]),
        ),
        dialect(
            "times of day under another form",
            stamped("Time (HH:MM:SS,ms);Disp [mm];Load [kN]", |ticks| {
                let (h, m, s, f) = clock(ticks, 62);
                format!("{h:02}:{m:02}:{s:02},{f:04}")
            }),
            read(&["\"Time (HH:MM:SS,ms)\" in s"]),
        ),
        dialect(
            "ISO 8601 with an offset",
            stamped("Timestamp;Disp [mm];Load [kN]", |ticks| {
                let (h, m, s, f) = clock(ticks, 43_200);
                format!("2024-03-01T{h:02}:{m:02}:{s:02}.{f:04}+01:00")
            }),
            read(&["dates or times of day"]),
        ),
        dialect(
            "two digits of the year, over midnight",
            stamped(names, |ticks| {
                let (h, m, s, f) = clock(ticks + 5_000, 86_400 - 1);
                format!("24-03-{:02} {:02}:{m:02}:{s:02}.{f:04}", 1 + h / 24, h % 24)
            }),
            read(&["1 midnight"]),
        ),
        dialect(
            "the time of day beside the date, over midnight",
            stamped("Date;Time;Disp [mm];Load [kN]", |ticks| {
                let (h, m, s, f) = clock(ticks + 5_000, 86_400 - 1);
                format!(
                    "{:02}.03.2024;{:02}:{m:02}:{s:02}.{f:04}",
                    1 + h / 24,
                    h % 24
                )
            }),
            read(&["1 midnight"]),
        ),
        dialect(
            "a time of day beside seconds",
            rows(&OWN, ";", '.', "\n")
                .lines()
                .enumerate()
                .fold(
                    "Timestamp;Time [s];Disp [mm];Load [kN]\n".to_owned(),
                    |text, (index, line)| {
                        format!("{text}2024-03-01 12:00:{:02};{line}\n", index / 8)
                    },
                )
                .into_bytes(),
            read(&["time is read from column \"Time [s]\""]),
        ),
        dialect(
            "a rate in the preamble",
            without("Abtastrate: 80 Hz\n\n"),
            read(&["the step of 0.0125 s is from line 1"]),
        ),
        dialect(
            "a step in the preamble",
            without("Sample interval;12,5 ms\n\n"),
            read(&["the step of 0.0125 s is from line 1"]),
        ),
        dialect(
            "two rates in the preamble",
            without("Sample rate: 5000 Hz\nData rate: 80 Hz\n\n"),
            Outcome::Asked(vec!["--rate 80"]),
        ),
        dialect(
            "a rate and a step that differ",
            without("Sample rate: 80 Hz\nTime step: 0,1 s\n\n"),
            Outcome::Asked(vec!["--rate 80"]),
        ),
        dialect(
            "a rate and its step",
            without("Sample rate: 80 Hz\nTime step: 12,5 ms\n\n"),
            read(&["the step of 0.0125 s is from line 1"]),
        ),
        Dialect {
            columns: [STAMPED, MM.of(1e-3, 0), KN.of(1e-3, 0)],
            ..dialect(
                "a rate whose point may divide thousands",
                format!(
                    "Abtastrate: 80.000 Hz\nWeg [um];Kraft [N]\n{}",
                    rows(&[MM.of(1e-3, 0), KN.of(1e-3, 0)], ";", '.', "\n")
                )
                .into_bytes(),
                Outcome::Asked(vec!["--rate 80"]),
            )
        },
        dialect(
            "a rate without its unit",
            without("Abtastrate: 80\n\n"),
            Outcome::Asked(vec!["--rate 80"]),
        ),
        dialect(
            "no times at all",
            without(""),
            Outcome::Asked(vec!["--rate 80"]),
        ),
    ]
}
