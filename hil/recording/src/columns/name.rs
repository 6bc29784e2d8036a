//! A column's name: its words, and the unit that stands in it.

use super::spelling;

/// What a column's name holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Name {
    /// Its words in lower case, those of `AxialForce` apart, digits left out; without a unit that is marked.
    pub words: Vec<String>,
    /// A unit that is marked as one: `[kN]`, `(kN)`, `/ kN`, `, kN`.
    pub marked: Option<String>,
    /// The last words, which may be a unit, each with the words before it: `Load_N`, `speed mm/s`, `F in kN`; the longest first.
    pub tails: Vec<Tail>,
}

/// The last words of a name, which may be a unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tail {
    /// As they are written.
    pub text: String,
    /// The words before them.
    pub before: Vec<String>,
}

impl Name {
    /// Takes a name apart.
    pub fn of(text: &str) -> Self {
        let text = text.trim().trim_matches('"').trim();
        if let Some((name, unit)) = marked(text) {
            return Self {
                words: words(name),
                marked: Some(unit.to_owned()),
                tails: Vec::new(),
            };
        }
        let mut tails = Vec::new();
        for separators in [&['_', ' ', '-'][..], &['.']] {
            // `velocity_mm_s`: two words may be one unit.
            let mut cuts: Vec<usize> = text.match_indices(separators).map(|(at, _)| at).collect();
            cuts.reverse();
            let last = cuts.iter().take(2).rev();
            tails.extend(last.map(|&at| Tail {
                text: text[at + 1..].trim().to_owned(),
                before: before(&text[..at]),
            }));
        }
        Self {
            words: words(text),
            marked: None,
            tails,
        }
    }
}

/// The words before a unit, without the `in` that leads to it.
fn before(text: &str) -> Vec<String> {
    let mut words = words(text);
    if words.len() > 1 && words.last().is_some_and(|last| last == "in") {
        words.pop();
    }
    words
}

/// The name and the unit of a text that marks the unit.
fn marked(text: &str) -> Option<(&str, &str)> {
    let is_unit = |unit: &str| spelling::is_unit(unit);
    for [open, close] in [['[', ']'], ['(', ')'], ['{', '}'], ['<', '>']] {
        if let Some(begin) = text.rfind(open)
            && let Some(length) = text[begin..].find(close)
        {
            let unit = text[begin + 1..begin + length].trim();
            // Square brackets hold a unit by custom, round ones anything: `Force (filtered)`.
            if is_unit(unit) || (open == '[' && !unit.is_empty()) {
                return Some((text[..begin].trim(), unit));
            }
        }
    }
    for (separator, _) in text.match_indices(['/', ',', ';']) {
        let (name, unit) = (text[..separator].trim(), text[separator + 1..].trim());
        // `velocity_mm/s` is no velocity_mm in seconds.
        let whole = name
            .rsplit(['_', ' '])
            .next()
            .is_some_and(|last| is_unit(&format!("{last}/{unit}")));
        if !name.is_empty() && !whole && is_unit(unit) {
            return Some((name, unit));
        }
    }
    None
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
        assert_eq!(Name::of("velocity_mm/s").marked, None);
        assert_eq!(tails("velocity_mm/s"), [pair("velocity", "mm/s")]);
    }
}
