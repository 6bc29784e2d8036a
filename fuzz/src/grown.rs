//! Files that cost much: many or deep things of a few bytes each, in each format.
//!
//! The other checks damage good files, whose structure stays what a program wrote. Here it grows: by a seed, up to 4 MB of file and
//! 64 MB of what it unpacks to. Reading such a file, right or not, takes bounded memory and time.

mod arrow;
#[cfg(test)]
mod blocks;
mod bytes;
mod draw;
mod hdf5;
mod json;
mod mat;
mod mdf;
#[cfg(test)]
mod memory;
mod parquet;
#[cfg(test)]
mod run;
mod tdms;
mod text;
mod xlsx;

use std::path::Path;

use mesh_damper_recording::Recording;
use mesh_damper_tables::columns::{Meanings, choose};
use mesh_damper_tables::files::{self, Needs, Reading, Source, Wanted};

use draw::Draw;
pub use draw::Size;

/// Makes a file in which one structure grows.
type Grow = fn(&mut Draw) -> Vec<u8>;

/// Makes the list of formats from their modules and names, and of each a test with a few small files, for the gate, and one with many.
macro_rules! formats {
    ($($module:ident: $format:literal;)*) => {
        /// The formats, and the structures that grow in each.
        pub const FORMATS: &[(&str, &[(&str, Grow)])] = &[$(($format, $module::STRUCTURES)),*];

        #[cfg(test)]
        mod few {
            $(#[test] fn $module() { super::run::few($format); })*
        }
        #[cfg(test)]
        mod many {
            $(#[test] #[ignore = "minutes"] fn $module() { super::run::many($format); })*
        }
    };
}

formats! {
    text: "text";
    json: "JSON";
    mat: "MATLAB";
    hdf5: "HDF5";
    mdf: "MDF4";
    tdms: "TDMS";
    parquet: "Parquet";
    arrow: "Arrow";
    xlsx: "Excel";
}

/// The file of a structure that a seed draws.
pub fn file(grow: Grow, seed: u64, size: Size) -> Vec<u8> {
    let bytes = grow(&mut Draw::of(seed, size));
    assert!(bytes.len() <= size.file, "{} bytes", bytes.len());
    bytes
}

/// What reading a file took.
#[derive(Debug, Default)]
pub struct Looked {
    /// Whether it has a table that was read.
    pub is_read: bool,
    /// Whether it was refused because the budget was used up.
    pub is_refused: bool,
    /// The steps of work that were done, if it was refused too.
    pub steps: u64,
}

/// Number of columns that are read of a table.
const COLUMNS: usize = 64;

/// Reads a file as `hil inspect` does: its tables and what they may be, the values of one, and the recording in it.
pub fn look(bytes: &[u8]) -> Looked {
    let name = Path::new("grown");
    let reading = Reading::default();
    let mut looked = Looked::default();
    let Ok(source) = Source::of(name, bytes, reading.limit) else {
        return looked;
    };
    let budget = source.budget();
    if let Ok((_, file)) = files::opened(source, &reading) {
        let tables = file.tables();
        let meanings = Meanings::of(tables);
        let columns = tables.iter().enumerate();
        let columns = columns
            .flat_map(|(index, table)| (0..table.columns.len()).map(move |column| (index, column)));
        let described: Vec<Option<String>> = columns
            .map(|(table, column)| meanings.described(table, column))
            .collect();
        let chosen = choose("grown", tables, &reading, &Needs::default());
        let table = chosen.map_or(0, |chosen| chosen.table);
        let numeric = tables[table].columns.iter().enumerate();
        let numeric = numeric.filter(|(_, column)| column.is_numeric);
        let wanted: Vec<Wanted> = (numeric.take(COLUMNS))
            .map(|(column, _)| Wanted {
                column,
                must_be_numeric: false,
            })
            .collect();
        drop(meanings);
        let mut look = |_: usize, _: &[f64]| looked.is_read = true;
        let _ = file.look(table, &wanted, &mut look);
        drop(described);
    }
    looked.steps = budget.used().1;
    looked.is_refused = budget.is_used_up();
    let _ = Recording::from_bytes(name, bytes.to_vec());
    looked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_format_that_is_read_grows() {
        for format in files::FORMATS {
            let name = format.name();
            let grows = FORMATS.iter().any(|(format, _)| *format == name);
            assert!(grows || name == "unread", "{name}: no file grows");
        }
    }

    #[test]
    fn the_page_has_a_row_of_each_format_with_its_structures() {
        let page = include_str!("../../docs/robustness.md");
        for (format, structures) in FORMATS {
            let names: Vec<&str> = structures.iter().map(|(name, _)| *name).collect();
            let row = format!("| {format} | {} |", names.join(", "));
            assert!(page.contains(&row), "{row}");
        }
    }
}
