//! The values of MATLAB, as a file nests them in structures and cells.

use std::borrow::Cow;
use std::rc::Rc;

use super::element::{Bytes, Element, Numbers};
use crate::budget::{Budget, of_list, of_text};
use crate::files::number::Kind;
use crate::files::refused::Refused;
use crate::room::Room;

/// A value of MATLAB.
#[derive(Debug)]
pub(in crate::files) enum Value {
    Numbers(Vec<usize>, Numbers),
    Text(String),
    /// Elements, each with its fields.
    Structure(Vec<Fields>),
    Cell(Vec<Value>),
    /// A value that is not read, in words.
    Other(Cow<'static, str>),
}

/// The fields of an element of a structure. All elements share the names.
pub(in crate::files) type Fields = Vec<(Rc<str>, Value)>;

/// A matrix's head: its class, its dimensions and its name.
struct Head {
    class: u8,
    is_complex: bool,
    dimensions: Vec<usize>,
    name: Numbers,
}

const PART: &str = "the values in its structures and cells";

/// Reads the values of a variable, and charges them while they are held.
pub(super) struct Values<'b>(Room<'b>);

impl<'b> Values<'b> {
    pub fn new(budget: &'b Budget) -> Self {
        Self(Room::of(budget))
    }

    fn hold(&mut self, bytes: u64) -> Result<(), Refused> {
        Ok(self.0.more(bytes, PART)?)
    }

    /// A variable's name and value; `depth` is the nesting that it may have.
    pub fn variable(&mut self, matrix: Bytes, depth: usize) -> Result<(String, Value), Refused> {
        let (name, value) = self.value(matrix, depth)?;
        let Some(name) = name else {
            return Ok((String::new(), value));
        };
        self.hold(of_text(LOSSY * name.bytes.slice().len()))?;
        Ok((name.text(), value))
    }

    /// A matrix's name and contents; an empty one has no name.
    fn value(
        &mut self,
        mut bytes: Bytes,
        depth: usize,
    ) -> Result<(Option<Numbers>, Value), Refused> {
        let deeper = depth.checked_sub(1);
        let deeper = deeper.ok_or("structures are nested too deeply")?;
        if bytes.slice().is_empty() {
            return Ok((None, Value::Other("empty".into())));
        }
        let head = self.head(&mut bytes)?;
        let count = (head.dimensions.iter()).try_fold(1_usize, |all, &size| all.checked_mul(size));
        let count = count.ok_or("the dimensions of a variable are invalid")?;
        let value = match head.class {
            1 => {
                let mut cells = Vec::new();
                while cells.len() < count
                    && let Some(matrix) = matrix(&mut bytes)?
                {
                    let value = self.value(matrix, deeper)?.1;
                    self.add(&mut cells, value)?;
                }
                Value::Cell(cells)
            }
            2 | 3 => {
                if head.class == 3 {
                    // The class of the object.
                    bytes.numbers()?;
                }
                Value::Structure(self.elements(&mut bytes, count, deeper)?)
            }
            4 => Value::Text(self.text(&mut bytes, &head.dimensions)?),
            6..=15 if head.is_complex => Value::Other("complex numbers".into()),
            6..=15 => Value::Numbers(head.dimensions, bytes.numbers()?),
            5 => Value::Other("a sparse matrix".into()),
            16 => Value::Other("a function".into()),
            17 => {
                let class = class(&mut bytes)?;
                self.hold(of_text(LOSSY * class.bytes.slice().len()))?;
                Value::Other(format!("an object of class {}", class.text()).into())
            }
            _ => Value::Other("of an unknown class".into()),
        };
        Ok((Some(head.name), value))
    }

    /// Adds to a list; its room is charged.
    fn add<T>(&mut self, list: &mut Vec<T>, entry: T) -> Result<(), Refused> {
        Ok(self.0.push(list, entry, PART)?)
    }

    fn head(&mut self, bytes: &mut Bytes) -> Result<Head, Refused> {
        let flags = bytes.numbers()?.get(0) as u32;
        let class = flags as u8;
        // The layout of an object of a class is not documented: its name follows at once.
        let dimensions = if class == 17 {
            Vec::new()
        } else {
            let sizes = bytes.numbers()?;
            self.hold(of_list::<usize>(sizes.len()))?;
            (0..sizes.len())
                .map(|index| sizes.get(index) as usize)
                .collect()
        };
        let name = bytes.numbers()?;
        Ok(Head {
            class,
            is_complex: flags & 0x800 != 0,
            dimensions,
            name,
        })
    }

