//! Many recordings: traces of a list of them, resumable, and models of one specimen over time beside each other.
//!
//! | module | for |
//! |---|---|
//! | the root | [`Batch`]: traces of a [`List`], kept one by one; [`Summary`] and its [`Row`]s: what became of them |
//! | [`mod@compare`] | models of one specimen over time |
//! | [`list`] | a folder, a list of paths, a table of paths with their groups |
//! | [`outcome`] | what a row says of its trace |
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
