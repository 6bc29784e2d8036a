//! Determines the decimal sign of the numbers in a text.

use mesh_damper_output::error::{InputError, Place, quoted};

use super::lines::Separator;
use super::numbers::{Numbers, Sign, sign_of};

/// Why the user must be asked for the decimal sign.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Asked {
    line: u64,
    cell: String,
    /// Another cell, with the other sign.
    other: Option<(u64, String)>,
}

impl Asked {
    pub fn refused(self, name: &str) -> InputError {
        let cell = quoted(&self.cell);
        let problem = match self.other {
            Some((line, other)) => format!(
                "{cell} and {} in line {line} use different signs, and one of the two is the decimal sign",
                quoted(&other)
            ),
            None => could_be_either(&self.cell),
        };
        InputError::new(name, problem, MEND)
            .at(Place::Line(self.line))
            .answered_by("--decimal SIGN")
    }
}

/// Advice for an ambiguous sign.
pub(super) const MEND: &str =
    "say which sign is the decimal one: --decimal point or --decimal comma";

/// Message that the sign of a cell is ambiguous.
pub(super) fn could_be_either(cell: &str) -> String {
    let cell = quoted(cell);
    format!("the sign in {cell} could be the decimal sign or a thousands separator")
}

/// A cell that is evidence, with its line.
type Shown<'c> = Option<(u64, &'c str)>;

/// Evidence of all cells of some rows; of each kind the first one.
#[derive(Default)]
struct Evidence<'c> {
    /// Cells with certainly a decimal point, and with certainly a decimal comma.
    sure: [Shown<'c>; 2],
    /// Cells with an ambiguous sign.
    either: [Shown<'c>; 2],
    /// Whether the point, or the comma, was seen to separate thousands.
    divides: [bool; 2],
}

/// The decimal sign of these rows.
pub(super) fn of(rows: &[(u64, Vec<&str>)], separator: Separator) -> Result<Numbers, Asked> {
    let mut evidence = Evidence::default();
    for (line, cells) in rows {
        cells.iter().for_each(|cell| evidence.take(*line, cell));
    }
    evidence.decided(separator)
}

/// The number format of these rows with the decimal sign given by the user: the other one separates thousands where this is its
/// only possible meaning.
pub(super) fn with_sign(rows: &[(u64, Vec<&str>)], decimal: char) -> Numbers {
    let mut evidence = Evidence::default();
    for (line, cells) in rows {
        cells.iter().for_each(|cell| evidence.take(*line, cell));
    }
    let other = 1 - index(decimal);
    Numbers {
        decimal,
        // Also if the first rows have none, because later rows may.
        has_thousands: evidence.sure[other].is_none() || evidence.divides[other],
        is_open: false,
    }
}

fn index(sign: char) -> usize {
    usize::from(sign == ',')
}

impl<'c> Evidence<'c> {
    fn take(&mut self, line: u64, cell: &'c str) {
        let here = (line, cell);
        match sign_of(cell) {
            None | Some(Sign::None) => {}
            Some(Sign::Sure(sign, has_thousands)) => {
                self.sure[index(sign)].get_or_insert(here);
                self.divides[1 - index(sign)] |= has_thousands;
            }
            Some(Sign::Thousands(sign)) => {
                self.sure[1 - index(sign)].get_or_insert(here);
                self.divides[index(sign)] = true;
            }
            Some(Sign::Either(sign)) => {
                self.either[index(sign)].get_or_insert(here);
            }
        }
    }

    fn decided(&self, separator: Separator) -> Result<Numbers, Asked> {
        let ask = |shown: (u64, &str), other: Shown| Asked {
            line: shown.0,
            cell: shown.1.to_owned(),
            other: other.map(|(line, cell)| (line, cell.to_owned())),
        };
        let [point, comma] = self.sure;
        if let (Some(point), Some(comma)) = (point, comma) {
            return Err(ask(point, Some(comma)));
        }
        for (sign, decimal) in [(0, '.'), (1, ',')] {
            let Some(sure) = self.sure[sign] else {
                continue;
            };
            let has_thousands = self.divides[1 - sign];
            return match self.either[1 - sign] {
                // Thousands, or another decimal sign in another column.
                Some(either) if !has_thousands => Err(ask(either, Some(sure))),
                _ => Ok(Numbers {
                    decimal,
                    has_thousands,
                    is_open: false,
                }),
            };
        }
        match self.either {
            [Some(point), Some(comma)] => Err(ask(point, Some(comma))),
            // With commas as separators a point is a decimal point, as in our own files.
            [Some(_), None] if separator == Separator::Sign(',') => Ok(Numbers::POINT),
            [Some(either), None] | [None, Some(either)] => Err(ask(either, None)),
            [None, None] => Ok(Numbers {
                is_open: separator != Separator::Sign(','),
                ..Numbers::POINT
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decided(cells: &[&str], separator: char) -> Result<Numbers, Asked> {
        of(&[(7, cells.to_vec())], Separator::Sign(separator))
    }

    #[test]
    fn a_sign_is_decided_by_what_cannot_be_otherwise() {
        let decimal = |cells: &[&str]| {
            decided(cells, ';').map(|numbers| (numbers.decimal, numbers.has_thousands))
        };
        for (cells, is) in [
            (&["0,5", "12"][..], Some((',', false))),
            (&["0.5", "1.234"], Some(('.', false))),
            (&["1,234", "0,5"], Some((',', false))),
            (&["1,234", "1,234.5"], Some(('.', true))),
            (&["1.234", "1.234,5"], Some((',', true))),
            (&["1,234,567"], Some(('.', true))),
            (&["1,234"], None),
            (&["1.234"], None),
            (&["1.234", "0,5"], None),
            (&["0.5", "0,5"], None),
            (&["1.234", "1,234"], None),
            (&["12", "3"], Some(('.', false))),
        ] {
            assert_eq!(decimal(cells).ok(), is, "{cells:?}");
        }
        assert_eq!(decided(&["1.234"], ','), Ok(Numbers::POINT));
        let asked = decided(&["1,234"], ';')
            .unwrap_err()
            .refused("a.csv")
            .to_string();
        assert!(
            asked.contains("line 7") && asked.contains("\"1,234\""),
            "{asked}"
        );
        assert!(
            asked.contains("--decimal point") && asked.contains("--decimal comma"),
            "{asked}"
        );
    }
}
