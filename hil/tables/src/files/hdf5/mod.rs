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

use std::fmt::Display;
use std::rc::Rc;

use hdf5_reader::error::Error;
use mesh_damper_output::error::InputError;

use super::arrays::{arranged, say_skipped};
use super::guard::{damaged, guarded};
use super::opened::Opened;
use super::{Format, Reading, Source, Tables};
use crate::budget::Budget;
use cells::Datasets;
use file::{File, Refused, innermost};
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
            opened.map_err(|why| said(&name, why))
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
        let tree = matlab::tree(&file)?;
        return Ok(super::mat::opened(name.to_owned(), tree, reading)?);
    }
    let budget = Rc::clone(&file.budget);
    let found = Walk::new(&file).all()?;
    let mut beside = found.beside;
    beside.heed(reading);
    let mut datasets = Datasets::new(file, found.data);
    let mut values = |place: &cells::Place| {
        let values = datasets.values(place);
        values.map_err(|why| said(name, why))
    };
    let (mut tables, places) = arranged(&found.groups, found.arrays, beside, &mut values)?;
    say_skipped(&mut tables, found.skipped);
    let owned = name.to_owned();
    let read = move |table: usize, column: usize| {
        guarded(NAME, &owned, || {
            let values = datasets.values(&places[table][column]);
            values.map(Some).map_err(|why| said(&owned, why))
        })
    };
    let comments = found.comments;
    Ok(Box::new(Opened::new(
        budget,
        name.to_owned(),
        tables,
        comments,
        read,
    )?))
}

/// The error of the file `name`.
fn said(name: &str, why: Refused) -> InputError {
    let error = match why {
        Refused::Said(error) => return error,
        Refused::Variables(why) => return why.error("MATLAB v7.3", name),
        Refused::File(error) => error,
    };
    match innermost(&error) {
        Error::UnsupportedFilter(_) => InputError::new(
            name,
            format!("uses a part of HDF5 that hil does not read: {error}"),
            "write it again with compression=\"gzip\" or without compression",
        ),
        _ => damaged(NAME, name, &error as &dyn Display),
    }
}
