//! A column's name: its words, its unit, and a scale.

use super::scale::scale;
use super::spelling;

/// Parts of a column's name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Name {
    /// Its words in lower case, with `AxialForce` split in two and digits left out; without a marked unit and the words after it.
    pub words: Vec<String>,
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
    /// The words before them.
    pub before: Vec<String>,
}

/// A marked unit, and the text before and after it.
struct Marked<'t> {
    before: &'t str,
    unit: &'t str,
    behind: &'t str,
    is_square: bool,
}

/// Length of a name in bytes within which a unit is searched for, which takes time in proportion to its square. Convention: no name
/// of a column is longer.
const LONGEST: usize = 256;

const BRACKETS: [[char; 2]; 4] = [['[', ']'], ['(', ')'], ['{', '}'], ['<', '>']];

impl Name {
    /// Splits a name into its parts.
    pub fn of(text: &str) -> Self {
        let text = text.trim().trim_matches('"').trim();
        if text.len() > LONGEST {
            return Self {
                words: words(text),
                ..Self::default()
            };
        }
        let scale = scale(text).map(str::to_owned);
        if let Some(found) = marked(text) {
            let rest = format!("{} {}", found.before, found.behind);
            return Self {
                words: words(&rest),
                others: others(&rest, found.behind),
                marked: Some(found.unit.to_owned()),
                scale,
                ..Self::default()
            };
        }
        // `Weg in mm (absolut)`: text in brackets at the end of a name belongs to it.
        let (head, remark) = match bracketed(text).first() {
            Some(last) if last.behind.is_empty() => (last.before, words(last.unit)),
            _ => (text, Vec::new()),
        };
        let mut tails = Vec::new();
        for separators in [&['_', ' ', '-'][..], &['.']] {
            // `velocity_mm_s`: two words may be one unit.
            let mut cuts: Vec<usize> = head.match_indices(separators).map(|(at, _)| at).collect();
            cuts.reverse();
            let last = cuts.iter().take(2).rev();
            tails.extend(last.map(|&at| {
                Tail {
                    text: head[at + 1..].trim().to_owned(),
                    before: before(&head[..at])
                        .into_iter()
                        .chain(remark.clone())
                        .collect(),
                }
            }));
        }
        let bracketed = bracketed(text).first().map(|found| found.unit.to_owned());
        Self {
            words: words(text),
            scale,
            bracketed,
            tails,
            ..Self::default()
        }
    }
}

/// The words before a unit, without an `in` before it.
fn before(text: &str) -> Vec<String> {
    let mut words = words(text);
    if words.len() > 1 && words.last().is_some_and(|last| last == "in") {
        words.pop();
    }
    words
}

/// Texts in brackets, one kind of brackets after the other, each from the last on.
fn bracketed(text: &str) -> Vec<Marked<'_>> {
    let kinds = BRACKETS.into_iter().flat_map(|[open, close]| {
        text.rmatch_indices(open).filter_map(move |(begin, _)| {
            let length = text[begin..].find(close)?;
            Some(Marked {
                before: text[..begin].trim(),
                unit: text[begin + 1..begin + length].trim(),
                behind: text[begin + length + close.len_utf8()..].trim(),
                is_square: open == '[',
            })
        })
    });
    kinds.filter(|found| !found.unit.is_empty()).collect()
}

/// The unit of a text that marks it: in brackets, after a sign, or else any text in square brackets, which contain a unit by
/// custom. Round ones may contain anything: `Force (filtered)`.
fn marked(text: &str) -> Option<Marked<'_>> {
    let mut in_brackets = bracketed(text);
    for is_it in [spelling::is_quantity, spelling::is_unit] {
        if let Some(index) = in_brackets.iter().position(|found| is_it(found.unit)) {
            return Some(in_brackets.swap_remove(index));
        }
    }
    let is_open = |name: &str| {
        let count = |sign: char| name.matches(sign).count();
        BRACKETS
            .iter()
            .any(|&[open, close]| count(open) > count(close))
    };
    for (separator, _) in text.match_indices(['/', ',', ';']) {
        let (name, unit) = (text[..separator].trim(), text[separator + 1..].trim());
        // `velocity_mm/s` is not a `velocity_mm` in seconds.
        let whole = name
            .rsplit(['_', ' '])
            .next()
            .is_some_and(|last| spelling::is_unit(&format!("{last}/{unit}")));
        if !name.is_empty() && !whole && !is_open(name) && spelling::is_unit(unit) {
            return Some(Marked {
                before: name,
                unit,
                behind: "",
                is_square: false,
            });
        }
    }
    // Square brackets come first.
    in_brackets.truncate(1);
    in_brackets.pop().filter(|found| found.is_square)
}

/// Possible second units: another marked one, and the words after the first.
fn others(rest: &str, behind: &str) -> Vec<String> {
    let second = marked(rest).map(|found| found.unit.to_owned());
    let is_end = |c: char| c.is_whitespace() || "()[]{}<>,;".contains(c);
    let words = behind.split(is_end).filter(|word| !word.is_empty());
    second.into_iter().chain(words.map(str::to_owned)).collect()
}

/// The words of a text, in lower case.
pub(super) fn words(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for c in text.chars() {
        let is_inner = c.is_alphabetic();
        // `AxialForce`, and not `FORCE`.
        let begins = c.is_uppercase() && before.is_lowercase();
        if (!is_inner || begins) && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if is_inner && let Some(word) = words.last_mut() {
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    words.retain(|word| !word.is_empty());
    words
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
            assert_eq!(name.words, words, "{text}");
            assert_eq!(name.marked.as_deref(), marked, "{text}");
        }
        let tails = |text: &str| -> Vec<(String, String)> {
            let tails = Name::of(text).tails.into_iter();
            tails
                .map(|tail| (tail.before.join(" "), tail.text))
                .collect()
        };
        let pair = |before: &str, tail: &str| (before.to_owned(), tail.to_owned());
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