    /// The elements of a structure, of which the file has at most `count`.
    fn elements(
        &mut self,
        bytes: &mut Bytes,
        count: usize,
        depth: usize,
    ) -> Result<Vec<Fields>, Refused> {
        let length = bytes.numbers()?.get(0).max(1.0) as usize;
        let all = bytes.numbers()?;
        let mut names: Vec<Rc<str>> = Vec::new();
        for name in all.bytes.slice().chunks(length) {
            let end = name.iter().position(|&byte| byte == 0);
            let name = &name[..end.unwrap_or(name.len())];
            self.hold(of_text(LOSSY * name.len()))?;
            self.add(&mut names, String::from_utf8_lossy(name).into())?;
        }
        let mut elements = Vec::new();
        while elements.len() < count && !bytes.slice().is_empty() {
            // A field takes the head of an element at least.
            let most = names.len().min(bytes.slice().len().div_ceil(8));
            self.hold(of_list::<(Rc<str>, Value)>(most))?;
            let mut fields = Vec::with_capacity(most);
            for name in &names {
                let Some(matrix) = matrix(bytes)? else { break };
                fields.push((Rc::clone(name), self.value(matrix, depth)?.1));
            }
            if fields.is_empty() {
                break;
            }
            self.add(&mut elements, fields)?;
        }
        Ok(elements)
    }

    /// A text: its rows in MATLAB's layout, one line each.
    fn text(&mut self, bytes: &mut Bytes, dimensions: &[usize]) -> Result<String, Refused> {
        let element = bytes.next()?;
        let length = match &element {
            Some(Element::Numbers(Numbers { bytes, .. }) | Element::Other(16 | 17, bytes)) => {
                bytes.slice().len()
            }
            _ => return Ok(String::new()),
        };
        let mut room = Room::of(self.0.budget());
        room.more((LOSSY * length) as u64, PART)?;
        let text = match element {
            Some(Element::Numbers(numbers)) => numbers.text(),
            Some(Element::Other(16, bytes)) => String::from_utf8_lossy(bytes.slice()).into_owned(),
            Some(Element::Other(_, bytes)) => Numbers {
                kind: Kind::U16,
                bytes,
            }
            .text(),
            _ => String::new(),
        };
        // Letters that are no ASCII are put into rows one by one, in four bytes each.
        let rows = text.len() + if text.is_ascii() { 0 } else { 4 * length };
        room.more(rows as u64, PART)?;
        let text = rows_of_text(text, dimensions);
        drop(room);
        self.hold(of_text(text.len()))?;
        Ok(text)
    }
}

/// Bytes that a byte of a text becomes at most: the sign for one that is no letter has three.
const LOSSY: usize = 3;

fn matrix(bytes: &mut Bytes) -> Result<Option<Bytes>, Refused> {
    match bytes.next()? {
        Some(Element::Matrix(matrix)) => Ok(Some(matrix)),
        Some(_) => Err("a structure or cell holds something that is not a variable".into()),
        None => Ok(None),
    }
}

/// The rows of a text in MATLAB's layout: column after column.
pub(in crate::files) fn rows_of_text(text: String, dimensions: &[usize]) -> String {
    let rows = dimensions.first().copied().unwrap_or(1);
    if rows <= 1 {
        return text;
    }
    let mut lines = String::new();
    if text.is_ascii() {
        let letters = text.as_bytes();
        for row in 0..rows.min(letters.len()) {
            lines.extend((row > 0).then_some('\n'));
            let line = letters[row..].iter().step_by(rows);
            lines.extend(line.map(|&letter| char::from(letter)));
        }
    } else {
        let letters: Vec<char> = text.chars().collect();
        for row in 0..rows.min(letters.len()) {
            lines.extend((row > 0).then_some('\n'));
            lines.extend(letters[row..].iter().step_by(rows));
        }
    }
    lines
}

/// The class of an object, after the name and the word `MCOS`.
fn class(bytes: &mut Bytes) -> Result<Numbers, Refused> {
    bytes.numbers()?;
    bytes.numbers()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_row_by_row() {
        let of = |text: &str, rows| rows_of_text(text.to_owned(), &[rows, 2]);
        assert_eq!(of("acbd", 2), "ab\ncd");
        assert_eq!(of("äcbд", 2), "äb\ncд");
        assert_eq!(of("ab", 1), "ab");
        assert_eq!(of("ab", 5), "a\nb");
        assert_eq!(of("", 3), "");
    }
}
