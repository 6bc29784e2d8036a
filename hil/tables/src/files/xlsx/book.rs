//! What a workbook says of its sheets: their names and places, which numbers are dates, and the texts that they share.

use std::borrow::Cow;
use std::collections::HashMap;

use mesh_damper_output::error::InputError;
use quick_xml::events::{BytesRef, BytesText, Event};

use super::NAME;
use super::parts::{Parts, Xml, attributes};
use crate::budget::Budget;
use crate::files::guard::damaged;

/// Bytes held for an entry of a list, besides its texts.
const OF_ENTRY: u64 = 128;

/// A workbook.
pub(super) struct Book {
    /// The name of each sheet, and the path of its part if it may have cells.
    pub sheets: Vec<(String, Option<String>)>,
    pub texts: Texts,
    /// Whether a number of each style is a date, or a time.
    pub are_dates: Vec<bool>,
    /// Days from the day 0 of a workbook of Windows to that of this one.
    pub offset: f64,
}

/// Texts one after the other.
#[derive(Default)]
pub(super) struct Texts {
    text: String,
    ends: Vec<usize>,
}

impl Book {
    /// # Errors
    /// A damaged part, or one for which the budget has no room.
    pub fn of(name: &str, parts: &mut Parts, budget: &Budget) -> Result<Self, InputError> {
        let lacks = |part: &str| damaged(NAME, name, format!("it has no {part}"));
        let path = match parts.find("_rels/.rels")? {
            Some(relations) => document(relations)?.ok_or_else(|| lacks("workbook")),
            None => Err(lacks("_rels/.rels")),
        }?;
        let path = path.trim_start_matches('/');
        let (folder, file) = path.rsplit_once('/').unwrap_or(("", path));
        let beside = |part: &str| match folder {
            "" => part.to_owned(),
            folder => format!("{folder}/{part}"),
        };
        let relations = parts.find(&beside(&format!("_rels/{file}.rels")))?;
        let relations = relations.ok_or_else(|| lacks("relations of its workbook"))?;
        let targets = targets(relations, budget)?;
        let texts = match parts.find(&beside("sharedStrings.xml"))? {
            Some(texts) => shared(texts, budget)?,
            None => Texts::default(),
        };
        let are_dates = match parts.find(&beside("styles.xml"))? {
            Some(styles) => dates(styles, budget)?,
            None => Vec::new(),
        };
        let mut book = Self {
            sheets: Vec::new(),
            texts,
            are_dates,
            offset: 0.0,
        };
        if let Some(workbook) = parts.find(path)? {
            book.sheets(workbook, &targets, folder, budget)?;
        }
        Ok(book)
    }

    fn sheets(
        &mut self,
        mut xml: Xml,
        targets: &HashMap<Vec<u8>, String>,
        folder: &str,
        budget: &Budget,
    ) -> Result<(), InputError> {
        let name = xml.name();
        let broken = |why: String| damaged(NAME, name, why);
        loop {
            match xml.next()? {
                Event::Start(e) if e.local_name().as_ref() == b"sheet" => {
                    let [named, id] = attributes(&e, ["name", "id"]).map_err(broken)?;
                    let named = unescaped(&named.unwrap_or_default()).map_err(broken)?;
                    let target = targets.get(&*id.unwrap_or_default());
                    let target = target.ok_or_else(|| broken("a sheet has no relation".into()))?;
                    // Charts and dialogs have no cells.
                    let path = (!target.is_empty()).then(|| match target.strip_prefix('/') {
                        Some(path) => path.to_owned(),
                        None if folder.is_empty() => target.clone(),
                        None => format!("{folder}/{target}"),
                    });
                    let texts = named.len() + path.as_ref().map_or(0, String::len);
                    budget.hold(OF_ENTRY + texts as u64, "the names of its sheets")?;
                    self.sheets.push((named, path));
                }
                Event::Start(e) if e.local_name().as_ref() == b"workbookPr" => {
                    if let [Some(of_1904)] = attributes(&e, ["date1904"]).map_err(broken)? {
                        let is_of_1904 = matches!(&*of_1904, b"1" | b"true");
                        self.offset = if is_of_1904 { 1462.0 } else { 0.0 };
                    }
                }
                Event::End(e) if e.local_name().as_ref() == b"workbook" => return Ok(()),
                Event::Eof => return Err(broken("its workbook is cut".into())),
                _ => {}
            }
        }
    }
}

