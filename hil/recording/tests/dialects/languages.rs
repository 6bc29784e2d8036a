//! Names in the languages of test labs.

use super::corpus::{Dialect, OWN, Outcome, rows};

pub const NAMES: [(&str, [&str; 3]); 14] = [
    ("English", ["Time", "Displacement", "Force"]),
    (
        "English of a hydraulic rig",
        ["Running Time", "Axial Displacement", "Axial Force"],
    ),
    ("German", ["Zeit", "Weg", "Kraft"]),
    (
        "German of a testing machine",
        ["Prüfzeit", "Standardweg", "Standardkraft"],
    ),
    ("French", ["Temps", "Déplacement", "Force"]),
    ("Spanish", ["Tiempo", "Desplazamiento", "Fuerza"]),
    ("Italian", ["Tempo", "Spostamento", "Forza"]),
    ("Portuguese", ["Tempo", "Deslocamento", "Força"]),
    ("Dutch", ["Tijd", "Verplaatsing", "Kracht"]),
    ("Swedish", ["Tid", "Förskjutning", "Kraft"]),
    ("Polish", ["Czas", "Przemieszczenie", "Siła"]),
    ("Russian", ["Время", "Перемещение", "Сила"]),
    ("Chinese", ["时间", "位移", "试验力"]),
    ("Japanese", ["時間", "変位", "荷重"]),
];

pub fn dialects() -> Vec<Dialect> {
    let dialect = |(name, [time, displacement, force]): (&'static str, [&str; 3])| Dialect {
        family: "language",
        name,
        bytes: format!(
            "{time} [s];{displacement} [mm];{force} [kN]\n{}",
            rows(&OWN, ";", ',', "\n")
        )
        .into_bytes(),
        columns: OWN,
        outcome: Outcome::Read(vec![
            "time is read",
            "displacement is read",
            "force is read",
        ]),
    };
    NAMES.into_iter().map(dialect).collect()
}
