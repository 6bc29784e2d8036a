//! Units as people and programs write them.

use crate::channel::Channel;
use crate::units::Unit;

/// Spellings in addition to a unit's own symbol, in their usual case.
const SPELLINGS: &[(Channel, &str, &[&str])] = &[
    (
        Channel::Time,
        "s",
        &[
            "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden", "sec.", "seconde",
            "secondes", "segundos", "secondi", "с", "сек", "秒",
        ],
    ),
    (
        Channel::Time,
        "ms",
        &[
            "msec",
            "millisecond",
            "milliseconds",
            "millisekunden",
            "мс",
            "毫秒",
        ],
    ),
    (
        Channel::Time,
        "us",
        &["µs", "μs", "usec", "µsec", "μsec", "microseconds", "мкс"],
    ),
    (
        Channel::Time,
        "min",
        &["minute", "minutes", "minuten", "мин"],
    ),
    (Channel::Time, "ns", &["nsec", "nanoseconds"]),
    (Channel::Time, "h", &["hr", "hour", "hours", "stunden"]),
    (
        Channel::Displacement,
        "mm",
        &[
            "millimeter",
            "millimetre",
            "millimeters",
            "millimetres",
            "мм",
            "毫米",
            "ミリ",
        ],
    ),
    (
        Channel::Displacement,
        "m",
        &["meter", "metre", "meters", "metres"],
    ),
    (
        Channel::Displacement,
        "um",
        &["µm", "μm", "micron", "microns", "micrometer", "мкм"],
    ),
    (
        Channel::Displacement,
        "in",
        &["inch", "inches", "in.", "\"", "zoll"],
    ),
    (Channel::Displacement, "cm", &["centimeter", "centimetre"]),
    (Channel::Displacement, "mil", &["mils", "thou"]),
    (Channel::Force, "N", &["newton", "newtons", "Н"]),
    (Channel::Force, "kN", &["kilonewton", "kilonewtons", "кН"]),
    (Channel::Force, "uN", &["µN", "μN"]),
    (
        Channel::Force,
        "lbf",
        &["lb", "lbs", "lb.", "pound", "pounds", "poundforce"],
    ),
    (Channel::Force, "kip", &["kips", "klbf"]),
    (Channel::Force, "kgf", &["kp", "kilopond", "кгс"]),
    (Channel::Force, "tf", &["тс"]),
    (
        Channel::Velocity,
        "mm/s",
        &["mm/sec", "mm s-1", "mm·s-1", "mm*s^-1"],
    ),
    (
        Channel::Velocity,
        "m/s",
        &["m/sec", "m s-1", "m·s-1", "m*s^-1"],
    ),
    (Channel::Velocity, "um/s", &["µm/s", "μm/s"]),
    (Channel::Velocity, "in/s", &["in/sec", "inch/s", "ips"]),
    (
        Channel::Temperature,
        "degC",
        &[
            "°C", "ºC", "C", "deg C", "celsius", "grad C", "Grad C", "℃", "deg. C",
        ],
    ),
    (Channel::Temperature, "K", &["kelvin"]),
    (
        Channel::Temperature,
        "degF",
        &["°F", "ºF", "F", "deg F", "fahrenheit"],
    ),
];

/// Units of control inputs with other spellings.
const CONTROLS: &[(&str, &[&str])] = &[
    ("A", &["amp", "amps", "ampere", "amperes"]),
    ("V", &["volt", "volts"]),
    ("mbar", &["hPa"]),
    ("psi", &["psia", "psig"]),
    ("W", &["watt", "watts"]),
    ("T", &["tesla"]),
];
/// Units of control inputs with other prefixes than those that are read.
const SCALED: &[&str] = &["A", "V", "W", "N", "T", "Pa", "bar"];
/// Units that are not read, each with one that is and measures the same.
const OTHERS: &[(&str, &str)] = &[
    ("G", "T"),
    ("Oe", "T"),
    ("ksi", "psi"),
    ("daN", "N"),
    ("kgf", "N"),
];

/// The unit of a channel with this spelling. Case counts where it distinguishes units, as in mN and MN.
pub(crate) fn unit_of(channel: Channel, written: &str) -> Option<Unit> {
    let written = written.trim();
    let named = |symbol: &str| {
        channel
            .units()
            .iter()
            .find(|unit| unit.symbol == symbol)
            .copied()
    };
    let spelt = |is_it: &dyn Fn(&str) -> bool| {
        let own = channel
            .units()
            .iter()
            .filter(|unit| is_it(unit.symbol))
            .map(|unit| unit.symbol);
        let other = SPELLINGS
            .iter()
            .filter(|(of, _, list)| *of == channel && list.iter().any(|each| is_it(each)));
        let mut found: Vec<&str> = own.chain(other.map(|&(_, symbol, _)| symbol)).collect();
        found.dedup();
        found
    };
    if let [symbol, ..] = spelt(&|each| each == written)[..] {
        return named(symbol);
    }
    // `MM` and `KN` of a header in capitals; `mn` could be two units, and is rejected.
    let folded = written.to_lowercase();
    match spelt(&|each| each.to_lowercase() == folded)[..] {
        [symbol] => named(symbol),
        _ => None,
    }
}

