//! Files that can be read in two ways: the reader asks.

use super::corpus::{Column, Dialect, KN, MM, N, OWN, Outcome, S, SAMPLES, rows, time};

/// A time of the recording that does not begin at zero.
fn late(index: usize) -> f64 {
    9.0 - time(0) + time(index)
}

pub fn dialects() -> Vec<Dialect> {
    let dialect = |name, text: String, columns: [Column; 3], asked: &[&'static str]| Dialect {
        family: "ambiguous",
        name,
        bytes: text.into_bytes(),
        columns,
        outcome: Outcome::Asked(asked.to_vec()),
    };
    let doubled = |names: &str| {
        let row = |index: usize| {
            let [time, y, force] = OWN.map(|column| column.cell(index, '.'));
            format!("{time}\t{y}\t9.5\t{force}\n")
        };
        format!("{names}\n{}", (0..SAMPLES).map(row).collect::<String>())
    };
    vec![
        dialect(
            "no unit of the time",
            format!("Time;Disp [mm];Load [kN]\n{}", rows(&OWN, ";", '.', "\n")),
            OWN,
            &["--unit time=s"],
        ),
        dialect(
            "no unit at all",
            format!("Time;Disp;Load\n{}", rows(&[S, MM, N], ";", '.', "\n")),
            [S, MM, N],
            &["--unit time=s", "--unit displacement=mm", "--unit force=N"],
        ),
        dialect(
            "a unit that is unknown",
            format!(
                "Time [s];Disp [mm];Load [kg]\n{}",
                rows(&[S, MM, KN.of(9.806_65e-3, 2)], ";", '.', "\n")
            ),
            [S, MM, KN.of(9.806_65e-3, 2)],
            &["--unit force=kgf"],
        ),
        dialect(
            "two units of one column",
            format!(
                "Time [s];Disp [mm];Load [kN]\ns;mm;N\n{}",
                rows(&[S, MM, N], ";", '.', "\n")
            ),
            [S, MM, N],
            &["--unit force=N"],
        ),
        dialect(
            "MN of a header in capitals",
            format!(
                "TIME [S];DISP [MM];LOAD [MN]\n{}",
                rows(&[S, MM, KN.of(1e-6, 0)], ";", '.', "\n")
            ),
            [S, MM, KN.of(1e-6, 0)],
            &["--unit force=mN"],
        ),
        dialect(
            "two forces",
            doubled("Time [s]\tDisp [mm]\tForce 1 [kN]\tForce 2 [kN]"),
            OWN,
            &["--channel force='Force 2 [kN]'"],
        ),
        dialect(
            "two forces of one name",
            doubled("Time [s]\tDisp [mm]\tForce [kN]\tForce [kN]"),
            OWN,
            &["--channel force='Force [kN] #2'"],
        ),
        dialect(
            "stroke and displacement",
            doubled("Time [s]\tStroke [mm]\tDisplacement [mm]\tForce [kN]"),
            OWN,
            &["--channel displacement='Stroke [mm]'"],
        ),
        dialect(
            "time and elapsed time",
            doubled("Time [s]\tDisp [mm]\tElapsed Time [s]\tForce [kN]"),
            OWN,
            &["--channel time='Time [s]'"],
        ),
        dialect(
            "words that no lab here knows",
            format!(
                "Aika [s];Kuljettu [mm];Puristus [kN]\n{}",
                rows(&OWN, ";", ',', "\n")
            ),
            OWN,
            &[
                "--channel displacement='Kuljettu [mm]'",
                "--channel force='Puristus [kN]'",
            ],
        ),
        dialect(
            "no header",
            rows(&OWN, ";", ',', "\n"),
            OWN,
            &[
                "--channel time='column 1'",
                "--unit time=s",
                "--channel displacement='column 2'",
                "--unit displacement=mm",
                "--channel force='column 3'",
                "--unit force=kN",
            ],
        ),
        dialect(
            "1,234 wherever there is a sign",
            {
                let row = |index: usize| {
                    format!(
                        "{};{};{}\n",
                        LATE.cell(index, ','),
                        MM.of(1e-3, 0).cell(index, ','),
                        KN.of(1e-3, 0).cell(index, ',')
                    )
                };
                format!(
                    "Time [s];Disp [um];Load [N]\n{}",
                    (0..SAMPLES).map(row).collect::<String>()
                )
            },
            [LATE, MM.of(1e-3, 0), KN.of(1e-3, 0)],
            &["--decimal comma"],
        ),
        Dialect {
            outcome: Outcome::Refused(vec!["use different signs", "--decimal point"]),
            ..dialect(
                "a point in one column, a comma in another",
                {
                    let row = |index: usize| {
                        format!(
                            "{};{};{}\n",
                            S.cell(index, '.'),
                            MM.cell(index, ','),
                            KN.cell(index, ',')
                        )
                    };
                    format!(
                        "Time [s];Disp [mm];Load [kN]\n{}",
                        (0..SAMPLES).map(row).collect::<String>()
                    )
                },
                OWN,
                &[],
            )
        },
    ]
}

/// The same with three decimals.
const LATE: Column = Column {
    values: late,
    scale: 1.0,
    decimals: 3,
};