impl Texts {
    /// The text with this number, counted from 0.
    pub fn get(&self, index: usize) -> Option<&str> {
        let end = *self.ends.get(index)?;
        let begin = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.text.get(begin..end)
    }

    fn push(&mut self, text: &str, budget: &Budget) -> Result<(), InputError> {
        const PART: &str = "the texts of its cells";
        if self.text.capacity() - self.text.len() < text.len() {
            let more = text.len().max(self.text.len() / 4).max(1 << 12);
            budget.hold(more as u64, PART)?;
            self.text.reserve_exact(more);
        }
        if self.ends.len() == self.ends.capacity() {
            let more = (self.ends.len() / 4).max(1 << 9);
            budget.hold((more * size_of::<usize>()) as u64, PART)?;
            self.ends.reserve_exact(more);
        }
        self.text.push_str(text);
        self.ends.push(self.text.len());
        Ok(())
    }
}

/// The path of the workbook.
fn document(mut xml: Xml) -> Result<Option<String>, InputError> {
    let name = xml.name();
    let broken = |why: String| damaged(NAME, name, why);
    let mut found = None;
    loop {
        match xml.next()? {
            Event::Start(e) if e.local_name().as_ref() == b"Relationship" => {
                let [kind, target] = attributes(&e, ["Type", "Target"]).map_err(broken)?;
                let is_it = |kind: &[u8]| kind.ends_with(b"/relationships/officeDocument");
                if let (Some(target), true) = (target, kind.is_some_and(|kind| is_it(&kind))) {
                    found = Some(unescaped(&target).map_err(broken)?);
                }
            }
            Event::End(e) if e.local_name().as_ref() == b"Relationships" => return Ok(found),
            Event::Eof => return Err(broken("its relations are cut".into())),
            _ => {}
        }
    }
}

/// The path of each sheet, as it is written, by its identity; empty for what has no cells.
fn targets(mut xml: Xml, budget: &Budget) -> Result<HashMap<Vec<u8>, String>, InputError> {
    let name = xml.name();
    let broken = |why: String| damaged(NAME, name, why);
    let mut targets = HashMap::new();
    loop {
        match xml.next()? {
            Event::Start(e) if e.local_name().as_ref() == b"Relationship" => {
                let found = attributes(&e, ["Id", "Type", "Target"]).map_err(broken)?;
                let [Some(id), kind, target] = found else {
                    continue;
                };
                let target = match kind.is_some_and(|kind| kind.ends_with(b"/worksheet")) {
                    true => unescaped(&target.unwrap_or_default()).map_err(broken)?,
                    false => String::new(),
                };
                let held = OF_ENTRY + (id.len() + target.len()) as u64;
                budget.hold(held, "the relations of its parts")?;
                targets.insert(id.into_owned(), target);
            }
            Event::End(e) if e.local_name().as_ref() == b"Relationships" => return Ok(targets),
            Event::Eof => return Err(broken("its relations are cut".into())),
            _ => {}
        }
    }
}

fn shared(mut xml: Xml, budget: &Budget) -> Result<Texts, InputError> {
    let mut texts = Texts::default();
    let mut text = String::new();
    loop {
        match xml.next()? {
            Event::Start(e) if e.local_name().as_ref() == b"si" => {
                text.clear();
                read_text(&mut xml, b"si", &mut text)?;
                texts.push(&text, budget)?;
            }
            Event::End(e) if e.local_name().as_ref() == b"sst" => return Ok(texts),
            Event::Eof => return Err(xml.damaged("its texts are cut")),
            _ => {}
        }
    }
}

