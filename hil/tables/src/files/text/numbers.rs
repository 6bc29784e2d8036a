//! Numbers in the forms of different countries.

use crate::csv_text::is_blank;

/// The number format of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Numbers {
    /// The decimal sign, `.` or `,`.
    pub decimal: char,
    /// Whether the other of the two may separate thousands where a cell alone does not prove it.
    pub has_thousands: bool,
    /// Whether no number showed the decimal sign: an ambiguous number is then rejected.
    pub is_open: bool,
}

impl Numbers {
    /// With a point, as in our own files.
    pub const POINT: Self = Self {
        decimal: '.',
        has_thousands: false,
        is_open: false,
    };
}

/// Contents of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// A finite number.
    Number(f64),
    /// A sign for a missing number.
    Blank,
    /// A number that f64 cannot represent.
    NotFinite,
    /// A number with the other decimal sign, or with one that could also separate thousands.
    OtherSign,
    /// Anything else.
    Words,
}

/// Evidence of a cell's signs about the decimal sign of its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    /// A whole number, which is no evidence.
    None,
    /// This is certainly the decimal sign; and whether the other separates thousands in it.
    Sure(char, bool),
    /// This certainly separates thousands, in a whole number.
    Thousands(char),
    /// This may be either: `1,234`.
    Either(char),
}

impl Numbers {
    /// Contents of `cell`, without the blanks around it.
    pub fn read(self, cell: &str) -> Cell {
        // If no number showed the sign, one with a point may have thousands.
        if self.decimal == '.'
            && !(self.is_open && cell.contains('.'))
            && let Ok(value) = cell.parse::<f64>()
        {
            return finite(value);
        }
        if is_blank(cell) {
            return Cell::Blank;
        }
        match parts(cell) {
            Some(parts) => self.of_parts(&parts),
            None => match cell.parse::<f64>() {
                Ok(value) => finite(value),
                Err(_) => Cell::Words,
            },
        }
    }

    fn of_parts(self, parts: &Parts) -> Cell {
        let other = if self.decimal == '.' { ',' } else { '.' };
        let is_decimal = |sign: char| sign == self.decimal;
        match parts.sign() {
            Sign::None => parts.value(None),
            Sign::Sure(sign, _) if is_decimal(sign) => parts.value(Some(sign)),
            Sign::Thousands(sign) if !is_decimal(sign) => parts.value(None),
            Sign::Either(sign) if is_decimal(sign) && !self.is_open => parts.value(Some(sign)),
            Sign::Either(sign) if sign == other && self.has_thousands => parts.value(None),
            _ => Cell::OtherSign,
        }
    }
}

fn finite(value: f64) -> Cell {
    if value.is_nan() {
        return Cell::Blank;
    }
    if value.is_finite() {
        Cell::Number(value)
    } else {
        Cell::NotFinite
    }
}

/// Evidence of the signs in a cell, if it is a number.
pub(super) fn sign_of(cell: &str) -> Option<Sign> {
    parts(cell).map(|parts| parts.sign())
}

/// Whether a cell is a number with any decimal sign; `may_group` if blanks may separate its thousands.
pub(super) fn is_number(cell: &str, may_group: bool) -> bool {
    parts(cell).is_some_and(|parts| may_group || !parts.groups_with_blanks)
}

/// Whether the digits of a whole number begin with a zero that is not its only digit: such digits are the decimals of a number
/// split at its comma.
pub(super) fn is_padded(cell: &str) -> bool {
    let digits = cell.trim_start_matches(['-', '+']);
    digits.len() > 1 && digits.starts_with('0') && digits.bytes().all(|b| b.is_ascii_digit())
}

/// The parts of a number.
struct Parts<'c> {
    is_negative: bool,
    /// Digits with points and commas, without other thousands separators.
    digits: std::borrow::Cow<'c, str>,
    exponent: &'c str,
    /// Whether thousands had another separator.
    groups_with_blanks: bool,
    /// Whether it was a blank or an apostrophe.
    has_groups: bool,
}

