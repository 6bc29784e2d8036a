//! The tables of a batch: one row per trace, and one row per parameter.

/// A table of these columns: of each its name, its contents and its values.
macro_rules! columns {
    ($($name:ident: $about:literal, $values:expr;)+) => {
        crate::table::Table(vec![$(crate::table::Column {
            name: stringify!($name),
            about: $about,
            values: $values,
        },)+])
    };
}

mod csv;
mod outcomes;
mod parameters;
mod parquet;

pub use outcomes::outcomes;
pub use parameters::parameters;

/// A table: its columns, all of the same length.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(pub Vec<Column>);

/// One column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, ending with the unit if it has one.
    pub name: &'static str,
    /// Its contents, in a sentence.
    pub about: &'static str,
    /// A value for every row.
    pub values: Values,
}

/// The values of a column; `None` if a row has none.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Texts.
    Text(Vec<Option<String>>),
    /// Lists of texts.
    Texts(Vec<Vec<String>>),
    /// Numbers.
    Real(Vec<Option<f64>>),
    /// Counts.
    Count(Vec<Option<u64>>),
    /// True or false.
    Flag(Vec<Option<bool>>),
}

impl Values {
    /// The name of its type on the pages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "text",
            Self::Texts(_) => "list of texts",
            Self::Real(_) => "number",
            Self::Count(_) => "whole number",
            Self::Flag(_) => "true or false",
        }
    }
}
