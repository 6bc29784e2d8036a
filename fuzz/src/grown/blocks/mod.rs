//! Files of blocks that refer to each other, in which few bytes say much: what they take, and that they are read right or refused.

mod hdf5;
mod mdf;
mod tdms;

use std::path::Path;

use mesh_damper_tables::files::{self, Kept, Reading, Source, Table, Wanted};
use mesh_damper_tables::read_limit::ReadLimit;

use super::memory;

/// The limit of a file: an eighth of it may be held, and as many steps done, before a byte is read.
const LIMIT: u64 = 16 << 20;
/// What may be held for a byte read, and what may be done.
const PER_BYTE: [u64; 2] = [6, 8];
/// What the libraries take for a block that they parse, which is charged afterwards, and the room that lists grow by.
const SLACK: u64 = 1 << 20;

/// A file that was opened.
#[derive(Debug)]
struct Seen {
    /// Its tables, or the error.
    tables: Result<Vec<Table>, String>,
    /// The values of the columns of its first table.
    values: Vec<Vec<f64>>,
    /// Bytes that are charged at the end, and steps.
    used: (u64, u64),
    /// Bytes that were taken at most, the file itself not counted.
    taken: u64,
}

impl Seen {
    /// The names of the columns of each table.
    fn names(&self) -> Vec<Vec<&str>> {
        fn of(table: &Table) -> Vec<&str> {
            let names = table.columns.iter().map(|each| each.name.as_str());
            names.collect()
        }
        self.tables().iter().map(of).collect()
    }

    fn tables(&self) -> &[Table] {
        self.tables.as_ref().unwrap()
    }

    fn error(&self) -> &str {
        self.tables.as_ref().unwrap_err()
    }

    /// It was refused because the budget was used up for `part`.
    fn refused_for(&self, part: &str) {
        let error = self.error();
        assert!(
            error.contains(part) && error.contains("--max-read"),
            "{error}"
        );
        assert!(!error.contains('\n'), "{error}");
    }
}

/// Opens a file that unpacks to `unpacked` bytes, and reads its first table; asserts that it takes no more than the budget allows.
fn seen(bytes: &[u8], unpacked: u64) -> Seen {
    let reading = Reading::from(ReadLimit::new(LIMIT));
    let read = || {
        let source = Source::of(Path::new("grown"), bytes, reading.limit).unwrap();
        let budget = source.budget();
        let opened = files::opened(source, &reading).and_then(|(_, file)| {
            let tables = file.tables().to_vec();
            let columns = 0..tables[0].columns.len().min(4);
            let wanted: Vec<Wanted> = columns
                .map(|column| Wanted {
                    column,
                    must_be_numeric: false,
                })
                .collect();
            let read = file.read(0, &wanted, Kept::Channels)?;
            Ok((tables, read.columns.into_iter().flatten().collect()))
        });
        (opened, budget.used())
    };
    let ((opened, used), taken) = memory::most(read);
    let taken = taken as u64;
    let (tables, values) = match opened {
        Ok((tables, values)) => (Ok(tables), values),
        Err(error) => (Err(error.to_string()), Vec::new()),
    };
    let read = bytes.len() as u64 + unpacked;
    let [held, steps] = PER_BYTE.map(|each| LIMIT / 8 + each * read);
    assert!(taken <= held + SLACK, "{taken} bytes taken, {held} allowed");
    assert!(used.1 <= steps, "{} steps of {steps}", used.1);
    Seen {
        tables,
        values,
        used,
        taken,
    }
}
