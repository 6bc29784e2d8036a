//! Recordings from files and from columns in memory, and their motion.

mod as_they_come;
mod columns;
mod control_columns;
mod exchanged;
mod files;
#[cfg(feature = "formats")]
mod formats;
#[cfg(feature = "formats")]
mod formats_excel;
mod input;
mod long;
mod motion;
#[cfg(feature = "formats")]
mod several_tables;
#[cfg(feature = "formats")]
mod writing;