/// Appends the text of an element called `end`, whose begin was read: its pieces, without the readings beside them.
pub(super) fn read_text(xml: &mut Xml, end: &[u8], text: &mut String) -> Result<(), InputError> {
    let name = xml.name();
    let broken = |why: String| damaged(NAME, name, why);
    let mut is_reading = false;
    // Where the piece begins that is read, and whether its blanks count.
    let mut piece = None;
    loop {
        match xml.next()? {
            Event::Start(e) if e.local_name().as_ref() == b"rPh" => is_reading = true,
            Event::Start(e) if e.local_name().as_ref() == b"t" && !is_reading => {
                let [space] = attributes(&e, ["space"]).map_err(broken)?;
                piece = Some((text.len(), space.as_deref() == Some(b"preserve")));
            }
            Event::Text(piece_of) if piece.is_some() => append(&piece_of, text).map_err(broken)?,
            Event::CData(piece_of) if piece.is_some() => {
                let piece_of = piece_of.xml10_content();
                text.push_str(&piece_of.map_err(|error| broken(error.to_string()))?);
            }
            Event::GeneralRef(entity) if piece.is_some() => {
                resolve(&entity, text).map_err(broken)?;
            }
            Event::End(e) => match e.local_name().as_ref() {
                b"rPh" => is_reading = false,
                b"t" => {
                    if let Some((begin, is_preserved)) = piece.take() {
                        let written = &text[begin..];
                        let blanks = [' ', '\t', '\r', '\n'];
                        let bare = match is_preserved {
                            true => written,
                            false => written.trim_matches(blanks),
                        };
                        let said = without_escapes(bare);
                        if said != written {
                            let said = said.into_owned();
                            text.truncate(begin);
                            text.push_str(&said);
                        }
                    }
                }
                other if other == end => return Ok(()),
                _ => {}
            },
            Event::Eof => return Err(broken("a text is cut".into())),
            _ => {}
        }
    }
}

/// Appends a piece of text.
pub(super) fn append(piece: &BytesText, text: &mut String) -> Result<(), String> {
    text.push_str(&piece.xml10_content().map_err(|error| error.to_string())?);
    Ok(())
}

/// Appends the character of an entity.
pub(super) fn resolve(entity: &BytesRef, text: &mut String) -> Result<(), String> {
    let word = entity.decode().map_err(|error| error.to_string())?;
    if let Some(known) = quick_xml::escape::resolve_xml_entity(&word) {
        text.push_str(known);
        return Ok(());
    }
    match entity.resolve_char_ref() {
        Ok(Some(sign)) => text.push(sign),
        Ok(None) => return Err(format!("the entity {word} is unknown")),
        Err(error) => return Err(error.to_string()),
    }
    Ok(())
}

fn unescaped(value: &[u8]) -> Result<String, String> {
    let text = std::str::from_utf8(value).map_err(|error| error.to_string())?;
    let text = quick_xml::escape::unescape(text).map_err(|error| error.to_string())?;
    Ok(text.into_owned())
}

/// A text in which Excel wrote signs as `_x000D_`: four digits of UTF-16.
pub(super) fn without_escapes(text: &str) -> Cow<'_, str> {
    if !text.contains("_x") {
        return text.into();
    }
    let unit = |at: usize| -> Option<u16> {
        let digits = text
            .get(at..at + 7)?
            .strip_prefix("_x")?
            .strip_suffix('_')?;
        let is_hexadecimal = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        is_hexadecimal.then(|| u16::from_str_radix(digits, 16).ok())?
    };
    let mut plain = String::with_capacity(text.len());
    let mut rest = 0;
    while let Some(found) = text[rest..].find("_x") {
        let mut at = rest + found;
        let mut units = Vec::new();
        while let Some(unit) = unit(at) {
            units.push(unit);
            at += 7;
        }
        plain.push_str(&text[rest..rest + found]);
        if units.is_empty() {
            plain.push('_');
            rest += found + 1;
        } else {
            plain.push_str(&String::from_utf16_lossy(&units));
            rest = at;
        }
    }
    plain.push_str(&text[rest..]);
    plain.into()
}

/// Whether a number of each style is a date, or a time.
fn dates(mut xml: Xml, budget: &Budget) -> Result<Vec<bool>, InputError> {
    const PART: &str = "the styles of its cells";
    let name = xml.name();
    let broken = |why: String| damaged(NAME, name, why);
    let mut formats: HashMap<Vec<u8>, bool> = HashMap::new();
    let mut are_dates = Vec::new();
    let mut is_of_cells = false;
    loop {
        match xml.next()? {
            Event::Start(e) => match e.local_name().as_ref() {
                b"numFmt" => {
                    let found = attributes(&e, ["numFmtId", "formatCode"]).map_err(broken)?;
                    if let [Some(id), Some(code)] = found {
                        let code = unescaped(&code).map_err(broken)?;
                        budget.hold(OF_ENTRY + id.len() as u64, PART)?;
                        formats.insert(id.into_owned(), is_date(&code));
                    }
                }
                b"cellXfs" => is_of_cells = true,
                b"xf" if is_of_cells => {
                    let [id] = attributes(&e, ["numFmtId"]).map_err(broken)?;
                    let is_date = id.is_some_and(|id| match formats.get(&*id) {
                        Some(is_date) => *is_date,
                        None => is_built_in_date(&id),
                    });
                    // The vector doubles as it grows.
                    budget.hold(2, PART)?;
                    are_dates.push(is_date);
                }
                _ => {}
            },
            Event::End(e) if e.local_name().as_ref() == b"cellXfs" => is_of_cells = false,
            Event::End(e) if e.local_name().as_ref() == b"styleSheet" => return Ok(are_dates),
            Event::Eof => return Err(broken("its styles are cut".into())),
            _ => {}
        }
    }
}