/// Blanks and apostrophes that separate thousands.
const GROUPING: [char; 6] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '\u{2019}'];

fn parts(cell: &str) -> Option<Parts<'_>> {
    let (is_negative, rest) = match cell.chars().next()? {
        '-' | '\u{2212}' => (true, &cell[cell.chars().next()?.len_utf8()..]),
        '+' => (false, &cell[1..]),
        _ => (false, cell),
    };
    // Fortran writes a D in a number of double precision; without a sign in it `2D3` is a name.
    let is_double = |end: &usize| rest[..*end].contains(['.', ',']);
    let end = rest.find(['e', 'E']);
    let end = end.or(rest.find(['d', 'D']).filter(is_double));
    let (mantissa, exponent) = rest.split_at(end.unwrap_or(rest.len()));
    if !exponent.is_empty() {
        let digits = exponent[1..]
            .strip_prefix(['+', '-'])
            .unwrap_or(&exponent[1..]);
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
    }
    let has_groups = mantissa.contains(GROUPING);
    if has_groups {
        let whole = &mantissa[..mantissa.find(['.', ',']).unwrap_or(mantissa.len())];
        if mantissa[whole.len()..].contains(GROUPING) || !are_groups(whole, &GROUPING) {
            return None;
        }
    }
    let plain = |byte: u8| byte.is_ascii_digit() || byte == b'.' || byte == b',';
    let digits: std::borrow::Cow<str> = if has_groups {
        mantissa
            .chars()
            .filter(|c| !GROUPING.contains(c))
            .collect::<String>()
            .into()
    } else {
        mantissa.into()
    };
    if !digits.bytes().all(plain) || !digits.bytes().any(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let parts = Parts {
        is_negative,
        digits,
        exponent,
        groups_with_blanks: mantissa.contains(char::is_whitespace),
        has_groups,
    };
    parts.is_number().then_some(parts)
}

/// Whether the digits form groups of three between the same sign, with one to three before the first.
fn are_groups(text: &str, signs: &[char]) -> bool {
    let mut used = text.chars().filter(|c| signs.contains(c));
    let Some(sign) = used.next() else {
        return false;
    };
    if used.any(|other| other != sign) {
        return false;
    }
    let mut groups = text.split(sign);
    let first = groups.next().unwrap_or_default();
    let are_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&first.len())
        && are_digits(first)
        && groups.all(|group| group.len() == 3 && are_digits(group))
}

