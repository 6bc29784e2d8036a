//! Many recordings: a resumable list of traces, and a comparison of models of one specimen over time.
//!
//! | module | for |
//! |---|---|
//! | the root | [`Batch`]: traces of a [`List`], stored one by one; [`Summary`] and its [`Row`]s: their outcomes |
//! | [`mod@compare`] | models of one specimen over time |
//! | [`list`] | a folder, a list of paths, a table of paths with their groups |
//! | [`outcome`] | the part of a row about its trace |
//! | [`mod@table`] | the rows as Parquet and CSV |

#![forbid(unsafe_code)]

pub mod compare;
mod identity;
mod journal;
mod leftover;
pub mod list;
mod one;
pub mod outcome;
mod page;
mod row;
mod run;
mod settings;
pub mod table;
mod work;

pub use list::{List, Task};
pub use row::{Row, Summary};
pub use run::{Batch, Progress};
pub use settings::Settings;
