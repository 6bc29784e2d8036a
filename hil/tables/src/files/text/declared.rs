//! Statements of a text about itself in its first lines.

use super::lines::Separator;

/// Signs that a text declares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Declared {
    pub separator: Option<Separator>,
    pub decimal: Option<char>,
    /// A LabVIEW measurement file.
    pub is_lvm: bool,
    /// A workbook's sheet, whose cells need no separator.
    pub is_sheet: bool,
}

impl Declared {
    /// From the lines at a text's beginning: Excel's `sep=;`, MTS's first line, and the header of a LabVIEW measurement file.
    pub fn of(text: &str) -> Self {
        let mut lines = text
            .split(['\n', '\r'])
            .map(str::trim)
            .filter(|line| !line.is_empty());
        let first = lines.next().unwrap_or_default();
        if let Some(separator) = excel(first) {
            return Self {
                separator: Some(separator),
                ..Self::default()
            };
        }
        if first.starts_with("MTS793|") {
            // Program, application, language, two versions, decimal sign, signs of dates and times; tabs separate the cells.
            let sign = first.split('|').nth(5).and_then(decimal);
            return Self {
                separator: Some(Separator::Sign('\t')),
                decimal: sign,
                ..Self::default()
            };
        }
        if first.starts_with("LabVIEW Measurement") {
            return lvm(lines);
        }
        Self::default()
    }

    /// Whether a text declares anything.
    pub fn is_said(&self) -> bool {
        *self != Self::default()
    }
}

fn excel(line: &str) -> Option<Separator> {
    let bare = line.trim_matches('"');
    let (key, sign) = bare.split_at_checked(4)?;
    let mut signs = sign.chars();
    let sign = signs.next()?;
    let is_it = key.eq_ignore_ascii_case("sep=") && signs.next().is_none();
    is_it.then_some(Separator::Sign(sign))
}

fn decimal(text: &str) -> Option<char> {
    match text.trim() {
        "." => Some('.'),
        "," => Some(','),
        _ => None,
    }
}

/// The header of a LabVIEW measurement file. Its defaults are those of the format's documentation: tabs and points.
fn lvm<'t>(lines: impl Iterator<Item = &'t str>) -> Declared {
    let mut declared = Declared {
        separator: Some(Separator::Sign('\t')),
        decimal: Some('.'),
        is_lvm: true,
        ..Declared::default()
    };
    for line in lines.take_while(|line| !line.starts_with("***End_of_Header***")) {
        let of = |key: &str| line.strip_prefix(key).map(|rest| rest.trim_end());
        if let Some(value) = of("Separator") {
            declared.separator = match value.trim_start_matches(['\t', ',', ' ']).trim() {
                "Comma" => Some(Separator::Sign(',')),
                _ => Some(Separator::Sign('\t')),
            };
        } else if let Some(value) = of("Decimal_Separator") {
            // The sign follows the separator, which may be a comma too.
            declared.decimal = value
                .chars()
                .last()
                .and_then(|sign| decimal(&sign.to_string()))
                .or(Some('.'));
        }
    }
    declared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_lines_say_signs() {
        let tab = Some(Separator::Sign('\t'));
        for (text, separator, decimal) in [
            ("sep=;\n1;2", Some(Separator::Sign(';')), None),
            ("\"SEP=|\"\r\n1|2", Some(Separator::Sign('|')), None),
            ("MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n", tab, Some('.')),
            ("MTS793|MPT|DEU|1|2|,|.|:|49|1|1|A\n", tab, Some(',')),
            (
                "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\n***End_of_Header***\n",
                tab,
                Some(','),
            ),
            (
                "LabVIEW Measurement,\nSeparator,Comma\nDecimal_Separator,.\n",
                Some(Separator::Sign(',')),
                Some('.'),
            ),
            ("time_s,force_kN\n", None, None),
            ("sep=\n", None, None),
        ] {
            let declared = Declared::of(text);
            assert_eq!(
                (declared.separator, declared.decimal),
                (separator, decimal),
                "{text}"
            );
        }
    }
}
