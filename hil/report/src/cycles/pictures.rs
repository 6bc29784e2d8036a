//! Curves over amplitude, frequency and cycles.

use mesh_damper_recording::cycles::{alike, median};

use super::figures::{BlockFigures, CycleFigures, Of, middle_line};
use crate::charts::{self, MEASURED};
use crate::palette::Colour;
use crate::picture::{
    Axis, Dash, HALF, Layer, Look, Mark, Panel, Picture, SMALL, TIME_COLUMNS, WIDE, envelope,
    thinned,
};
use crate::text;

/// Points of a middle line.
const LINE: usize = 120;
/// How the levels of the other condition are distinguished. With more levels, all points look alike.
const LEVELS: [(Colour, Mark, Dash); 5] = [
    (Colour::After, Mark::Disc, Dash::Solid),
    (Colour::Before, Mark::Square, Dash::Long),
    (Colour::Green, Mark::Triangle, Dash::Mixed),
    (Colour::Pink, Mark::Diamond, Dash::Short),
    (Colour::Yellow, Mark::Ring, Dash::Dotted),
];

/// The contents of the two pictures of [`backbones`].
pub const BACKBONES: [&str; 2] = [
    "half of the force's range over the amplitude, block by block",
    "mean of the force on the way up and on the way down, largest block",
];

