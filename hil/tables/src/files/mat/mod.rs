//! MATLAB's files of versions 5 to 7: variables, structures and cells of arrays.

mod element;
mod tree;

use std::io::Read as _;
use std::sync::Arc;

use mesh_damper_output::error::InputError;

use super::arrays::arranged;
use super::guard::damaged;
use super::opened::Opened;
use super::unread::is_mat_5;
use super::{Format, Reading, Source, Tables};
use element::Element;

pub(super) use element::{Broken, Bytes, Numbers};

pub(super) use tree::rows_of_text;
pub(super) use tree::{Tree, Value};

const NAME: &str = "MATLAB";
/// Bytes before the first variable.
const HEADER: usize = 128;

/// A MAT file of version 5, which MATLAB writes with `-v6` and, compressed, with `-v7`, as SciPy does.
pub(super) struct Mat;

impl Format for Mat {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["mat"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        is_mat_5(head)
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        reading: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, limit) = (source.name(), source.limit());
        let bytes = Arc::new(source.bytes()?);
        let is_little = bytes[126] == b'I';
        let mut tree = Tree::new();
        let mut unpacked = 0_u64;
        let mut rest = Bytes::new(bytes, HEADER, is_little);
        let broken = |why: Broken| damaged(NAME, &name, why.0);
        while let Some(element) = rest.next().map_err(broken)? {
            let variable = match element {
                Element::Compressed(packed) => {
                    let left = limit.file().saturating_sub(unpacked);
                    let mut bytes = Vec::new();
                    (flate2::read::ZlibDecoder::new(packed.slice()).take(left.saturating_add(1)))
                        .read_to_end(&mut bytes)
                        .map_err(|error| damaged(NAME, &name, error))?;
                    unpacked += bytes.len() as u64;
                    if bytes.len() as u64 > left {
                        return Err(limit.exceeded(&name));
                    }
                    let mut inner = Bytes::new(Arc::new(bytes), 0, is_little);
                    inner.next().map_err(broken)?
                }
                other => Some(other),
            };
            if let Some(Element::Matrix(matrix)) = variable {
                tree.variable(matrix).map_err(broken)?;
            }
        }
        opened(name, tree, reading)
    }
}

/// The contents of a file, as tables.
///
/// # Errors
/// A file without an array.
pub(super) fn opened<'a>(
    name: String,
    mut tree: Tree,
    reading: &Reading,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    tree.finish();
    let Tree {
        arrays,
        comments,
        skipped,
        guesses,
        mut beside,
        ..
    } = tree;
    beside.heed(reading);
    let (mut tables, sources) = arranged(arrays, &beside, &mut |values| Ok(values.all()))?;
    if let Some(table) = tables.first_mut() {
        table.skipped.extend(skipped);
        super::Table::note_in_all(&mut tables, &guesses);
    } else {
        let skipped = super::Table {
            skipped,
            ..super::Table::default()
        };
        tables.push(skipped);
    }
    let read = move |table: usize, column: usize| Ok(Some(sources[table][column].all()));
    Ok(Box::new(Opened::new(name, tables, comments, read)?))
}
