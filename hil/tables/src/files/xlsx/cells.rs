//! The cells of a sheet, one after the other.

use std::borrow::Cow;

use mesh_damper_output::error::InputError;
use quick_xml::events::Event;

use super::NAME;
use super::book::{Book, append, read_text, resolve, without_escapes};
use super::parts::{Xml, attributes};
use crate::files::guard::damaged;
use crate::room::Room;

/// The value of a cell.
#[derive(Debug, PartialEq)]
pub(super) enum Value<'c> {
    Number(f64),
    /// Days after 30 December 1899.
    Date(f64),
    Text(&'c str),
    /// No value, or an error such as a division by zero.
    None,
}

/// A cell: its row and column, counted from 0, and its value.
pub(super) type Cell<'c> = (u32, u32, Value<'c>);

/// The cells of a sheet.
pub(super) struct Cells<'s> {
    xml: Xml<'s>,
    book: &'s Book,
    row: u32,
    column: u32,
    /// The text of the last cell.
    text: String,
    room: Room<'s>,
}

impl<'s> Cells<'s> {
    /// From the beginning of a sheet's part; `None` if it has no cells, as that of a chart.
    ///
    /// # Errors
    /// A damaged part.
    pub fn of(mut xml: Xml<'s>, book: &'s Book) -> Result<Option<Self>, InputError> {
        loop {
            match xml.next()? {
                Event::Start(e) if e.local_name().as_ref() == b"sheetData" => break,
                Event::Eof => return Ok(None),
                _ => {}
            }
        }
        Ok(Some(Self {
            room: xml.room(),
            xml,
            book,
            row: 0,
            column: 0,
            text: String::new(),
        }))
    }

    /// The next cell; `None` at the end.
    ///
    /// # Errors
    /// A damaged part.
    pub fn next(&mut self) -> Result<Option<Cell<'_>>, InputError> {
        let name = self.xml.name();
        let broken = |why: String| damaged(NAME, name, why);
        loop {
            match self.xml.next()? {
                Event::Start(e) => match e.local_name().as_ref() {
                    b"row" => {
                        if let [Some(row)] = attributes(&e, ["r"]).map_err(broken)? {
                            let (row, _) = place(&row).ok_or_else(|| misplaced(name, &row))?;
                            self.row = row;
                        }
                    }
                    b"c" => {
                        let [at, style, kind] = attributes(&e, ["r", "s", "t"]).map_err(broken)?;
                        let row = match at {
                            Some(at) => {
                                let placed =
                                    place(&at).and_then(|(row, column)| Some((row, column?)));
                                let (row, column) = placed.ok_or_else(|| misplaced(name, &at))?;
                                self.column = column;
                                row
                            }
                            None => self.row,
                        };
                        let style =
                            style.and_then(|style| std::str::from_utf8(&style).ok()?.parse().ok());
                        let is_date = |style: usize| self.book.are_dates.get(style) == Some(&true);
                        let is_date = style.is_some_and(is_date);
                        let kind = Kind::of(kind.as_deref());
                        let column = self.column;
                        self.column = column.saturating_add(1);
                        let value = self.value(kind, is_date)?;
                        return Ok(Some((row, column, value)));
                    }
                    _ => {}
                },
                Event::End(e) => match e.local_name().as_ref() {
                    b"row" => {
                        self.row = self.row.saturating_add(1);
                        self.column = 0;
                    }
                    b"sheetData" => return Ok(None),
                    _ => {}
                },
                Event::Eof => return Err(broken("a sheet is cut".into())),
                _ => {}
            }
        }
    }

    /// The value of the cell whose begin was read.
    fn value(&mut self, kind: Kind, is_date: bool) -> Result<Value<'_>, InputError> {
        let name = self.xml.name();
        let broken = |why: String| damaged(NAME, name, why);
        self.text.clear();
        let mut has_value = false;
        loop {
            match self.xml.next()? {
                Event::Start(e) => match e.local_name().as_ref() {
                    // A value beside an inline text repeats it.
                    b"v" => has_value = kind != Kind::Inline,
                    b"is" => read_text(&mut self.xml, b"is", &mut self.text)?,
                    _ => {}
                },
                Event::Text(text) if has_value => append(&text, &mut self.text).map_err(broken)?,
                Event::CData(text) if has_value => {
                    let text = text
                        .xml10_content()
                        .map_err(|error| broken(error.to_string()))?;
                    self.text.push_str(&text);
                }
                Event::GeneralRef(entity) if has_value => {
                    resolve(&entity, &mut self.text).map_err(broken)?;
                }
                Event::End(e) => match e.local_name().as_ref() {
                    b"v" => has_value = false,
                    b"c" => break,
                    _ => {}
                },
                Event::Eof => return Err(broken("a cell is cut".into())),
                _ => {}
            }
        }
        if kind == Kind::Text
            && let Cow::Owned(plain) = without_escapes(&self.text)
        {
            self.text = plain;
        }
        let held = self.text.capacity() as u64;
        self.room.at_least(held, "the text of a cell")?;
        let text = self.text.as_str();
        Ok(match kind {
            _ if text.is_empty() => Value::None,
            Kind::Shared => {
                let index = text.trim().parse().ok();
                let text = index.and_then(|index| self.book.texts.get(index));
                Value::Text(
                    text.ok_or_else(|| broken(format!("it has no text {:.20}", self.text)))?,
                )
            }
            Kind::Truth => match text.trim() {
                "1" | "true" | "TRUE" | "True" => Value::Number(1.0),
                "0" | "false" | "FALSE" | "False" => Value::Number(0.0),
                "" => Value::None,
                other => return Err(broken(format!("{other:.20} is not true or false"))),
            },
            Kind::Error => Value::None,
            Kind::Unknown => return Err(broken("a cell is of an unknown kind".into())),
            Kind::Inline | Kind::Text => Value::Text(text),
            Kind::Number | Kind::Any => match text.parse::<f64>() {
                Ok(value) if is_date => Value::Date(value + self.book.offset),
                Ok(value) => Value::Number(value),
                Err(_) if kind == Kind::Any => Value::Text(text),
                Err(_) => return Err(broken(format!("{text:.20} is not a number"))),
            },
        })
    }
}

