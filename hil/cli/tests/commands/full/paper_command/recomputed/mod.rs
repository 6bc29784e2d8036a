//! The result for every claim of the paper, with all its numbers, taken from reviewed runs, so that a test detects a change.

#![allow(clippy::approx_constant, reason = "a figure may be near a constant")]

mod characterization;
mod material;
mod methods;
mod orthogonal;
mod tables;
mod trends;

/// Name, verdict, and numbers to four digits.
pub type Row = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// Every claim, in the order of the report.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    [
        characterization::ROWS,
        material::ROWS,
        orthogonal::ROWS,
        tables::ROWS,
        trends::ROWS,
        methods::ROWS,
    ]
    .into_iter()
    .flatten()
}
