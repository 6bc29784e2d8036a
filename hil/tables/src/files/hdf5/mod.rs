//! HDF5, and the files of MATLAB v7.3, which are HDF5.

mod attributes;
mod cells;
mod data;
mod file;
mod grid;
mod links;
mod lzf;
mod matlab;
mod walk;

use std::rc::Rc;

use mesh_damper_output::error::InputError;

use super::arrays::{arranged, say_skipped};
use super::guard::guarded;
use super::opened::Opened;
use super::refused::Refused;
use super::{Format, Reading, Source, Tables};
use crate::budget::Budget;
use cells::Datasets;
use file::File;
use walk::Walk;

const NAME: &str = "HDF5";
const MARK: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Hierarchical Data Format, version 5.
pub(super) struct Hdf5;

impl Format for Hdf5 {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["h5", "hdf5", "hdf", "nc", "mat"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        // A program may put its own block before it, as MATLAB does.
        let is_at = |at: usize| head.get(at..).is_some_and(|rest| rest.starts_with(MARK));
        [0, 512, 1024, 2048].into_iter().any(is_at)
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        reading: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, budget) = (source.name(), source.budget());
        let is_matlab = source.head().starts_with(b"MATLAB");
        let bytes = source.bytes()?;
        guarded(NAME, &name, || {
            let opened = open(&name, bytes, budget, is_matlab, reading);
            opened.map_err(|why| why.error(NAME, &name))
        })
    }
}

fn open<'a>(
    name: &str,
    bytes: Vec<u8>,
    budget: Rc<Budget>,
    is_matlab: bool,
    reading: &Reading,
) -> Result<Box<dyn Tables + 'a>, Refused> {
    let file = File::of(bytes, budget)?;
    if is_matlab || matlab::wrote(&file)? {
        let tree = matlab::tree(&file);
        let tree = tree.map_err(|why| why.error("MATLAB v7.3", name))?;
        return Ok(super::mat::opened(name.to_owned(), tree, reading)?);
    }
    let budget = Rc::clone(&file.budget);
    let found = Walk::new(&file).all()?;
    let mut beside = found.beside;
    beside.heed(reading);
    let mut datasets = Datasets::new(file, found.data);
    let mut values = |place: &cells::Place| {
        let values = datasets.values(place);
        values.map_err(|why| why.error(NAME, name))
    };
    let (mut tables, places) = arranged(&found.groups, found.arrays, beside, &mut values)?;
    say_skipped(&mut tables, found.skipped);
    let read = move |table: usize, column: usize| {
        let values = datasets.values(&places[table][column]);
        values.map(Some)
    };
    let comments = found.comments;
    Ok(Box::new(Opened::new(
        NAME,
        budget,
        name.to_owned(),
        tables,
        comments,
        read,
    )?))
}
