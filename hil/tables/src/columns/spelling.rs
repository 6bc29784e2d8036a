//! Units as people and programs write them.

use std::collections::HashMap;
use std::sync::LazyLock;

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

/// The units of channels and of control inputs that have one spelling, apart from its case.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Spelt {
    /// Those of channels, in this case; the first of a channel counts.
    exact: Vec<(Channel, &'static str, Unit)>,
    /// Those of channels in some case.
    folded: Vec<(Channel, Unit)>,
    /// Those of control inputs: by their own symbols, and by others.
    controls: Vec<&'static str>,
    spelt: Option<&'static str>,
}

/// All spellings, in lower case.
static SPELT: LazyLock<HashMap<String, Spelt>> = LazyLock::new(|| {
    let mut all: HashMap<String, Spelt> = HashMap::new();
    let of_channels = Channel::ALL.into_iter().flat_map(|channel| {
        let own = channel.units().iter();
        let own = own.map(|unit| (*unit, std::slice::from_ref(&unit.symbol)));
        let other = SPELLINGS.iter().filter(move |(of, ..)| *of == channel);
        let other = other.filter_map(move |(_, symbol, list)| {
            let mut units = channel.units().iter();
            Some((*units.find(|unit| unit.symbol == *symbol)?, *list))
        });
        own.chain(other)
            .map(move |(unit, list)| (channel, unit, list))
    });
    for (channel, unit, list) in of_channels {
        for &spelling in list {
            let spelt = all.entry(spelling.to_lowercase()).or_default();
            spelt.exact.push((channel, spelling, unit));
            if !spelt.folded.contains(&(channel, unit)) {
                spelt.folded.push((channel, unit));
            }
        }
    }
    for &unit in crate::control::UNITS {
        let spelt = all.entry(unit.to_lowercase()).or_default();
        spelt.controls.push(unit);
    }
    for &(unit, list) in CONTROLS {
        for each in list {
            all.entry(each.to_lowercase()).or_default().spelt = Some(unit);
        }
    }
    all
});

/// The longest spelling in bytes; one in other case may have some more.
static LONGEST: LazyLock<usize> =
    LazyLock::new(|| 2 * SPELT.keys().map(String::len).max().unwrap_or(0));

/// The length in bytes that a unit has at most, in brackets too.
pub(super) fn longest() -> usize {
    *LONGEST
}

/// The units that are written so; `None` if the text is none.
pub(super) fn spelt(written: &str) -> Option<&'static Spelt> {
    let written = written.trim();
    if written.is_empty() || written.len() > *LONGEST {
        return None;
    }
    SPELT.get(written.to_lowercase().as_str())
}

impl Spelt {
    /// The unit of a channel that is written so.
    pub fn of(&self, channel: Channel, written: &str) -> Option<Unit> {
        let written = written.trim();
        let mut exact = self.exact.iter();
        let exact = exact.find(|(of, spelling, _)| *of == channel && *spelling == written);
        if let Some((.., unit)) = exact {
            return Some(*unit);
        }
        // `MM` and `KN` of a header in capitals; `mn` could be two units, and is rejected.
        let mut folded = self.folded.iter().filter(|(of, _)| *of == channel);
        let (_, unit) = folded.next()?;
        folded.next().is_none().then_some(*unit)
    }

    /// The unit of a control input that is written so.
    pub fn of_control(&self, written: &str) -> Option<&'static str> {
        let written = written.trim();
        let mut own = self.controls.iter().copied();
        own.find(|unit| *unit == written)
            .or(match self.controls[..] {
                // `BAR` and `MPA` of a header in capitals; a single letter in the wrong case may be a word.
                [unit] if written.len() > 1 => Some(unit),
                _ => self.spelt,
            })
    }
}

/// The unit of a channel with this spelling. Case counts where it distinguishes units, as in mN and MN.
pub(crate) fn unit_of(channel: Channel, written: &str) -> Option<Unit> {
    spelt(written)?.of(channel, written)
}

/// Whether a unit of a channel is written in one of its spellings, letter by letter.
pub(super) fn is_as_spelt(channel: Channel, unit: Unit, written: &str) -> bool {
    let written = written.trim();
    let is_spelling = |(of, symbol, list): &(Channel, &str, &[&str])| {
        *of == channel && *symbol == unit.symbol && list.contains(&written)
    };
    unit.symbol == written || SPELLINGS.iter().any(is_spelling)
}

/// The unit of a control input with this spelling.
pub(super) fn control_unit(written: &str) -> Option<&'static str> {
    spelt(written)?.of_control(written)
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
    let is_one = |spelt: &Spelt| {
        let mut channels = Channel::ALL.into_iter();
        channels.any(|channel| spelt.of(channel, bare).is_some())
            || spelt.of_control(bare).is_some()
    };
    spelt(bare).is_some_and(is_one)
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
