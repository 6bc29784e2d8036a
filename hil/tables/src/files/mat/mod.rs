//! MATLAB's files of versions 5 to 7: variables, structures and cells of arrays.

mod element;
mod tree;
mod value;

use std::rc::Rc;
use std::sync::Arc;

use mesh_damper_output::error::InputError;

use super::arrays::{arranged, say_skipped};
use super::opened::Opened;
use super::refused::Refused;
use super::unpack::inflated;
use super::unread::is_mat_5;
use super::{Format, Reading, Source, Tables};
use crate::budget::of_list;
use element::Element;

pub(super) use element::{Bytes, Numbers};

use tree::Strided;
pub(super) use tree::Tree;
pub(super) use value::{Value, rows_of_text};

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
        let (name, budget) = (source.name(), source.budget());
        let bytes = Arc::new(source.bytes()?);
        let is_little = bytes[126] == b'I';
        let mut tree = Tree::new(Rc::clone(&budget));
        let mut rest = Bytes::new(bytes, HEADER, is_little);
        let mut read = || {
            while let Some(element) = rest.next()? {
                let variable = match element {
                    Element::Compressed(packed) => {
                        let part = "its packed variables";
                        let bytes = inflated(packed.slice(), usize::MAX, &budget, part)?;
                        Bytes::new(Arc::new(bytes), 0, is_little).next()?
                    }
                    other => Some(other),
                };
                if let Some(Element::Matrix(matrix)) = variable {
                    tree.variable(matrix)?;
                }
            }
            Ok(())
        };
        read().map_err(|why: Refused| why.error(NAME, &name))?;
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
    tree.finish()?;
    let Tree {
        groups,
        arrays,
        comments,
        skipped,
        guesses,
        mut beside,
        ..
    } = tree;
    beside.heed(reading);
    let budget = Rc::clone(groups.budget());
    let charged = Rc::clone(&budget);
    let mut values = move |values: &Strided| {
        const PART: &str = "the values of its columns";
        charged.hold(of_list::<f64>(values.count), PART)?;
        charged.work(values.count as u64, PART)?;
        Ok(values.all())
    };
    let (mut tables, sources) = arranged(&groups, arrays, beside, &mut values)?;
    super::Table::note_in_all(&mut tables, &guesses, &budget)?;
    say_skipped(&mut tables, skipped);
    let read = move |table: usize, column: usize| Ok(Some(values(&sources[table][column])?));
    Ok(Box::new(Opened::new(
        NAME, budget, name, tables, comments, read,
    )?))
}
