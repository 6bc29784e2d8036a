//! `report.html`: the result of a trace, or of the recomputed paper, in one file that opens anywhere and can be printed.
//!
//! Pictures are SVG within the page; nothing is loaded from elsewhere.
//!
//! | module | for |
//! |---|---|
//! | the root | [`render`]: the report of a trace; [`loop_picture`]: one loop of it |
//! | [`batch`] | one page for many traces |
//! | [`mod@paper`] | the report of the paper's claims |
//! | [`campaign`], [`characterization`], [`curves`] | pictures of the fault campaign, of a characterization, of any curves |
//! | [`conditions`] | the gain of each effect on each condition held out |
//! | `size` | the picture of the memory and time of a trace |
//! | [`over_time`] | the picture of values with their intervals over time |
//! | [`transmissibility`] | the picture of a sweep |
//! | [`text`] | numbers, names and verdicts in words |
//!
//! ```
//! use mesh_damper_report::curves::{Curve, panels};
//!
//! let curve = Curve { name: "a spring", points: vec![(-0.1, -0.8), (0.1, 0.8)] };
//! let svg = panels("A loop", &[("1 Hz".into(), vec![curve])]);
//! assert!(svg.starts_with("<svg"));
//! ```

#![forbid(unsafe_code)]
#![cfg_attr(
    not(feature = "studies"),
    allow(
        dead_code,
        reason = "some of what draws is for the pages of the studies alone"
    )
)]

pub mod bars;
mod batch;
pub mod campaign;
#[cfg(feature = "studies")]
pub mod characterization;
mod charts;
pub mod conditions;
pub mod curves;
mod cycles;
#[cfg(test)]
mod effect_pages;
mod evidence;
mod from_trace;
mod html;
mod next;
pub mod over_time;
mod page;
mod palette;
#[cfg(feature = "studies")]
pub mod paper;
mod picture;
#[cfg(feature = "studies")]
mod plots;
mod reasoning;
mod residual;
#[cfg(feature = "studies")]
pub mod size;
pub mod text;
pub mod transmissibility;
mod why;
mod worst;

use std::ops::Range;

use mesh_damper_identify::trace::result::TraceResult;

pub use batch::{BatchEffect, BatchOutcome, BatchRow, batch_page};
pub use from_trace::declared;
pub use page::render;

/// The input of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportData {
    /// The page's title.
    pub title: String,
    /// Further facts about the test, as pairs of a name and a text, for example the effect that a demonstration hid.
    pub facts: Vec<(String, String)>,
    /// The result.
    pub result: TraceResult,
    /// The recordings, including the held-out ones.
    pub series: Vec<Series>,
}

/// One recording with the forces of the law before and after.
///
/// All channels have as many samples as `time`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// The recording's name.
    pub name: String,
    /// s
    pub time: Vec<f64>,
    /// mm
    pub displacement: Vec<f64>,
    /// mm/s
    pub velocity: Vec<f64>,
    /// Measured, kN.
    pub force: Vec<f64>,
    /// The law alone, kN.
    pub before: Vec<f64>,
    /// The law with the effects found, kN.
    pub after: Vec<f64>,
    /// Whether the force was measured, and not excluded because of a channel fault.
    pub measured: Vec<bool>,
    /// Its blocks in order; empty if no cycle was found.
    pub blocks: Vec<SeriesBlock>,
}

/// Cycles of similar amplitude and frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesBlock {
    /// The samples of one representative cycle, for the drawn loop. They include the first sample of the next cycle if the block
    /// continues.
    pub cycle: Range<usize>,
    /// The samples of each of its cycles, in order.
    pub cycles: Vec<Range<usize>>,
    /// mm
    pub amplitude: f64,
    /// Hz
    pub frequency: f64,
    /// Whether that cycle was never fitted.
    pub held_out: bool,
}

/// The loop of one block, measured and before and after, as a separate SVG file.
pub fn loop_picture(series: &Series, block: &SeriesBlock) -> String {
    let title = format!("Loop: {}", page::condition(block));
    charts::loop_chart(series, &block.cycle, &title, picture::STANDALONE).alone()
}

#[cfg(test)]
mod structure;
#[cfg(test)]
mod tests;
