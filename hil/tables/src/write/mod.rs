//! Columns as the bytes of a file, in the format of the file's ending.

mod formula;
#[cfg(feature = "formats")]
mod mat;
#[cfg(feature = "formats")]
mod mcap;
#[cfg(feature = "formats")]
mod parquet;
mod text;

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use mesh_damper_output::error::{InputError, quoted};
use mesh_damper_output::finite::check_column;

use crate::channel::Channel;
use crate::control;

pub use formula::{comment_line, guarded, unguarded};

/// Significant digits of computed numbers in text: a thousandth of a 24-bit converter's step.
pub const DIGITS: usize = 9;

/// A format of written recordings and tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteAs {
    /// Text: comment lines, a header, rows.
    Csv,
    /// The same, gzipped.
    CsvGz,
    /// Parquet, compressed; units are in the fields' metadata, comments in the file's.
    Parquet,
    /// A MAT file of version 5, compressed: one variable per column, a structure `units`, and a text `comments`.
    Mat,
    /// MCAP: one message per sample on the topic `/recording`, in JSON with its schema, ready to plot in Foxglove.
    Mcap,
}

impl WriteAs {
    /// All formats, each with its file ending.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Csv, "csv"),
        (Self::CsvGz, "csv.gz"),
        (Self::Parquet, "parquet"),
        (Self::Mat, "mat"),
        (Self::Mcap, "mcap"),
    ];

    /// The format of a file with this name. A name without an ending is text: standard output has none.
    ///
    /// # Errors
    /// The ending belongs to no format, or this build does not write the format. Call this before any work begins.
    pub fn of(path: &Path) -> Result<Self, InputError> {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .to_lowercase();
        let mut known = Self::ALL.iter().filter(|(_, ending)| {
            let rest = name.strip_suffix(ending);
            rest.is_some_and(|rest| rest.ends_with('.'))
        });
        let refused = |problem: String| {
            InputError::new(
                path.display().to_string(),
                problem,
                "name a file that ends in .csv, .csv.gz, .parquet, .mat or .mcap",
            )
        };
        match known.next_back() {
            Some((format, ending)) if !format.is_built() => Err(refused(format!(
                "this build of hil does not write .{ending}"
            ))),
            Some((format, _)) => Ok(*format),
            None => match path.extension() {
                None => Ok(Self::Csv),
                Some(ending) => {
                    let ending = quoted(&format!(".{}", ending.to_string_lossy()));
                    Err(refused(format!(
                        "the ending {ending} is of no format that is written"
                    )))
                }
            },
        }
    }

    fn is_built(self) -> bool {
        match self {
            Self::Csv | Self::CsvGz => true,
            Self::Parquet | Self::Mat | Self::Mcap => cfg!(feature = "formats"),
        }
    }

    /// Columns as the file `path`; `text` makes the text formats.
    ///
    /// # Errors
    /// Columns that the format cannot hold.
    #[cfg_attr(
        not(feature = "formats"),
        allow(unused_variables, reason = "text needs neither")
    )]
    pub fn bytes(
        self,
        path: &Path,
        comments: &[String],
        columns: impl FnOnce() -> Columns,
        text: impl FnOnce() -> Result<Vec<u8>, Unwritten>,
    ) -> Result<Vec<u8>, InputError> {
        let written = match self {
            Self::Csv => text(),
            Self::CsvGz => text().and_then(|text| text::gzipped(&text)),
            #[cfg(feature = "formats")]
            Self::Mat => mat::write(comments, &named(&columns())),
            #[cfg(feature = "formats")]
            Self::Parquet => parquet::write(comments, &named(&columns())),
            #[cfg(feature = "formats")]
            Self::Mcap => mcap::write(comments, &named(&columns())),
            #[allow(unreachable_patterns, reason = "where all formats are built")]
            _ => text(),
        };
        written.map_err(|Unwritten { problem, remedy }| {
            InputError::new(path.display().to_string(), problem, remedy)
        })
    }
}

/// Why columns are not written in a format.
#[derive(Debug)]
pub struct Unwritten {
    problem: String,
    remedy: &'static str,
}

impl Unwritten {
    /// An error of the library that writes the format.
    pub fn by(error: impl fmt::Display) -> Self {
        Self {
            problem: format!("not to be written in its format: {error}"),
            remedy: "name a file with another ending, and report this",
        }
    }
}

impl fmt::Display for WriteAs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = Self::ALL.iter().find(|(format, _)| format == self);
        f.write_str(named.map_or("csv", |(_, ending)| ending))
    }
}

/// A word that names no format.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct NoFormat(String);

impl FromStr for WriteAs {
    type Err = NoFormat;

    fn from_str(text: &str) -> Result<Self, NoFormat> {
        let known = Self::ALL.iter().find(|(_, ending)| *ending == text);
        match known {
            Some((format, _)) if format.is_built() => Ok(*format),
            Some(_) => Err(NoFormat(format!("this build of hil does not write {text}"))),
            None => Err(NoFormat("give csv, csv.gz, parquet, mat or mcap".into())),
        }
    }
}

/// Names and values.
pub type Columns = Vec<(String, Vec<f64>)>;

/// A column that is written.
struct Column<'c> {
    name: &'c str,
    /// Spelled as in programs: `mm/s`.
    unit: Option<&'static str>,
    values: &'c [f64],
}

fn named(columns: &Columns) -> Vec<Column<'_>> {
    let each = columns.iter().map(|(name, values)| Column {
        name,
        unit: unit_in(name),
        values,
    });
    each.collect()
}

/// The unit at the end of a column's name.
fn unit_in(name: &str) -> Option<&'static str> {
    const OTHERS: [(&str, &str); 7] = [
        ("mm_s2", "mm/s^2"),
        ("mm_s", "mm/s"),
        ("m_s", "m/s"),
        ("um_s", "um/s"),
        ("in_s", "in/s"),
        ("cm_s", "cm/s"),
        ("Hz", "Hz"),
    ];
    let of_channels = Channel::ALL
        .into_iter()
        .flat_map(Channel::units)
        .map(|unit| (unit.symbol, unit.symbol));
    let of_controls = control::UNITS.iter().map(|unit| (*unit, *unit));
    let known = OTHERS.into_iter().chain(of_channels).chain(of_controls);
    let ending = |(symbol, _): &(&str, &str)| {
        name.strip_suffix(symbol)
            .is_some_and(|rest| rest.ends_with('_'))
    };
    let longest = known.filter(ending).max_by_key(|(symbol, _)| symbol.len());
    longest.map(|(_, unit)| unit)
}

/// `value` to nine significant digits, the precision of written recordings, without trailing zeros or an exponent.
pub fn decimal(value: f64) -> String {
    let digits = DIGITS - 1;
    let rounded: f64 = format!("{value:.digits$e}").parse().unwrap_or(value);
    // Adding zero removes the sign of a negative zero.
    format!("{}", rounded + 0.0)
}

/// A table of results as a file of the given name, in the format of the name's ending. `columns` are names and values; every column
/// has as many values as the first.
///
/// # Errors
/// A value that is not finite; a table that the format cannot hold.
pub fn table(
    path: &Path,
    comments: &[String],
    columns: &[(&str, Vec<f64>)],
) -> Result<Vec<u8>, InputError> {
    let format = WriteAs::of(path).unwrap_or(WriteAs::Csv);
    for (name, values) in columns {
        check_column(&path.display().to_string(), name, values)?;
    }
    let owned = || {
        columns
            .iter()
            .map(|(name, values)| ((*name).to_owned(), values.clone()))
            .collect()
    };
    format.bytes(path, comments, owned, || text::table(comments, columns))
}
