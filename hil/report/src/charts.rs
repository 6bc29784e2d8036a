//! The pictures of a recording: force–displacement loops, and residuals over time.

use std::ops::Range;

use super::Series;
use super::palette::Colour;
use super::picture::{
    Axis, CURVE_POINTS, Dash, Layer, Look, Panel, Picture, Size, TIME_COLUMNS, envelope, thinned,
};

/// Names of the three forces in the pictures.
pub const MEASURED: &str = "measured";
/// The law alone.
pub const BEFORE: &str = "before";
/// The law with the effects found.
pub const AFTER: &str = "after";

/// mm
pub fn displacement() -> Axis {
    Axis::new("displacement", "mm")
}

/// kN
pub fn force() -> Axis {
    Axis::new("force", "kN")
}

/// The law alone, dashed, so that its colour is not its only mark.
pub fn before(points: Vec<(f64, f64)>) -> Layer {
    Layer::new(BEFORE, Colour::Before, Look::Line(Dash::Long), points)
}

/// The law with the effects found.
pub fn after(points: Vec<(f64, f64)>) -> Layer {
    Layer::new(AFTER, Colour::After, Look::Line(Dash::Solid), points)
}

/// Force over displacement for the samples of one cycle: measured, before, after.
pub fn loop_chart(series: &Series, cycle: &Range<usize>, title: &str, size: Size) -> Picture {
    let samples = thinned(cycle.clone(), CURVE_POINTS);
    let points = |force: &[f64]| -> Vec<(f64, f64)> {
        let point = |&i: &usize| Some((*series.displacement.get(i)?, *force.get(i)?));
        samples.iter().filter_map(point).collect()
    };
    let measured = Layer::new(
        MEASURED,
        Colour::Measured,
        Look::Broad,
        points(&series.force),
    );
    let panel = Panel {
        title: String::new(),
        x: displacement(),
        y: force(),
        layers: vec![
            measured,
            before(points(&series.before)),
            after(points(&series.after)),
        ],
    };
    Picture::of(title, size, panel)
}

/// The force's error before and after over time, recordings one after another.
pub fn residual_chart(series: &[Series], size: Size) -> Picture {
    let residuals = |force: fn(&Series) -> &[f64]| -> Vec<(f64, f64)> {
        let mut offset = 0.0;
        let mut points = Vec::new();
        for one in series {
            let start = one.time.first().copied().unwrap_or_default();
            let measured = |&i: &usize| one.measured.get(i).copied().unwrap_or(true);
            let point = |i: usize| {
                let time = one.time.get(i)? - start + offset;
                Some((time, one.force.get(i)? - force(one).get(i)?))
            };
            points.extend((0..one.time.len()).filter(measured).filter_map(point));
            offset += one.time.last().map_or(0.0, |end| end - start);
        }
        envelope(&points, TIME_COLUMNS)
    };
    let time = if series.len() > 1 {
        "time (recordings one after another)"
    } else {
        "time"
    };
    let layer = |name, colour, force| Layer::new(name, colour, Look::Fine, residuals(force));
    let panel = Panel {
        title: String::new(),
        x: Axis::new(time, "s"),
        y: Axis::new("measured − law", "kN"),
        layers: vec![
            layer(BEFORE, Colour::Before, |one: &Series| &one.before[..]),
            layer(AFTER, Colour::After, |one| &one.after[..]),
        ],
    };
    Picture::of("Residual over time", size, panel)
}
