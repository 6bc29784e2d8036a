//! What the words in a column's name say it is, in the languages of test labs.

use crate::channel::Channel;

/// Names of each channel. A word of four letters or more, and those of `ENDING`, may also end a longer one: `Kolbenweg`, `Prüfkraft`.
const STRONG: [(Channel, &[&str]); 5] = [
    (
        Channel::Time,
        &[
            "time",
            "timestamp",
            "zeit",
            "messzeit",
            "temps",
            "tiempo",
            "tempo",
            "tijd",
            "tid",
            "czas",
            "время",
            "时间",
            "時間",
            "시간",
            "zaman",
            "aika",
            "čas",
        ],
    ),
    (
        Channel::Displacement,
        &[
            "displacement",
            "displ",
            "disp",
            "position",
            "pos",
            "stroke",
            "travel",
            "deflection",
            "deformation",
            "extension",
            "elongation",
            "lvdt",
            "weg",
            "verschiebung",
            "auslenkung",
            "hub",
            "federweg",
            "verformung",
            "einfederung",
            "déplacement",
            "deplacement",
            "course",
            "déformation",
            "desplazamiento",
            "carrera",
            "deformación",
            "spostamento",
            "corsa",
            "deslocamento",
            "curso",
            "verplaatsing",
            "slag",
            "förskjutning",
            "przemieszczenie",
            "перемещение",
            "位移",
            "変位",
            "변위",
            "yerdeğiştirme",
            "dráha",
        ],
    ),
    (
        Channel::Force,
        &[
            "force",
            "load",
            "kraft",
            "charge",
            "effort",
            "fuerza",
            "carga",
            "forza",
            "carico",
            "força",
            "forca",
            "kracht",
            "belasting",
            "belastning",
            "siła",
            "sila",
            "síla",
            "сила",
            "усилие",
            "нагрузка",
            "力",
            "荷重",
            "载荷",
            "荷载",
            "하중",
            "kuvvet",
            "voima",
            "loadcell",
            "kraftmessdose",
        ],
    ),
    (
        Channel::Velocity,
        &[
            "velocity",
            "vel",
            "speed",
            "geschwindigkeit",
            "vitesse",
            "velocidad",
            "velocità",
            "velocidade",
            "snelheid",
            "hastighet",
            "prędkość",
            "скорость",
            "速度",
            "속도",
        ],
    ),
    (
        Channel::Temperature,
        &[
            "temperature",
            "temp",
            "temperatur",
            "température",
            "temperatura",
            "temperatuur",
            "температура",
            "温度",
            "온도",
        ],
    ),
];

/// Short words that are taken for a channel only together with a unit of it.
const WEAK: [(Channel, &[&str]); 5] = [
    (Channel::Time, &["t", "elapsed"]),
    (Channel::Displacement, &["x", "y", "z", "u", "d", "s", "q"]),
    (
        Channel::Force,
        &["f", "p", "fx", "fy", "fz", "fa", "r", "last"],
    ),
    (Channel::Velocity, &["v"]),
    (Channel::Temperature, &["t", "theta", "ϑ"]),
];

/// Short words that end longer ones.
const ENDING: [&str; 2] = ["weg", "hub"];

