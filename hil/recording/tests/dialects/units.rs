//! Spellings of units.

use super::corpus::{Column, Dialect, KN, MM, Outcome, S, rows};

pub fn dialects() -> Vec<Dialect> {
    let dialect = |name, names: &str, columns: [Column; 3], said: &[&'static str]| Dialect {
        family: "units",
        name,
        bytes: format!("{names}\n{}", rows(&columns, "\t", '.', "\n")).into_bytes(),
        columns,
        outcome: Outcome::Read(said.to_vec()),
    };
    let lbf = 4.448_221_615_260_5e-3;
    vec![
        dialect(
            "ms, cm, N",
            "Time [ms]\tDisp [cm]\tLoad [N]",
            [S.of(1e-3, 1), MM.of(10.0, 6), KN.of(1e-3, 2)],
            &["in ms", "in cm", "in N"],
        ),
        dialect(
            "inch and kip in words",
            "Time (seconds)\tStroke (inches)\tLoad (kips)",
            [S, MM.of(25.4, 6), KN.of(1e3 * lbf, 6)],
            &["in in", "in kip"],
        ),
        dialect(
            "µs, µm, MN",
            "Time [µs]\tDisp [µm]\tLoad [MN]",
            [S.of(1e-6, 0), MM.of(1e-3, 2), KN.of(1e3, 8)],
            &["in us", "in um", "in MN"],
        ),
        dialect(
            "m and kgf",
            "time (s)\tposition (m)\tload (kgf)",
            [S, MM.of(1e3, 8), KN.of(9.806_65e-3, 2)],
            &["in m", "in kgf"],
        ),
        dialect(
            "lbf, a Greek µ",
            "Time, sec\tDisp, μm\tLoad, lbf",
            [S, MM.of(1e-3, 2), KN.of(lbf, 3)],
            &["in um", "in lbf"],
        ),
        dialect(
            "daN, as in France",
            "Temps (s)\tCourse (mm)\tEffort (daN)",
            [S, MM, KN.of(1e-2, 3)],
            &["in daN"],
        ),
        dialect(
            "minutes",
            "Time [min]\tDisp [mm]\tLoad [kN]",
            [S.of(60.0, 7), MM, KN],
            &["in min"],
        ),
        dialect(
            "units in Russian",
            "Время (с)\tПеремещение (мм)\tСила (кН)",
            [S, MM, KN],
            &["in kN"],
        ),
    ]
}
