//! HDF5, and the files of MATLAB v7.3, which are HDF5.

mod cells;
mod lzf;
mod matlab;
mod walk;

use std::fmt::Display;

use hdf5_reader::{FilterRegistry, Hdf5File, OpenOptions};
use mesh_damper_output::error::InputError;

use super::arrays::arranged;
use super::guard::{damaged, guarded};
use super::opened::Opened;
use super::{Format, Reading, Source, Table, Tables};
use crate::read_limit::ReadLimit;
use cells::Datasets;
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
        let (name, limit) = (source.name(), source.limit());
        let is_matlab = source.head().starts_with(b"MATLAB");
        let bytes = source.bytes()?;
        guarded(NAME, &name, || {
            open(&name, bytes, limit, is_matlab, reading)
        })
    }
}

fn open<'a>(
    name: &str,
    bytes: Vec<u8>,
    limit: ReadLimit,
    is_matlab: bool,
    reading: &Reading,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    let most = usize::try_from(limit.file()).unwrap_or(usize::MAX);
    let mut filters = FilterRegistry::new();
    lzf::register(&mut filters, most);
    let options = OpenOptions::default()
        .with_filter_registry(filters)
        .with_chunk_cache_bytes(0)
        .with_max_chunk_bytes(most)
        .with_max_read_bytes(most);
    let refused = |error: hdf5_reader::error::Error| refused(name, limit, &error);
    let file = Hdf5File::from_vec_with_options(bytes, options).map_err(refused)?;
    let root = file.root_group().map_err(refused)?;
    if is_matlab || matlab::wrote(&root) {
        let tree = matlab::tree(&root, most as u64).map_err(|error| match error {
            matlab::Refused::File(error) => refused(error),
            matlab::Refused::TooLarge => limit.exceeded(name),
            matlab::Refused::Broken(why) => damaged("MATLAB v7.3", name, why.0),
        })?;
        return super::mat::opened(name.to_owned(), tree, reading);
    }
    let mut walk = Walk::default();
    walk.group(&root, &[]).map_err(refused)?;
    let Walk {
        arrays,
        datasets,
        skipped,
        comments,
        mut beside,
        ..
    } = walk;
    beside.heed(reading);
    let mut datasets = Datasets::new(datasets);
    let mut values = |place: &cells::Place| datasets.values(place).map_err(refused);
    let (mut tables, places) = arranged(arrays, &beside, &mut values)?;
    for (table, places) in tables.iter_mut().zip(&places) {
        let time = table.columns.iter_mut().zip(places);
        if let Some((column, place)) = time
            .into_iter()
            .find(|(each, _)| crate::columns::is_time(each))
        {
            let mut times = values(place)?;
            times.truncate(super::Column::FIRST);
            column.first = times;
        }
    }
    if tables.is_empty() {
        tables.push(Table::default());
    }
    tables[0].skipped.extend(skipped);
    let owned = name.to_owned();
    let read = move |table: usize, column: usize| {
        guarded(NAME, &owned, || {
            let place = &places[table][column];
            let values = datasets.values(place);
            values
                .map(Some)
                .map_err(|error| self::refused(&owned, limit, &error))
        })
    };
    Ok(Box::new(Opened::new(
        name.to_owned(),
        tables,
        comments,
        read,
    )?))
}

fn refused(name: &str, limit: ReadLimit, error: &hdf5_reader::error::Error) -> InputError {
    use hdf5_reader::error::Error;
    // The innermost error, without its context.
    let mut inner = error;
    while let Error::Context { source, .. } = inner {
        inner = source;
    }
    match inner {
        Error::ResourceLimit(_) => limit.exceeded(name),
        Error::UnsupportedFilter(_) => InputError::new(
            name,
            format!("uses a part of HDF5 that hil does not read: {error}"),
            "write it again with compression=\"gzip\" or without compression",
        ),
        _ => damaged(NAME, name, error as &dyn Display),
    }
}
