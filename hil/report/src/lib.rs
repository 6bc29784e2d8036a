//! `report.html`: what a trace found, or what became of the paper, in one file that opens anywhere and prints.
//!
//! Pictures are SVG within the page; nothing is loaded from elsewhere.
//!
//! | module | for |
//! |---|---|
//! | the root | [`render`]: the report of a trace; [`loop_picture`]: one loop of it |
//! | [`batch`] | one page for many traces |
//! | [`mod@paper`] | the report of the paper's claims |
//! | [`campaign`], [`characterization`], [`curves`] | pictures of the fault campaign, of a characterization, of any curves |
//! | [`conditions`] | what each effect gains on each condition held out |
//! | `size` | the picture of what a trace takes |
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

pub mod batch;
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
mod worst;

use std::ops::Range;

use mesh_damper_identify::trace::result::TraceResult;

pub use batch::{BatchEffect, BatchOutcome, BatchRow, batch_page};
pub use from_trace::declared;
pub use page::render;

/// What a report is made from.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportData {
    /// The page's title.
    pub title: String,
    /// What else is to be known of the test, as pairs of a name and a text, such as the effect that a demonstration
    /// hid.
    pub facts: Vec<(String, String)>,
    /// What was found.
    pub result: TraceResult,
    /// The recordings, those held out included.
    pub series: Vec<Series>,
}

/// One recording with the forces that the law gave before and after.
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
    /// The law with what was found, kN.
    pub after: Vec<f64>,
    /// Whether the force was measured, and not left out for a fault of a channel.
    pub measured: Vec<bool>,
    /// Its blocks in order; none where no cycle was found.
    pub blocks: Vec<SeriesBlock>,
}

/// Cycles of like amplitude and frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesBlock {
    /// The samples of one representative cycle, with the next one's first where the block goes on: the loop that is
    /// drawn.
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

/// The loop of one block, measured and before and after, as an SVG file of its own.
pub fn loop_picture(series: &Series, block: &SeriesBlock) -> String {
    let title = format!("Loop: {}", page::condition(block));
    charts::loop_chart(series, &block.cycle, &title, picture::STANDALONE).alone()
}

#[cfg(test)]
mod structure;
#[cfg(test)]
mod tests;