/// Control inputs: what they are called in a recording's column, the units that they have, and words for them.
const CONTROLS: [(&str, &[&str], &[&str]); 6] = [
    (
        "current",
        &["A", "mA"],
        &[
            "current",
            "strom",
            "courant",
            "corriente",
            "corrente",
            "stroom",
            "ström",
            "prąd",
            "ток",
            "电流",
            "電流",
        ],
    ),
    (
        "voltage",
        &["V", "mV", "kV"],
        &[
            "voltage",
            "volt",
            "spannung",
            "tension",
            "voltaje",
            "tensione",
            "tensão",
            "napięcie",
            "напряжение",
            "电压",
            "電圧",
        ],
    ),
    (
        "pressure",
        &["bar", "mbar", "Pa", "kPa", "MPa", "psi"],
        &[
            "pressure",
            "druck",
            "pression",
            "presión",
            "pressione",
            "pressão",
            "druk",
            "tryck",
            "ciśnienie",
            "давление",
            "压力",
            "圧力",
        ],
    ),
    (
        "tension",
        &["N", "kN", "lbf", "kip"],
        &[
            "tension",
            "preload",
            "pretension",
            "vorspannkraft",
            "vorlast",
            "précharge",
            "precarga",
            "precarico",
        ],
    ),
    (
        "field",
        &["T", "mT"],
        &["field", "flux", "feld", "flussdichte", "champ", "campo"],
    ),
    (
        "power",
        &["W"],
        &["power", "leistung", "puissance", "potencia", "potenza"],
    ),
];

/// Words of what was asked of a channel, computed of it, or counted: not of what was measured.
const NOT_MEASURED: [&str; 41] = [
    "command",
    "cmd",
    "setpoint",
    "set",
    "target",
    "demand",
    "desired",
    "reference",
    "ref",
    "soll",
    "sollwert",
    "vorgabe",
    "führung",
    "consigne",
    "consigna",
    "error",
    "err",
    "fehler",
    "abweichung",
    "predicted",
    "model",
    "fit",
    "rate",
    "limit",
    "peak",
    "valley",
    "max",
    "min",
    "maximum",
    "minimum",
    "amplitude",
    "mean",
    "mittelwert",
    "rms",
    "range",
    "std",
    "count",
    "nummer",
    "status",
    "flag",
    "offset",
];

/// How surely a name says what its column is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Certainty {
    /// A short word, which means this only beside a unit of it.
    Weak,
    /// A name of the channel.
    Strong,
}

/// The channels that the words of a name may mean.
pub(super) fn meanings(words: &[String]) -> Vec<(Channel, Certainty)> {
    let said = |list: &[&str], is_it: &dyn Fn(&str, &str) -> bool| {
        words
            .iter()
            .any(|word| list.iter().any(|each| is_it(word, each)))
    };
    let strong = STRONG.iter().filter(|(_, list)| said(list, &is_or_ends));
    let strong = strong.map(|&(channel, _)| (channel, Certainty::Strong));
    let same: &dyn Fn(&str, &str) -> bool = &|word, each| word == each;
    // A short word beside others may mean anything: `x axis`, `load p`.
    let weak = WEAK
        .iter()
        .filter(|(_, list)| words.len() == 1 && said(list, same));
    strong
        .chain(weak.map(|&(channel, _)| (channel, Certainty::Weak)))
        .collect()
}

/// The control input that the words of a name mean beside this unit.
pub(super) fn control(words: &[String], unit: &str) -> Option<&'static str> {
    let means = |list: &[&str]| {
        words
            .iter()
            .any(|word| list.iter().any(|each| is_or_ends(word, each)))
    };
    let is_it = |(_, units, list): &&(&str, &[&str], &[&str])| units.contains(&unit) && means(list);
    CONTROLS.iter().find(is_it).map(|&(name, ..)| name)
}

/// Whether the words are those of some control input, whatever its unit.
pub(super) fn is_of_control(words: &[String]) -> bool {
    let means = |list: &[&str]| {
        words
            .iter()
            .any(|word| list.iter().any(|each| is_or_ends(word, each)))
    };
    CONTROLS.iter().any(|(.., list)| means(list))
}

/// Whether the words say that the column is not what was measured.
pub(super) fn is_not_measured(words: &[String]) -> bool {
    words
        .iter()
        .any(|word| NOT_MEASURED.contains(&word.as_str()))
}

fn is_or_ends(word: &str, known: &str) -> bool {
    let ends = known.chars().count() > 4 || ENDING.contains(&known) || known == "zeit";
    word == known || (ends && word.ends_with(known))
}