/// How the value of a cell is written.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Shared,
    Truth,
    Error,
    Inline,
    Text,
    Number,
    Any,
    Unknown,
}

impl Kind {
    fn of(stated: Option<&[u8]>) -> Self {
        match stated {
            None => Self::Any,
            Some(b"n") => Self::Number,
            Some(b"s") => Self::Shared,
            Some(b"b") => Self::Truth,
            Some(b"e") => Self::Error,
            Some(b"inlineStr" | b"is") => Self::Inline,
            // A date in words is read as a text.
            Some(b"str" | b"d") => Self::Text,
            Some(_) => Self::Unknown,
        }
    }
}

/// The row of a place such as `B20`, and its column if it has one, counted from 0.
fn place(text: &[u8]) -> Option<(u32, Option<u32>)> {
    let letters = text.iter().take_while(|byte| byte.is_ascii_alphabetic());
    let (letters, digits) = text.split_at(letters.count());
    let mut column = 0_u32;
    for letter in letters {
        let number = u32::from(letter.to_ascii_uppercase() - b'A') + 1;
        column = column.checked_mul(26)?.checked_add(number)?;
    }
    let row: u32 = std::str::from_utf8(digits).ok()?.parse().ok()?;
    Some((row.checked_sub(1)?, column.checked_sub(1)))
}

fn misplaced(name: &str, place: &[u8]) -> InputError {
    let place = String::from_utf8_lossy(place);
    damaged(NAME, name, format!("{place:.20} is no place of a cell"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_counted_from_0() {
        for (text, is) in [
            ("A1", Some((0, Some(0)))),
            ("b20", Some((19, Some(1)))),
            ("XFD1048576", Some((1_048_575, Some(16_383)))),
            ("7", Some((6, None))),
            ("A", None),
            ("A0", None),
            ("1A", None),
            ("ZZZZZZZZ1", None),
            ("A99999999999", None),
        ] {
            assert_eq!(place(text.as_bytes()), is, "{text}");
        }
    }
}