/// Whether a unit of a channel is written in one of its spellings, letter by letter.
pub(super) fn is_as_spelt(channel: Channel, unit: Unit, written: &str) -> bool {
    let written = written.trim();
    let is_spelling = |(of, symbol, list): &(Channel, &str, &[&str])| {
        *of == channel && *symbol == unit.symbol && list.contains(&written)
    };
    unit.symbol == written || SPELLINGS.iter().any(is_spelling)
}

/// The unit of a control input with this spelling, among the `known` ones.
pub(super) fn control_unit(written: &str, known: &'static [&'static str]) -> Option<&'static str> {
    let written = written.trim();
    let own = known.iter().find(|unit| **unit == written).copied();
    own.or_else(|| {
        let folded = written.to_lowercase();
        // `BAR` and `MPA` of a header in capitals; a single letter in the wrong case may be a word.
        let mut alike = known.iter().filter(|unit| unit.to_lowercase() == folded);
        if written.len() > 1
            && let (Some(unit), None) = (alike.next(), alike.next())
        {
            return Some(*unit);
        }
        let spelt = |list: &[&str]| list.iter().any(|each| each.to_lowercase() == folded);
        CONTROLS
            .iter()
            .find(|(_, list)| spelt(list))
            .map(|&(unit, _)| unit)
    })
}

/// The unit of control inputs that measures the same as one with this symbol, which may be one that is not read: T for `G`, A for
/// `kA`. Case counts.
pub(super) fn control_unit_like(symbol: &str) -> Option<&'static str> {
    let symbol = symbol.trim();
    let prefixes = ['n', 'u', 'µ', 'μ', 'm', 'k', 'K', 'M', 'G'];
    let base = symbol.strip_prefix(prefixes);
    let mut own = crate::control::UNITS.iter().copied();
    own.find(|unit| *unit == symbol)
        .or_else(|| SCALED.iter().copied().find(|unit| Some(*unit) == base))
        .or_else(|| (OTHERS.iter()).find_map(|&(other, unit)| (other == symbol).then_some(unit)))
}

/// A unit without the brackets that a row of units puts around it.
pub fn bare(unit: &str) -> &str {
    unit.trim().trim_matches(|c| "[](){}<>".contains(c)).trim()
}

/// Whether a text is a unit of a channel or of a control input.
pub(crate) fn is_quantity(written: &str) -> bool {
    let bare = bare(written);
    let mut channels = Channel::ALL.into_iter();
    channels.any(|channel| unit_of(channel, bare).is_some())
        || control_unit(bare, crate::control::UNITS).is_some()
}

/// Whether a text is a unit of any quantity that a recording may contain, or the sign for none.
pub(crate) fn is_unit(written: &str) -> bool {
    let bare = bare(written);
    matches!(
        bare,
        "-" | "--"
            | "1"
            | "%"
            | "°"
            | "deg"
            | "rad"
            | "Hz"
            | "Nm"
            | "N·m"
            | "g"
            | "m/s2"
            | "m/s²"
            | "m/s^2"
            | "mm/mm"
            | "cycles"
            | "segments"
    ) || is_quantity(bare)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn case_counts_where_it_tells_units_apart() {
        let symbol = |channel, written| unit_of(channel, written).map(|unit| unit.symbol);
        for (written, is) in [
            ("kN", Some("kN")),
            ("KN", Some("kN")),
            ("MN", Some("MN")),
            ("mN", Some("mN")),
            ("mn", None),
            ("N", Some("N")),
            ("Lbf", Some("lbf")),
            ("kg", None),
            ("V", None),
        ] {
            assert_eq!(symbol(Channel::Force, written), is, "{written}");
        }
        assert_eq!(symbol(Channel::Displacement, "MM"), Some("mm"));
        assert_eq!(symbol(Channel::Displacement, "µm"), Some("um"));
        assert_eq!(symbol(Channel::Time, "Sec"), Some("s"));
        assert_eq!(symbol(Channel::Velocity, "mm/s"), Some("mm/s"));
    }

    #[test]
    fn every_spelling_is_of_a_unit_and_of_one_alone() {
        for (channel, symbol, list) in SPELLINGS {
            for each in *list {
                assert_eq!(
                    unit_of(*channel, each).map(|unit| unit.symbol),
                    Some(*symbol),
                    "{each}"
                );
            }
        }
        for unit in crate::units::FORCE {
            assert!(is_unit(unit.symbol));
        }
    }
}
