//! Recordings from files and from columns in memory, and their motion.

mod columns;
mod control_columns;
mod files;
mod formats;
mod formats_excel;
mod input;
mod motion;
mod several_tables;
mod writing;