impl Parts<'_> {
    fn count(&self, sign: char) -> usize {
        self.digits.matches(sign).count()
    }

    /// Whether its points and commas are in valid positions.
    fn is_number(&self) -> bool {
        let (points, commas) = (self.count('.'), self.count(','));
        match (points, commas) {
            (0 | 1, 0) | (0, 1) => true,
            (_, 0) => are_groups(&self.digits, &['.']),
            (0, _) => are_groups(&self.digits, &[',']),
            // The last sign is the decimal one.
            _ => self.is_grouped_before(',', '.') || self.is_grouped_before('.', ','),
        }
    }

    fn is_grouped_before(&self, decimal: char, group: char) -> bool {
        let Some((whole, fraction)) = self.digits.split_once(decimal) else {
            return false;
        };
        !self.has_groups && !fraction.contains(group) && are_groups(whole, &[group])
    }

    fn sign(&self) -> Sign {
        let (points, commas) = (self.count('.'), self.count(','));
        match (points, commas) {
            (0, 0) => Sign::None,
            (1, 0) => self.either('.'),
            (0, 1) => self.either(','),
            (_, 0) => Sign::Thousands('.'),
            (0, _) => Sign::Thousands(','),
            _ if self.is_grouped_before(',', '.') => Sign::Sure(',', true),
            _ => Sign::Sure('.', true),
        }
    }

    /// For a single sign: thousands have three digits after it, one to three before, no leading zero, and no exponent.
    fn either(&self, sign: char) -> Sign {
        let could_group = !self.has_groups
            && self.exponent.is_empty()
            && !self.digits.starts_with('0')
            && are_groups(&self.digits, &[sign]);
        if could_group {
            Sign::Either(sign)
        } else {
            Sign::Sure(sign, false)
        }
    }

    /// Its value with this decimal sign.
    fn value(&self, decimal: Option<char>) -> Cell {
        let mut text = String::with_capacity(self.digits.len() + self.exponent.len() + 1);
        if self.is_negative {
            text.push('-');
        }
        for sign in self.digits.chars() {
            match sign {
                sign if Some(sign) == decimal => text.push('.'),
                '.' | ',' => {}
                digit => text.push(digit),
            }
        }
        if let Some(power) = self.exponent.get(1..) {
            text.push('e');
            text.push_str(power);
        }
        text.parse::<f64>().map_or(Cell::Words, finite)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_say_what_they_can() {
        for (cell, sign) in [
            ("12", Some(Sign::None)),
            ("0,125", Some(Sign::Sure(',', false))),
            ("-0.5", Some(Sign::Sure('.', false))),
            ("1,5", Some(Sign::Sure(',', false))),
            ("1234,567", Some(Sign::Sure(',', false))),
            ("1,234", Some(Sign::Either(','))),
            ("-12.345", Some(Sign::Either('.'))),
            ("1,234E+02", Some(Sign::Sure(',', false))),
            ("1.234,5", Some(Sign::Sure(',', true))),
            ("1,234.5", Some(Sign::Sure('.', true))),
            ("1,234,567", Some(Sign::Thousands(','))),
            ("1 234,5", Some(Sign::Sure(',', false))),
            ("1'234.567", Some(Sign::Sure('.', false))),
            ("-1.0D+03", Some(Sign::Sure('.', false))),
            ("2D3", None),
            ("12,34,567", None),
            ("1.2.3", None),
            ("1 23", None),
            ("e5", None),
            ("5e", None),
            (".", None),
            ("abc", None),
        ] {
            assert_eq!(sign_of(cell), sign, "{cell}");
        }
    }

    #[test]
    fn a_number_is_read_as_its_country_means_it_or_not_at_all() {
        let comma = Numbers {
            decimal: ',',
            ..Numbers::POINT
        };
        let thousands = Numbers {
            has_thousands: true,
            ..comma
        };
        let open = Numbers {
            is_open: true,
            ..Numbers::POINT
        };
        for (numbers, cell, is) in [
            (comma, "-0,125", Cell::Number(-0.125)),
            (comma, "\u{2212}1,5e-3", Cell::Number(-1.5e-3)),
            (comma, "1.234,5", Cell::Number(1234.5)),
            (comma, "1.234", Cell::OtherSign),
            (comma, "0.5", Cell::OtherSign),
            (comma, "1,234", Cell::Number(1.234)),
            (thousands, "1.234", Cell::Number(1234.0)),
            (thousands, "0.5", Cell::OtherSign),
            (comma, "1 234,5", Cell::Number(1234.5)),
            (Numbers::POINT, "1,234.5", Cell::Number(1234.5)),
            (Numbers::POINT, "1,234", Cell::OtherSign),
            (Numbers::POINT, "0,5", Cell::OtherSign),
            (Numbers::POINT, ".5", Cell::Number(0.5)),
            (open, "1,234", Cell::OtherSign),
            (open, "2.400", Cell::OtherSign),
            (open, "-0.5", Cell::Number(-0.5)),
            (open, "24", Cell::Number(24.0)),
            (Numbers::POINT, "-1.5D+03", Cell::Number(-1500.0)),
            (comma, "1,5d-1", Cell::Number(0.15)),
            (open, "1,234,567", Cell::Number(1_234_567.0)),
            (comma, "", Cell::Blank),
            (comma, "N/A", Cell::Blank),
            (comma, "NaN", Cell::Blank),
            (comma, "1e999", Cell::NotFinite),
            (comma, "-inf", Cell::NotFinite),
            (comma, "12 mm", Cell::Words),
        ] {
            assert_eq!(numbers.read(cell), is, "{cell} {numbers:?}");
        }
    }
}
