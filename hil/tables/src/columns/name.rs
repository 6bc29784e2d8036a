//! A column's name: its words, its unit, and a scale.

use super::scale::scale;
use super::spelling::{self, Spelt};
use super::words::Words;

/// Parts of a column's name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Name {
    /// What its words say, without a marked unit and the words after it.
    pub words: Words,
    /// A marked unit: `[kN]`, `(kN)`, `/ kN`, `, kN`.
    pub marked: Option<String>,
    /// Other possible units next to the marked one: `Time (s) / ms`, `Force [kN] -> N`.
    pub others: Vec<String>,
    /// A factor: `Force [N] (x1000)`.
    pub scale: Option<String>,
    /// Text in brackets that is not a known unit: `Zaman (sn)`.
    pub bracketed: Option<String>,
    /// The last words, which may be a unit, each with the words before it: `Load_N`, `speed mm/s`, `F in kN`; the longest first.
    pub tails: Vec<Tail>,
}

/// The last words of a name, which may be a unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tail {
    /// As written.
    pub text: String,
    /// The units that are written so.
    pub spelt: Option<&'static Spelt>,
    /// What the words before them say.
    pub before: Words,
}

/// A marked unit, and the text before and after it.
#[derive(Clone, Copy)]
struct Marked<'t> {
    before: &'t str,
    unit: &'t str,
    behind: &'t str,
    is_square: bool,
}

/// Length of a name in bytes within which a unit is searched for, which takes time in proportion to its square. Of a longer one, the
/// words in as many bytes at its end count: it is a path, whose last names say what it is. Convention: no name of a column is longer.
const LONGEST: usize = 256;

/// Steps of finding what a name means: those that any takes, and those for each byte in which a unit is searched for. Derived from
/// time: a microsecond, and 50 ns at worst, for a name of signs that could each stand before a unit.
const STEPS: [u64; 2] = [100, 20];

/// Steps of finding what a name means.
pub(super) fn steps(text: &str) -> u64 {
    STEPS[0] + STEPS[1] * text.len().min(LONGEST) as u64
}

const BRACKETS: [[char; 2]; 4] = [['[', ']'], ['(', ')'], ['{', '}'], ['<', '>']];

impl Name {
    /// Splits a name into its parts.
    pub fn of(text: &str) -> Self {
        let text = text.trim().trim_matches('"').trim();
        if text.len() > LONGEST {
            let begin = (text.len() - LONGEST..).find(|&at| text.is_char_boundary(at));
            return Self {
                words: Words::of(&text[begin.unwrap_or(text.len())..]),
                ..Self::default()
            };
        }
        let scale = scale(text).map(str::to_owned);
        let in_brackets = bracketed(text);
        if let Some(found) = marked(text, &in_brackets) {
            let rest = format!("{} {}", found.before, found.behind);
            return Self {
                words: Words::of(&rest),
                others: others(&rest, found.behind),
                marked: Some(found.unit.to_owned()),
                scale,
                ..Self::default()
            };
        }
        // `Weg in mm (absolut)`: text in brackets at the end of a name belongs to it.
        let (head, remark) = match in_brackets.first() {
            Some(last) if last.behind.is_empty() => (last.before, last.unit),
            _ => (text, ""),
        };
        // `velocity_mm_s`: two words may be one unit.
        let last_two = |separators: &[char]| {
            let mut cuts = head.rmatch_indices(separators).map(|(at, _)| at);
            [cuts.next(), cuts.next()]
        };
        let of_words = last_two(&['_', ' ', '-']);
        let of_points = last_two(&['.']);
        let cuts = [of_words[1], of_words[0], of_points[1], of_points[0]];
        let mut rising = cuts.map(|cut| cut.unwrap_or(0));
        rising.sort_unstable();
        let (words, before) = Words::before(text, rising);
        let tails = cuts.into_iter().flatten().map(|at| {
            let place = rising.iter().position(|cut| *cut == at);
            let mut before = before[place.unwrap_or(0)];
            before.read(remark);
            let text = head[at + 1..].trim();
            Tail {
                text: text.to_owned(),
                spelt: spelling::spelt(text),
                before,
            }
        });
        let tails = tails.collect();
        let bracketed = in_brackets.first().map(|found| found.unit.to_owned());
        Self {
            words,
            scale,
            bracketed,
            tails,
            ..Self::default()
        }
    }
}

