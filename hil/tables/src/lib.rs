//! A laboratory's file as tables: columns with names, units and notes, in any format, and columns as a file.
//!
//! | module | for |
//! |---|---|
//! | [`files`] | the formats, one source file each; [`csv_text`]: the text of a CSV file as it is read |
//! | [`columns`] | which column is which [`channel`] or [`control`] input, in which of the [`units`] |
//! | [`mod@write`] | columns as a file |
//! | [`read_limit`] | how large a file may be |
//! | [`rows`] | the rows of a file, with their lines |

#![forbid(unsafe_code)]
#![cfg_attr(
    not(feature = "formats"),
    allow(
        dead_code,
        unused_imports,
        reason = "some of what reads files is for the formats that are left out"
    )
)]

pub mod budget;
pub mod channel;
pub mod columns;
pub mod control;
pub mod csv_text;
pub mod files;
pub mod read_limit;
mod room;
pub mod rows;
pub mod units;
pub mod write;