/// Half of the force's range over the amplitude, and the middle line of the largest block's loop.
pub fn backbones(blocks: &[BlockFigures<'_>]) -> [Picture; 2] {
    let layer = |of: Of, points: Vec<(f64, f64)>, marks: bool| match (of, marks) {
        (Of::Measured, true) => {
            Layer::new(MEASURED, Colour::Measured, Look::Marks(Mark::Disc), points)
        }
        (Of::Measured, false) => Layer::new(MEASURED, Colour::Measured, Look::Broad, points),
        (Of::Before, _) => charts::before(points),
        (Of::After, _) => charts::after(points),
    };
    let peaks = Of::ALL.into_iter().enumerate().map(|(index, of)| {
        let points = blocks.iter().map(|block| {
            let amplitude = block.median(|one| one.stiffness[0].amplitude);
            (amplitude, block.median(|one| one.peak[index]))
        });
        layer(of, in_order(points.collect()), true)
    });
    let largest = blocks
        .iter()
        .max_by(|a, b| a.block.amplitude.total_cmp(&b.block.amplitude));
    let middles = Of::ALL.into_iter().map(|of| {
        let line = largest.and_then(|block| {
            let cycle = block.block.cycle.clone();
            let displacement = block.series.displacement.get(cycle.clone())?;
            middle_line(displacement, of.force(block.series).get(cycle)?, LINE)
        });
        layer(of, line.unwrap_or_default(), false)
    });
    let panel = |x, y, layers| Panel {
        title: String::new(),
        x,
        y,
        layers,
    };
    [
        Picture::of(
            "Backbone: force over amplitude",
            HALF,
            panel(
                Axis::new("amplitude", "mm"),
                Axis::new("half of the force's range", "kN"),
                peaks.collect(),
            ),
        ),
        Picture::of(
            "Middle line of the loop of the largest amplitude",
            HALF,
            panel(
                charts::displacement(),
                Axis::new("mean force", "kN"),
                middles.collect(),
            ),
        ),
    ]
}

/// K′, K″ and η over amplitude, with a curve for each frequency; `None` if there is only one amplitude.
pub fn over_amplitude(blocks: &[BlockFigures<'_>]) -> Option<Vec<Picture>> {
    over(
        blocks,
        ("amplitude", "mm"),
        amplitude,
        ("frequency", "Hz"),
        frequency,
    )
}

/// The same over frequency, with a curve for each amplitude; `None` if there is only one frequency.
pub fn over_frequency(blocks: &[BlockFigures<'_>]) -> Option<Vec<Picture>> {
    over(
        blocks,
        ("frequency", "Hz"),
        frequency,
        ("amplitude", "mm"),
        amplitude,
    )
}

fn amplitude(block: &BlockFigures<'_>) -> f64 {
    block.block.amplitude
}

fn frequency(block: &BlockFigures<'_>) -> f64 {
    block.block.frequency
}

type Condition = fn(&BlockFigures<'_>) -> f64;
type Figure = fn(&CycleFigures, usize) -> f64;

/// Name, unit and value of the figures in the pictures.
const FIGURES: [(&str, &str, Figure); 3] = [
    ("storage stiffness K′", "kN/mm", |one, of| {
        one.stiffness[of].storage
    }),
    ("loss stiffness K″", "kN/mm", |one, of| {
        one.stiffness[of].loss
    }),
    ("loss factor η", "", |one, of| {
        one.stiffness[of].loss_factor()
    }),
];

fn over(
    blocks: &[BlockFigures<'_>],
    (along, unit): (&str, &str),
    at: Condition,
    (other, other_unit): (&str, &str),
    level_of: Condition,
) -> Option<Vec<Picture>> {
    if levels(blocks, at).len() < 2 {
        return None;
    }
    let mut levels = levels(blocks, level_of);
    if levels.len() > LEVELS.len() {
        levels = Vec::new();
    }
    let pictures = FIGURES.map(|(name, unit_of, figure)| {
        let points = |of: usize, level: Option<f64>| {
            let these = blocks
                .iter()
                .filter(move |block| level.is_none_or(|level| alike(level, level_of(block))));
            let points = these.map(|block| (at(block), block.median(|one| figure(one, of))));
            in_order(points.collect())
        };
        let mut layers = Vec::new();
        for (&level, (colour, mark, dash)) in levels.iter().zip(LEVELS) {
            let name = format!("{} {other_unit}", text::nominal(level));
            layers.push(Layer::new(
                &name,
                colour,
                Look::Line(dash),
                points(2, Some(level)),
            ));
            layers.push(Layer::new(
                &name,
                colour,
                Look::Marks(mark),
                points(0, Some(level)),
            ));
        }
        if levels.is_empty() {
            // With many levels no line joins the points of a level.
            layers.push(Layer::new(
                "augmented model",
                Colour::After,
                Look::Marks(Mark::Cross),
                points(2, None),
            ));
            layers.push(Layer::new(
                MEASURED,
                Colour::Measured,
                Look::Marks(Mark::Disc),
                points(0, None),
            ));
        }
        let axis = Axis::new(along, unit);
        let ends = blocks.iter().map(at);
        let panel = Panel {
            title: String::new(),
            // The steps of a test over a decade are even in the logarithm.
            x: if is_wide(ends) {
                axis.logarithmic()
            } else {
                axis
            },
            y: Axis::new(name, unit_of),
            layers,
        };
        Picture::of(format!("{name} over {along}, by {other}"), SMALL, panel)
    });
    Some(pictures.into())
}

/// Whether the largest is at least ten times the smallest.
fn is_wide(values: impl Iterator<Item = f64> + Clone) -> bool {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    least > 0.0 && values.fold(0.0, f64::max) >= 10.0 * least
}

/// The levels of a condition in order; for similar blocks the median.
fn levels(blocks: &[BlockFigures<'_>], of: Condition) -> Vec<f64> {
    let mut values: Vec<f64> = blocks.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    let mut levels: Vec<Vec<f64>> = Vec::new();
    for value in values {
        match levels.last_mut() {
            Some(level) if alike(level[0], value) => level.push(value),
            _ => levels.push(vec![value]),
        }
    }
    levels
        .into_iter()
        .filter_map(|level| median(level.into_iter()))
        .collect()
}

/// Points in order of x; points with the same x become one, their mean.
fn in_order(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups = points.chunk_by(|a, b| (a.0 - b.0).abs() <= 0.01 * a.0.abs());
    let mean = |group: &[(f64, f64)]| {
        let count = group.len() as f64;
        let sum = group
            .iter()
            .fold((0.0, 0.0), |sum, point| (sum.0 + point.0, sum.1 + point.1));
        (sum.0 / count, sum.1 / count)
    };
    groups.map(mean).collect()
}

/// Storage stiffness and loss factor of every cycle, blocks one after another with a gap between them.
pub fn over_cycles(blocks: &[BlockFigures<'_>]) -> Picture {
    let panel = |(name, unit, figure): (&str, &str, Figure)| {
        let layers = Of::ALL.into_iter().enumerate().map(|(index, of)| {
            let figures = blocks.iter().map(|block| {
                let cycles = block.cycles.iter();
                cycles.map(move |cycle| cycle.as_ref().map_or(f64::NAN, |one| figure(one, index)))
            });
            layer_over_cycles(of, numbered(figures))
        });
        Panel {
            title: String::new(),
            x: Axis::new("cycle", ""),
            y: Axis::new(name, unit),
            layers: layers.collect(),
        }
    };
    let title = "Storage stiffness and loss factor over cycles";
    let size = ((WIDE.0.0, 260), WIDE.1);
    Picture::of_panels(title, size, 1, vec![panel(FIGURES[0]), panel(FIGURES[2])])
}

/// Values of cycles over their numbers from 1 on, block by block with a gap after each.
fn numbered(blocks: impl Iterator<Item = impl Iterator<Item = f64>>) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    let mut cycle = 0.0;
    for block in blocks {
        for value in block {
            cycle += 1.0;
            points.push((cycle, value));
        }
        points.push((cycle + 0.5, f64::NAN));
    }
    // An envelope would hide a gap, which is invisible among thousands of cycles anyway.
    if points.len() > 2 * TIME_COLUMNS {
        points.retain(|(_, value)| value.is_finite());
        points = envelope(&points, TIME_COLUMNS);
    }
    points
}

fn layer_over_cycles(of: Of, points: Vec<(f64, f64)>) -> Layer {
    match of {
        Of::Measured => Layer::new(MEASURED, Colour::Measured, Look::Broad, points),
        Of::Before => charts::before(points),
        Of::After => charts::after(points),
    }
}

/// The samples of a loop for drawing, closed.
pub fn loop_points(
    block: &BlockFigures<'_>,
    cycle: std::ops::Range<usize>,
    of: Of,
    most: usize,
) -> Vec<(f64, f64)> {
    let (displacement, force) = (&block.series.displacement, of.force(block.series));
    let end = cycle.end.min(displacement.len()).min(force.len());
    let chosen = thinned(cycle.start.min(end)..end, most);
    chosen
        .into_iter()
        .map(|i| (displacement[i], force[i]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_one_place_become_their_mean() {
        let points = in_order(vec![(0.2, 3.0), (0.1, 1.0), (0.1001, 2.0)]);
        assert_eq!(points.len(), 2);
        assert!((points[0].1 - 1.5).abs() < 1e-12 && points[1] == (0.2, 3.0));
        assert!(is_wide([0.1, 1.0].into_iter()) && !is_wide([0.2, 1.0].into_iter()));
    }

    #[test]
    fn cycles_are_counted_over_gaps() {
        let blocks = [vec![5.0, f64::NAN], vec![6.0]];
        let counted = numbered(blocks.into_iter().map(Vec::into_iter));
        let cycles: Vec<f64> = counted.iter().map(|point| point.0).collect();
        assert_eq!(cycles, [1.0, 2.0, 2.5, 3.0, 3.5]);
        assert_eq!(counted[3].1, 6.0);
        assert!(counted[2].1.is_nan());
        // A fatigue test of one block.
        let many = numbered([(0..100_000).map(f64::from)].into_iter());
        assert_eq!(many.len(), 2 * TIME_COLUMNS);
    }
}
