//! Characterized loops as one SVG: load–unload cycles with their middle line, or blocks of cycles with their average.

use mesh_damper_characterize::{DynamicTest, StaticTest};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{self, AFTER, Area, BEFORE, CURVE_POINTS, Drawn, FINE, FONT, INK, MEASURED};
use super::text;

/// Most panels.
const MOST: usize = 5;

/// A loop with the lines that are made of it.
struct Panel {
    title: String,
    measured: Vec<(f64, f64)>,
    lines: Vec<Line>,
}

struct Line {
    name: &'static str,
    colour: RGBColor,
    points: Vec<(f64, f64)>,
}

impl Line {
    fn new(name: &'static str, colour: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            name,
            colour,
            points,
        }
    }
}

/// The first five cycles, each with its middle line and the line whose slope is k_eq.
pub fn static_chart(test: &StaticTest) -> String {
    let panels: Vec<Panel> = test
        .cycles
        .iter()
        .take(MOST)
        .enumerate()
        .map(|(index, cycle)| {
            let turn = cycle.displacement_max;
            Panel {
                title: format!(
                    "cycle {}: {} kN/mm, loss factor {}",
                    index + 1,
                    text::number(cycle.equivalent_stiffness),
                    text::number(cycle.loss_factor)
                ),
                measured: cycle.curve.clone(),
                lines: vec![
                    Line::new("middle line", BEFORE, cycle.middle.clone()),
                    Line::new(
                        "slope k_eq",
                        AFTER,
                        vec![(0.0, 0.0), (turn, cycle.equivalent_stiffness * turn)],
                    ),
                ],
            }
        })
        .collect();
    draw(&panels)
}

/// The first five blocks: all their steady cycles, and the averaged one.
pub fn dynamic_chart(test: &DynamicTest) -> String {
    let panels: Vec<Panel> = test
        .blocks
        .iter()
        .take(MOST)
        .map(|block| {
            let closed = block
                .averaged_loop
                .iter()
                .chain(block.averaged_loop.first());
            Panel {
                title: format!(
                    "{} mm, {} Hz: {} kN/mm, loss factor {}",
                    text::number(block.averaged.amplitude),
                    text::number(block.frequency),
                    text::number(block.averaged.stiffness),
                    text::number(block.averaged.loss_factor)
                ),
                measured: block.measured.clone(),
                lines: vec![Line::new("averaged", AFTER, closed.copied().collect())],
            }
        })
        .collect();
    draw(&panels)
}

/// A single panel fills the picture; several leave the legend the place after the last.
fn draw(panels: &[Panel]) -> String {
    let single = panels.len() <= 1;
    let (style, split) = if single {
        (&charts::STANDALONE, (1, 1))
    } else {
        (&charts::PANELS, (2, 3))
    };
    charts::draw(style, |area| {
        let places = area.split_evenly(split);
        let font = FINE * style.font();
        for (panel, place) in panels.iter().zip(&places) {
            let lines = panel.lines.iter().flat_map(|line| &line.points);
            let points = || panel.measured.iter().chain(lines.clone());
            let x = charts::padded(points().map(|point| point.0));
            let y = charts::padded(points().map(|point| point.1));
            let (title, plot) = place.split_vertically(2 * font);
            let text = (FONT, font).into_font().color(&INK);
            let at = Pos::new(HPos::Center, VPos::Center);
            let centre = (title.dim_in_pixel().0 as i32 / 2, font as i32);
            title.draw(&Text::new(panel.title.clone(), centre, text.pos(at)))?;
            let axes = if single { style } else { &charts::SMALL };
            let labels = ("displacement, mm", "force, kN");
            let mut chart = charts::axes(&plot, axes, (x, y), labels)?;
            let chosen = charts::thinned(0..panel.measured.len(), 4 * CURVE_POINTS);
            let measured = chosen.into_iter().map(|index| panel.measured[index]);
            chart.draw_series(LineSeries::new(
                measured,
                MEASURED.mix(0.5).stroke_width(4 * FINE),
            ))?;
            for line in &panel.lines {
                chart.draw_series(LineSeries::new(
                    line.points.iter().copied(),
                    line.colour.stroke_width(2 * FINE),
                ))?;
            }
            if single {
                legend(
                    &chart.plotting_area().strip_coord_spec(),
                    panel,
                    font as i32,
                )?;
            }
        }
        match (panels.first(), places.get(panels.len())) {
            (Some(panel), Some(place)) if !single => legend(place, panel, font as i32),
            _ => Ok(()),
        }
    })
}

/// Names beside their colours, in the upper left corner.
fn legend(area: &Area<'_>, panel: &Panel, font: i32) -> Drawn {
    let measured = ("measured", MEASURED.mix(0.5), 4);
    let lines = panel
        .lines
        .iter()
        .map(|line| (line.name, line.colour.mix(1.0), 2));
    for (row, (name, colour, width)) in (0..).zip([measured].into_iter().chain(lines)) {
        let y = font + row * (font * 3 / 2);
        let line = vec![(font, y), (font * 3, y)];
        area.draw(&PathElement::new(line, colour.stroke_width(FINE * width)))?;
        let text = (FONT, font as u32).into_font().color(&INK);
        let place = Pos::new(HPos::Left, VPos::Center);
        area.draw(&Text::new(name, (font * 7 / 2, y), text.pos(place)))?;
    }
    Ok(())
}
