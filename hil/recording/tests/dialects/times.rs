//! How the times of samples are given.

use super::corpus::{
    Column, Dialect, KN, MM, OWN, Outcome, S, SAMPLES, displacement, force, rows, time,
};

/// Times in tenths of a millisecond, from the first on.
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
    vec![
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
                let (h, m, s, f) = clock(ticks, 86_400 - 1 + 86_400);
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
            read(&["a step of 0.0125 s is by line 1"]),
        ),
        dialect(
            "a step in the preamble",
            without("Sample interval;12,5 ms\n\n"),
            read(&["a step of 0.0125 s is by line 1"]),
        ),
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
