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
type Shown = Option<(u64, String)>;

/// Evidence of some cells; of each kind the first one.
#[derive(Clone, Debug, Default)]
pub(in crate::files) struct Evidence {
    /// Cells with certainly a decimal point, and with certainly a decimal comma.
    sure: [Shown; 2],
    /// Cells with an ambiguous sign.
    either: [Shown; 2],
    /// Whether the point, or the comma, was seen to separate thousands.
    divides: [bool; 2],
}

/// The decimal sign of these rows.
pub(super) fn of(rows: &[(u64, Vec<&str>)], separator: Separator) -> Result<Numbers, Asked> {
    Evidence::of(rows).decided(separator)
}

/// The number format of these rows with the decimal sign given by the user: the other one separates thousands where this is its
/// only possible meaning.
pub(super) fn with_sign(rows: &[(u64, Vec<&str>)], decimal: char) -> Numbers {
    let evidence = Evidence::of(rows);
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

impl Evidence {
    fn of(rows: &[(u64, Vec<&str>)]) -> Self {
        let mut evidence = Self::default();
        for (line, cells) in rows {
            for cell in cells {
                evidence.take(*line, cell);
            }
        }
        evidence
    }

    /// Takes the evidence of a cell, with its line. Returns the number of bytes that are kept of it.
    pub fn take(&mut self, line: u64, cell: &str) -> usize {
        let kept = match sign_of(cell) {
            None | Some(Sign::None) => return 0,
            Some(Sign::Sure(sign, has_thousands)) => {
                self.divides[1 - index(sign)] |= has_thousands;
                &mut self.sure[index(sign)]
            }
            Some(Sign::Thousands(sign)) => {
                self.divides[index(sign)] = true;
                &mut self.sure[1 - index(sign)]
            }
            Some(Sign::Either(sign)) => &mut self.either[index(sign)],
        };
        if kept.is_some() {
            return 0;
        }
        *kept = Some((line, cell.to_owned()));
        cell.len()
    }

    /// The evidence of these cells, and of others after them.
    pub fn and(self, other: Self) -> Self {
        let first = |[a, b]: [Shown; 2], [c, d]: [Shown; 2]| [a.or(c), b.or(d)];
        Self {
            sure: first(self.sure, other.sure),
            either: first(self.either, other.either),
            divides: [0, 1].map(|sign| self.divides[sign] || other.divides[sign]),
        }
    }

    pub(super) fn decided(self, separator: Separator) -> Result<Numbers, Asked> {
        let ask = |(line, cell): (u64, String), other: Shown| Asked { line, cell, other };
        let (point, comma) = match self.sure {
            [Some(point), Some(comma)] => return Err(ask(point, Some(comma))),
            [point, comma] => (point, comma),
        };
        let sure = match (point, comma) {
            (Some(point), _) => Some((0, '.', point)),
            (None, Some(comma)) => Some((1, ',', comma)),
            (None, None) => None,
        };
        let mut either = self.either;
        if let Some((sign, decimal, sure)) = sure {
            let has_thousands = self.divides[1 - sign];
            return match either[1 - sign].take() {
                // Thousands, or another decimal sign in another column.
                Some(either) if !has_thousands => Err(ask(either, Some(sure))),
                _ => Ok(Numbers {
                    decimal,
                    has_thousands,
                    is_open: false,
                }),
            };
        }
        match either {
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