/// Texts in brackets, one kind of brackets after the other, each from the last on.
fn bracketed(text: &str) -> Vec<Marked<'_>> {
    let mut found = Vec::new();
    if !text.contains(BRACKETS.map(|[open, _]| open)) {
        return found;
    }
    for [open, close] in BRACKETS {
        let mut end = None;
        for (at, sign) in text.rmatch_indices([open, close]) {
            if sign.starts_with(close) {
                end = Some(at);
                continue;
            }
            let Some(end) = end else { continue };
            let unit = text[at + 1..end].trim();
            if !unit.is_empty() {
                found.push(Marked {
                    before: text[..at].trim(),
                    unit,
                    behind: text[end + close.len_utf8()..].trim(),
                    is_square: open == '[',
                });
            }
        }
    }
    found
}

/// The unit of a text that marks it: in brackets, after a sign, or else any text in square brackets, which contain a unit by
/// custom. Round ones may contain anything: `Force (filtered)`.
fn marked<'t>(text: &'t str, in_brackets: &[Marked<'t>]) -> Option<Marked<'t>> {
    for is_it in [spelling::is_quantity, spelling::is_unit] {
        if let Some(found) = in_brackets.iter().find(|found| is_it(found.unit)) {
            return Some(*found);
        }
    }
    let is_open = |name: &str| {
        let count = |sign: char| name.matches(sign).count();
        BRACKETS
            .iter()
            .any(|&[open, close]| count(open) > count(close))
    };
    for (separator, _) in text.match_indices(['/', ',', ';']) {
        let unit = text[separator + 1..].trim();
        if unit.len() > spelling::longest() || !spelling::is_unit(unit) {
            continue;
        }
        let name = text[..separator].trim();
        if name.is_empty() {
            continue;
        }
        // `velocity_mm/s` is not a `velocity_mm` in seconds.
        let whole = name
            .rsplit(['_', ' '])
            .next()
            .is_some_and(|last| spelling::is_unit(&format!("{last}/{unit}")));
        if !whole && !is_open(name) {
            return Some(Marked {
                before: name,
                unit,
                behind: "",
                is_square: false,
            });
        }
    }
    // Square brackets come first.
    in_brackets.first().copied().filter(|found| found.is_square)
}

/// Possible second units: another marked one, and the words after the first.
fn others(rest: &str, behind: &str) -> Vec<String> {
    let second = marked(rest, &bracketed(rest)).map(|found| found.unit.to_owned());
    let is_end = |c: char| c.is_whitespace() || "()[]{}<>,;".contains(c);
    let words = behind.split(is_end).filter(|word| !word.is_empty());
    second.into_iter().chain(words.map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_units_are_told_apart() {
        for (text, words, marked) in [
            ("Time [s]", &["time"][..], Some("s")),
            ("Disp (mm)", &["disp"], Some("mm")),
            ("Kraft / kN", &["kraft"], Some("kN")),
            ("Force, kN", &["force"], Some("kN")),
            ("AxialForce", &["axial", "force"], None),
            ("AXIAL FORCE 2", &["axial", "force"], None),
            ("Force (filtered)", &["force", "filtered"], None),
            ("Stroke [furlong]", &["stroke"], Some("furlong")),
            ("Weg [mm] Soll", &["weg", "soll"], Some("mm")),
            (
                "Position (mm) (filtered)",
                &["position", "filtered"],
                Some("mm"),
            ),
            ("Force [top] (kN)", &["force", "top"], Some("kN")),
            ("[mm] Disp", &["disp"], Some("mm")),
            (
                "Time (HH:MM:SS,ms)",
                &["time", "hh", "mm", "ss", "ms"],
                None,
            ),
        ] {
            let name = Name::of(text);
            assert_eq!(name.words, Words::of(&words.join(" ")), "{text}");
            assert_eq!(name.marked.as_deref(), marked, "{text}");
        }
        let tails = |text: &str| Name::of(text).tails;
        let pair = |before: &str, tail: &str| Tail {
            text: tail.to_owned(),
            spelt: spelling::spelt(tail),
            before: Words::of(before),
        };
        assert_eq!(tails("Load_N"), [pair("load", "N")]);
        assert_eq!(
            tails("velocity_mm_s"),
            [pair("velocity", "mm_s"), pair("velocity mm", "s")]
        );
        assert_eq!(tails("F in kN"), [pair("f", "in kN"), pair("f", "kN")]);
        assert_eq!(
            tails("Weg in mm (absolut)"),
            [pair("weg absolut", "in mm"), pair("weg absolut", "mm")]
        );
        assert_eq!(Name::of("velocity_mm/s").marked, None);
        assert_eq!(tails("velocity_mm/s"), [pair("velocity", "mm/s")]);
        assert_eq!(Name::of("Time (s) / ms").others[0], "ms");
        assert_eq!(Name::of("Force [kN] -> N").others, ["-", "N"]);
        let long = format!("Force [kN] {}", "(/x ".repeat(1 << 20));
        assert_eq!(Name::of(&long).marked, None);
        assert_eq!(Name::of("Zaman (sn)").bracketed.as_deref(), Some("sn"));
    }
}