/// Whether a format that has no code in the file is one of dates or times, of any country (ECMA-376, 18.8.30).
fn is_built_in_date(id: &[u8]) -> bool {
    let id = std::str::from_utf8(id)
        .ok()
        .and_then(|id| id.parse::<u8>().ok());
    id.is_some_and(|id| matches!(id, 14..=22 | 27..=36 | 45..=47 | 50..=58))
}

/// Whether a format's code shows dates or times: its first section has a letter of them, outside of quotes and brackets, or hours,
/// minutes or seconds in brackets that count on.
fn is_date(code: &str) -> bool {
    let mut signs = code.chars();
    while let Some(sign) = signs.next() {
        match sign {
            '"' => while signs.next().is_some_and(|sign| sign != '"') {},
            // The next sign is written as it is, left free, or repeated.
            '\\' | '_' | '*' => _ = signs.next(),
            ';' => return false,
            '[' => {
                let inner: String = signs.by_ref().take_while(|sign| *sign != ']').collect();
                let mut letters = inner.chars().map(|sign| sign.to_ascii_lowercase());
                let first = letters.next();
                if matches!(first, Some('h' | 'm' | 's')) && letters.all(|sign| Some(sign) == first)
                {
                    return true;
                }
            }
            'd' | 'm' | 'h' | 'y' | 's' | 'D' | 'M' | 'H' | 'Y' | 'S' => return true,
            // `a/p` and `AM/PM`.
            'a' | 'A' if matches!(signs.clone().next(), Some('/' | 'm' | 'M' | 'p' | 'P')) => {
                return true;
            }
            _ => {}
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_of_dates_are_known() {
        for code in [
            "DD/MM/YY",
            "H:MM:SS;@",
            "m\"M\"d\"D\";@",
            "[h]:mm:ss",
            "[$-404]e\"\\xfc\"m\"\\xfc\"d\"\\xfc\"",
            "[ss]",
            "[s].000",
            "[Blue]\\+[h]:mm;[Red]\\-[h]:mm;[Green][h]:mm",
            "[>=100][Magenta][s].00",
            "ha/p\\\\m",
            "[$-F400]h:mm:ss\\ AM/PM",
            "*-yyyy-mm-dd",
        ] {
            assert!(is_date(code), "{code}");
        }
        for code in [
            "General",
            "#,##0\\ [$\\u20bd-46D]",
            "\"Y: \"0.00\"m\";\"Y: \"-0.00\"m\";\"Y: <num>m\";@",
            "\"$\"#,##0_);[Red](\"$\"#,##0)",
            "0_ ;[Red]\\-0\\ ",
            "\\Y000000",
            "#,##0.0####\" YMD\"",
            "[>=100][Magenta].00",
            "#,##0.00\\ _M\"H\"_);[Red]#,##0.00\\ _M\"S\"_)",
            "#,##0*y",
            "0.00E+00",
            "[hm]",
        ] {
            assert!(!is_date(code), "{code}");
        }
        assert!(is_built_in_date(b"22") && is_built_in_date(b"46"));
        assert!(!is_built_in_date(b"0") && !is_built_in_date(b"300") && !is_built_in_date(b"x"));
    }

    #[test]
    fn signs_that_excel_writes_as_numbers_are_read() {
        for (text, plain) in [
            ("a_x000D_b", "a\rb"),
            ("_x005F_x000D_", "_x000D_"),
            ("_xD83D__xDCF7_", "\u{1f4f7}"),
            ("_x12_ _xZZZZ_ _", "_x12_ _xZZZZ_ _"),
            ("_xD83D_", "\u{fffd}"),
            ("ü_x", "ü_x"),
        ] {
            assert_eq!(without_escapes(text), plain);
        }
    }
}
