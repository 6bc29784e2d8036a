//! A factor in a column's name. It does not say whether the values were multiplied by it or must be.

/// Words that announce a factor.
const WORDS: [&str; 9] = [
    "scaled",
    "factor",
    "thousand",
    "thousands",
    "million",
    "millions",
    "skaliert",
    "faktor",
    "tausend",
];

/// A scale as written: `x1000`, `×10`, `*1e3`, `10^3`, `10³`, `1e-3`, `/1000`, `in thousands`.
pub(super) fn scale(text: &str) -> Option<&str> {
    let mut words = text.split(|c: char| !c.is_alphabetic());
    let is_scale = |word: &&str| WORDS.iter().any(|each| word.eq_ignore_ascii_case(each));
    words.find(is_scale).or_else(|| in_figures(text))
}

fn in_figures(text: &str) -> Option<&str> {
    text.char_indices().find_map(|(at, sign)| {
        let before = &text[..at];
        let behind = &text[at + sign.len_utf8()..];
        let is_it = match sign {
            '×' | '✕' | '*' | '·' | '⋅' => begins(behind) || ends(before),
            // `x1 [mm]` is a name; `MX840A` is a device.
            'x' | 'X' => {
                let is_alone = !before.ends_with(char::is_alphanumeric);
                let has_word = before.chars().any(char::is_alphabetic);
                (is_alone && has_word && begins(behind))
                    || (ends(before) && !behind.starts_with(char::is_alphanumeric))
            }
            '^' | '⁻' | '²' | '³' | '⁴' | '⁵' | '⁶' => {
                ends(before) && before.ends_with("10")
            }
            'e' | 'E' => {
                let power = behind.strip_prefix(['+', '-']).unwrap_or(behind);
                ends(before) && begins(power) && !behind.starts_with(' ')
            }
            '/' => number(behind).is_some_and(is_power),
            _ => false,
        };
        is_it.then(|| around(text, at))
    })
}

/// The number at the beginning of a text, if no letter follows: `2kN` is the range of a sensor.
fn number(text: &str) -> Option<&str> {
    let text = text.trim_start();
    let end = text.find(|c: char| !(c.is_ascii_digit() || ".,".contains(c)));
    let (number, behind) = text.split_at(end.unwrap_or(text.len()));
    let is_power = |behind: &str| {
        let power = behind.strip_prefix(['e', 'E']).unwrap_or_default();
        let power = power.strip_prefix(['+', '-']).unwrap_or(power);
        power.starts_with(|c: char| c.is_ascii_digit())
    };
    let is_whole = !behind.starts_with(char::is_alphabetic) || is_power(behind);
    (is_whole && number.bytes().any(|byte| byte.is_ascii_digit())).then_some(number)
}

fn begins(text: &str) -> bool {
    number(text).is_some()
}

/// Whether a text ends in a number that does not follow a letter: `CH1` is a name.
fn ends(text: &str) -> bool {
    let head = text.trim_end_matches(|c: char| c.is_ascii_digit() || ".,".contains(c));
    let number = &text[head.len()..];
    number.bytes().any(|byte| byte.is_ascii_digit()) && !head.ends_with(char::is_alphabetic)
}

/// Ten or a power of it.
fn is_power(number: &str) -> bool {
    let zeros = number.strip_prefix('1').unwrap_or_default();
    !zeros.is_empty() && zeros.bytes().all(|byte| byte == b'0')
}

/// The text about a position, up to blanks and brackets; after a sign that stands alone, the next word too.
fn around(text: &str, at: usize) -> &str {
    let is_end = |c: char| c.is_whitespace() || "()[]{}<>_".contains(c);
    let begin = text[..at].trim_end_matches(|c: char| !is_end(c)).len();
    let word = |from: usize| {
        text[from..]
            .find(is_end)
            .map_or(text.len(), |end| from + end)
    };
    let end = word(at);
    let is_alone = text[begin..end].chars().count() == 1;
    let next = text.len() - text[end..].trim_start().len();
    &text[begin..if is_alone { word(next) } else { end }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_is_told_from_a_name_and_a_unit() {
        for (text, is) in [
            ("Force [N] (x1000)", "x1000"),
            ("Force (N) x10^3", "x10^3"),
            ("Force x10 [N]", "x10"),
            ("Force x 10 [N]", "x 10"),
            ("Force [N] ×0,1", "×0,1"),
            ("Force*1000 [N]", "Force*1000"),
            ("Force [N] 10³", "10³"),
            ("Force [N] (1e-3)", "1e-3"),
            ("Force_N_x100", "x100"),
            ("Force /100 [N]", "/100"),
            ("Force 1000x [N]", "1000x"),
            ("Force [N] in thousands", "thousands"),
            ("Force kN (Scaled)", "Scaled"),
        ] {
            assert_eq!(scale(text), Some(is), "{text}");
        }
        for text in [
            "x [mm]",
            "x1 [mm]",
            "MX840A CH 1 Weg [mm]",
            "U9B/2kN [kN]",
            "a [m/s^2]",
            "v [mm*s^-1]",
            "mm·s-1",
            "M [N·m]",
            "Load(8800 (0,1):Load) (kN)",
            "Force 2 [kN]",
            "Force/kN",
            "Axis 10 [mm]",
            "Line 3 [mm]",
        ] {
            assert_eq!(scale(text), None, "{text}");
        }
    }
}
