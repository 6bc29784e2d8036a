//! Blocks of a file, which the library parses one by one, and their texts.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use falcon_mdf::blocks::{BLOCK_HEADER_SIZE, BlockHeader, HdBlock, ID_BLOCK_SIZE, ParseBlock};
use falcon_mdf::io::memory::MemorySource;
use falcon_mdf::parser::{parse_block_header, parse_hd_block};
use falcon_mdf::{Metadata, Mf4Error};

use crate::budget::Budget;
use crate::files::refused::Refused;
use crate::room::Room;

const PART: &str = "its texts";

impl From<Mf4Error> for Refused {
    fn from(error: Mf4Error) -> Self {
        match error {
            Mf4Error::Unsupported { .. } => {
                let otherwise = "write it again with asammdf: mdf.convert('4.10').save(NAME)";
                Self::Unread(error.to_string(), otherwise)
            }
            error => Self::Damaged(error.to_string().into()),
        }
    }
}

/// The blocks of a file.
pub(super) struct Blocks {
    pub budget: Rc<Budget>,
    source: MemorySource,
    texts: RefCell<HashMap<u64, Rc<str>>>,
}

impl Blocks {
    pub fn new(bytes: Vec<u8>, budget: Rc<Budget>) -> Self {
        Self {
            budget,
            source: MemorySource::new(bytes),
            texts: RefCell::default(),
        }
    }

    /// All bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        self.source.as_slice()
    }

    /// The file's header.
    pub fn header(&self) -> Result<HdBlock, Refused> {
        Ok(parse_hd_block(&self.source, ID_BLOCK_SIZE as u64)?)
    }

    /// The head of the block at a link.
    pub fn head(&self, link: u64) -> Result<BlockHeader, Refused> {
        self.budget.work(16, "its blocks")?;
        Ok(parse_block_header(&self.source, link)?)
    }

    /// The block at a link.
    pub fn block<B: ParseBlock>(&self, link: u64) -> Result<B, Refused> {
        let head = self.head(link)?;
        // A block is parsed to the end of its links, and of as many numbers as some of them count.
        self.budget.work(16 + 2 * head.link_count, "its blocks")?;
        Ok(B::parse(self.of(&head), link)?)
    }

    /// All bytes of a block.
    fn of(&self, head: &BlockHeader) -> &[u8] {
        let start = head.offset as usize;
        &self.bytes()[start..start + head.length as usize]
    }

    /// The text at a link, without blanks around it; of metadata, their comment. A text that many blocks have is held once.
    pub fn text(&self, link: u64) -> Result<Rc<str>, Refused> {
        if let Some(text) = self.texts.borrow().get(&link) {
            return Ok(text.clone());
        }
        let text: Rc<str> = match link {
            0 => "".into(),
            _ => {
                let head = self.head(link)?;
                match &head.block_type {
                    b"##TX" => self.plain(&head)?.trim().into(),
                    b"##MD" => self.metadata(link)?.text().into(),
                    _ => return Err(Self::no_text(&head)),
                }
            }
        };
        let size = text.len() + 2 * size_of::<(u64, Rc<str>)>();
        self.budget.hold(size as u64, PART)?;
        self.texts.borrow_mut().insert(link, text.clone());
        Ok(text)
    }

    /// The metadata at a link.
    pub fn metadata(&self, link: u64) -> Result<Metadata, Refused> {
        let head = self.head(link)?;
        if &head.block_type != b"##MD" {
            return Err(Self::no_text(&head));
        }
        let xml = self.plain(&head)?;
        // The library joins the names of all trees around each entry, and compares the attributes of a tag with each other.
        let (mut around, mut entries, mut compared) = (0, 0_u64, 0);
        for tag in xml.split('<') {
            let tag = tag.split('>').next().unwrap_or_default();
            match tag {
                _ if tag.starts_with("tree") => around += tag.len() as u64,
                _ if tag.starts_with('e') => entries += 1,
                _ => {}
            }
            let attributes = tag.bytes().filter(|&byte| byte == b'=').count() as u64;
            compared += attributes * attributes;
        }
        let made = 3 * xml.len() as u64 + around.saturating_mul(entries);
        self.budget.work(4 * xml.len() as u64 + compared, PART)?;
        Room::of(&self.budget).more(made, PART)?;
        Ok(Metadata::parse(&xml))
    }

    /// The text of a block, which ends with a zero, or where the block ends.
    fn plain(&self, head: &BlockHeader) -> Result<String, Refused> {
        let text = &self.of(head)[BLOCK_HEADER_SIZE..];
        let end = text.iter().position(|&byte| byte == 0);
        let text = &text[..end.unwrap_or(text.len())];
        // A byte that is no text becomes a sign of three.
        let most = 3 * text.len() as u64;
        self.budget.work(most, PART)?;
        Room::of(&self.budget).more(most, PART)?;
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    fn no_text(head: &BlockHeader) -> Refused {
        let found = String::from_utf8_lossy(&head.block_type).into_owned();
        Mf4Error::invalid_block_id(head.offset, "##TX/##MD", found).into()
    }
}
