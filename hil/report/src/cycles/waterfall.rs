//! Loops one above another: by condition, or by cycle if there is only one condition.

use std::ops::Range;

use super::figures::{BlockFigures, Of};
use super::pictures::loop_points;
use crate::charts::{self, MEASURED};
use crate::page::condition;
use crate::palette::Colour;
use crate::picture::{Axis, Layer, Look, Panel, Picture};
use crate::text;

/// Most loops.
const MOST: usize = 14;
/// Points of one loop.
const POINTS: usize = 160;
/// Height of the picture for each loop, and in addition to them, px.
const HEIGHT: (u32, u32) = (52, 130);
/// Each loop is raised above the previous one by this fraction of the largest range of force.
const RAISED: f64 = 0.55;

/// The picture, and its contents.
pub struct Waterfall {
    pub picture: Picture,
    pub caption: String,
}

/// One loop.
struct Row<'a, 'b> {
    name: String,
    block: &'a BlockFigures<'b>,
    cycle: Range<usize>,
}

/// Measured loops with the law's, from the slowest and smallest at the bottom to the fastest and largest at the top.
pub fn picture(blocks: &[BlockFigures<'_>]) -> Waterfall {
    let (rows, by) = match blocks {
        [one] => (by_cycle(one), "by cycle, the first below"),
        several => (by_condition(several), "by frequency and amplitude"),
    };
    let spans = rows.iter().map(|row| {
        let points = loop_points(row.block, row.cycle.clone(), Of::Measured, POINTS);
        let force = points.iter().map(|point| point.1);
        let (low, high) = mesh_damper_recording::extremes::least_and_largest(force);
        high - low
    });
    let step = RAISED * spans.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let mut layers = Vec::new();
    let mut labels = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let raised = index as f64 * step;
        labels.push((raised, row.name.clone()));
        let layer = |of: Of| {
            let points = loop_points(row.block, row.cycle.clone(), of, POINTS);
            points
                .into_iter()
                .map(|(y, force)| (y, force + raised))
                .collect()
        };
        let measured = layer(Of::Measured);
        layers.push(Layer::new(MEASURED, Colour::Measured, Look::Broad, measured).raised(raised));
        layers.push(charts::after(layer(Of::After)).raised(raised));
    }
    let panel = Panel {
        title: String::new(),
        x: charts::displacement(),
        y: Axis {
            labels: Some(labels),
            ..charts::force()
        },
        layers,
    };
    let (width, font) = (760, 15);
    let height = HEIGHT.1 + HEIGHT.0 * rows.len() as u32;
    Waterfall {
        picture: Picture::of(
            format!("Loops, stacked, {by}"),
            ((width, height), font),
            panel,
        ),
        caption: format!(
            "force over displacement {by}; each loop is raised by {} kN above the one below, and its label marks the level of 0 kN",
            text::number(step)
        ),
    }
}

fn by_condition<'a, 'b>(blocks: &'a [BlockFigures<'b>]) -> Vec<Row<'a, 'b>> {
    let mut order: Vec<&BlockFigures<'_>> = blocks.iter().collect();
    order.sort_by(|a, b| {
        let key = |one: &BlockFigures<'_>| {
            // Measured frequencies differ slightly even if the settings are equal.
            let octave = (one.block.frequency.log2() * 12.0).round();
            (octave, one.block.amplitude)
        };
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let chosen = spread(order.len());
    let rows = chosen.map(|i| Row {
        name: condition(order[i].block),
        block: order[i],
        cycle: order[i].block.cycle.clone(),
    });
    rows.collect()
}

fn by_cycle<'a, 'b>(block: &'a BlockFigures<'b>) -> Vec<Row<'a, 'b>> {
    let cycles = &block.block.cycles;
    let rows = spread(cycles.len()).map(|i| {
        // The next cycle's first sample closes a loop.
        let closing = usize::from(i + 1 < cycles.len());
        Row {
            name: format!("cycle {}", i + 1),
            block,
            cycle: cycles[i].start..cycles[i].end + closing,
        }
    });
    rows.collect()
}

/// At most [`MOST`] of this many, evenly spread, including the first and the last.
fn spread(count: usize) -> impl Iterator<Item = usize> {
    let chosen = count.min(MOST);
    (0..chosen).map(move |i| match chosen {
        1 => 0,
        _ => i * (count - 1) / (chosen - 1),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_and_the_last_are_among_those_chosen() {
        let all: Vec<usize> = spread(5).collect();
        assert_eq!(all, [0, 1, 2, 3, 4]);
        let some: Vec<usize> = spread(1000).collect();
        assert_eq!((some.len(), some[0], some[MOST - 1]), (MOST, 0, 999));
        assert_eq!(spread(1).collect::<Vec<_>>(), [0]);
        assert_eq!(spread(0).count(), 0);
    }
}
