//! Characterized loops as one SVG: load–unload cycles with their middle line, or blocks of cycles with their average.

use mesh_damper_characterize::{DynamicTest, StaticTest};

use super::charts;
use super::palette::Colour;
use super::picture::{CURVE_POINTS, Dash, Layer, Look, Panel, Picture, SMALL, STANDALONE, thinned};
use super::text;

/// Most panels.
const MOST: usize = 5;

/// The first five cycles, each with its middle line and the line whose slope is k_eq.
pub fn static_chart(test: &StaticTest) -> String {
    let cycles = test.cycles.iter().take(MOST).enumerate();
    let panels = cycles.map(|(index, cycle)| {
        let turn = cycle.displacement_max;
        let slope = vec![(0.0, 0.0), (turn, cycle.equivalent_stiffness * turn)];
        panel(
            format!(
                "cycle {}: {} kN/mm, loss factor {}",
                index + 1,
                text::number(cycle.equivalent_stiffness),
                text::number(cycle.loss_factor)
            ),
            &cycle.curve,
            vec![
                Layer::new(
                    "middle line",
                    Colour::Before,
                    Look::Line(Dash::Long),
                    cycle.middle.clone(),
                ),
                Layer::new("slope k_eq", Colour::After, Look::Line(Dash::Solid), slope),
            ],
        )
    });
    draw("Load–unload cycles", panels.collect())
}

/// The first five blocks: all their steady cycles, and the averaged one.
pub fn dynamic_chart(test: &DynamicTest) -> String {
    let panels = test.blocks.iter().take(MOST).map(|block| {
        let averaged = &block.averaged_loop;
        let closed = averaged.iter().chain(averaged.first()).copied().collect();
        panel(
            format!(
                "{} mm, {} Hz: {} kN/mm, loss factor {}",
                text::number(block.averaged.amplitude),
                text::number(block.frequency),
                text::number(block.averaged.stiffness),
                text::number(block.averaged.loss_factor)
            ),
            &block.measured,
            vec![Layer::new(
                "averaged",
                Colour::After,
                Look::Line(Dash::Solid),
                closed,
            )],
        )
    });
    draw("Loops of blocks with their average", panels.collect())
}

fn panel(title: String, measured: &[(f64, f64)], lines: Vec<Layer>) -> Panel {
    let chosen = thinned(0..measured.len(), 4 * CURVE_POINTS);
    let measured = chosen.into_iter().map(|index| measured[index]).collect();
    let measured = Layer::new("measured", Colour::Measured, Look::Broad, measured);
    Panel {
        title,
        x: charts::displacement(),
        y: charts::force(),
        layers: [measured].into_iter().chain(lines).collect(),
    }
}

/// A single panel fills the picture.
fn draw(title: &str, panels: Vec<Panel>) -> String {
    match panels.len() {
        0 | 1 => Picture::of_panels(title, STANDALONE, 1, panels).alone(),
        _ => Picture::of_panels(title, (SMALL.0, 13), 3, panels).alone(),
    }
}
