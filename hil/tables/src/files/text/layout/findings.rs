//! The findings about a text in words, so that a person can contradict them.

use super::super::header::Header;
use super::super::numbers::Numbers;
use super::block::FEW_ROWS;
use super::{Found, Kind};
use crate::csv_text::is_blank;

impl Found<'_> {
    /// The findings, in words.
    pub(super) fn findings(&self, numbers: Numbers, header: &Header) -> Vec<String> {
        let sign = if numbers.decimal == ',' {
            "comma"
        } else {
            "point"
        };
        let mut findings = Vec::new();
        let is_shown = self.reading.decimal.is_some() || !numbers.is_open;
        let thousands = if numbers.has_thousands && self.reading.decimal.is_none() {
            let other = if numbers.decimal == ',' {
                "a point"
            } else {
                "a comma"
            };
            format!(", and {other} separates thousands")
        } else {
            String::new()
        };
        let by = self.separator.name();
        if !self.declared.is_sheet {
            findings.push(if is_shown {
                format!("cells are separated by {by}, the decimal sign is a {sign}{thousands}")
            } else {
                format!("cells are separated by {by}")
            });
        }
        if let Some(line) = header.line {
            let below = match header.units_line {
                Some(units) => format!(", the units in line {units}"),
                None => String::new(),
            };
            let how = if header.is_comment {
                ", which is a comment"
            } else {
                ""
            };
            if line > 1 || header.units_line.is_some() || header.is_comment {
                findings.push(format!("the names are in line {line}{how}{below}"));
            }
        }
        if !header.passed.is_empty() {
            let lines: Vec<String> = header.passed.iter().map(u64::to_string).collect();
            findings.push(format!(
                "words below the names are not read: line {}",
                lines.join(", ")
            ));
        }
        if self.block.passed > 0 {
            findings.push(format!(
                "{} rows of numbers above line {} are not read",
                self.block.passed,
                self.data_line()
            ));
        }
        findings
    }

    /// Note that the first row of numbers may not be a sample, if it alone has only whole numbers: offsets or factors of the
    /// columns.
    pub(super) fn first_is_whole(
        &self,
        samples: &[(u64, Vec<&str>)],
        kinds: &[Kind],
    ) -> Option<String> {
        let numbers_of = |row: &[&str]| -> Vec<bool> {
            let each = row.iter().zip(kinds);
            let each = each.filter(|(cell, kind)| **kind == Kind::Numbers && !is_blank(cell));
            each.map(|(cell, _)| cell.bytes().all(|byte| b"+-0123456789".contains(&byte)))
                .collect()
        };
        let [(line, first), rest @ ..] = samples else {
            return None;
        };
        let whole = numbers_of(first);
        let is_alone = whole.len() > 1
            && whole.iter().all(|is_whole| *is_whole)
            && rest.len() >= FEW_ROWS
            && rest.iter().all(|(_, row)| !numbers_of(row).contains(&true));
        is_alone.then(|| {
            format!(
                "the first row of numbers, line {line}, is read as a sample, although only it has no decimals; if it holds offsets or factors, delete it"
            )
        })
    }
}
