//! Charts of several curves with points, side by side.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{self, Drawn, FINE, FONT, INK, Style};
use super::text;

/// Colours that remain distinct to the colour-blind (Okabe and Ito 2008).
pub const GREY: RGBColor = charts::MEASURED;
/// Of eq 20.
pub const ORANGE: RGBColor = charts::BEFORE;
/// Of the crate's surfaces.
pub const BLUE: RGBColor = charts::AFTER;
/// Of finite elements.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
/// Of what the text says.
pub const PINK: RGBColor = RGBColor(204, 121, 167);
/// One for each of the five densities or amplitudes.
pub const SHADES: [RGBColor; 5] = [
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(0, 0, 0),
];

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line.
    Line,
    /// Points alone.
    Points,
    /// Points that a line joins.
    Both,
    /// A broad pale line beneath the others, for what was measured.
    Broad,
}

/// One curve; a closed one repeats its first point.
#[derive(Clone, Debug)]
pub struct Trace {
    /// In order.
    pub points: Vec<(f64, f64)>,
    /// Its colour.
    pub colour: RGBColor,
    /// How it is drawn.
    pub mark: Mark,
}

/// One chart.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Above it.
    pub title: String,
    /// Of the axes.
    pub labels: (&'static str, &'static str),
    /// In the order in which they are drawn.
    pub traces: Vec<Trace>,
    /// Whether the ordinates are decimal logarithms, of which the axis tells the numbers.
    pub logarithmic: bool,
}

/// Size of one panel, px.
const PANEL: (u32, u32) = (380, 300);

/// Panels in rows of three.
pub fn panels(all: &[Panel]) -> String {
    let columns = 3;
    let rows = all.len().div_ceil(columns).max(1);
    let style = Style::of_size(PANEL.0 * columns as u32, PANEL.1 * rows as u32);
    charts::draw(&style, |area| {
        let places = area.split_evenly((rows, columns));
        for (panel, place) in all.iter().zip(&places) {
            draw(panel, place)?;
        }
        Ok(())
    })
}

fn draw(panel: &Panel, place: &charts::Area<'_>) -> Drawn {
    let font = FINE * charts::SMALL.font();
    let letters = (FONT, font).into_font().color(&INK);
    let (head, body) = place.split_vertically(font * 3 / 2);
    head.draw(&Text::new(
        panel.title.clone(),
        (5 * font as i32, font as i32 / 2),
        letters.pos(Pos::new(HPos::Left, VPos::Top)),
    ))?;
    let points = || panel.traces.iter().flat_map(|trace| &trace.points);
    let x = charts::padded(points().map(|point| point.0));
    let y = charts::padded(points().map(|point| point.1));
    let written = (
        |value: f64| charts::tick(value, &x),
        |value: f64| match panel.logarithmic {
            true => text::number(10_f64.powf(value)),
            false => charts::tick(value, &y),
        },
    );
    let ranges = (x.clone(), y.clone());
    let ticks: (&dyn Fn(f64) -> String, &dyn Fn(f64) -> String) = (&written.0, &written.1);
    let mut chart = charts::axes_labelled(&body, &charts::SMALL, ranges, panel.labels, ticks)?;
    for trace in &panel.traces {
        let chosen = charts::thinned(0..trace.points.len(), charts::CURVE_POINTS);
        let points: Vec<(f64, f64)> = chosen.into_iter().map(|i| trace.points[i]).collect();
        let width = match trace.mark {
            Mark::Broad => trace.colour.mix(0.45).stroke_width(6 * FINE),
            _ => trace.colour.stroke_width(2 * FINE),
        };
        if trace.mark != Mark::Points {
            chart.draw_series(LineSeries::new(points.iter().copied(), width))?;
        }
        if matches!(trace.mark, Mark::Points | Mark::Both) {
            let dot = |&at: &(f64, f64)| Circle::new(at, 4 * FINE, trace.colour.filled());
            chart.draw_series(points.iter().map(dot))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_panel_every_line_and_every_point_is_drawn() {
        let trace = |mark| Trace {
            points: vec![(0.0, 0.0), (1.0, 2.0), (2.0, 1.0)],
            colour: BLUE,
            mark,
        };
        let panel = |title: &str| Panel {
            title: title.into(),
            labels: ("x of it", "y of it"),
            traces: vec![trace(Mark::Line), trace(Mark::Both)],
            logarithmic: false,
        };
        let svg = panels(&[panel("one"), panel("two"), panel("three"), panel("four")]);
        for text in ["one", "four", "x of it", "y of it"] {
            assert!(svg.contains(text), "{text}");
        }
        assert_eq!(svg.matches("<circle").count(), 4 * 3);
        assert!(svg.contains("width=\"1140\" height=\"600\""));
        let tenth = Panel {
            traces: vec![Trace {
                points: vec![(0.0, -1.0), (1.0, 1.0)],
                ..trace(Mark::Line)
            }],
            logarithmic: true,
            ..panel("")
        };
        assert!(panels(&[tenth]).contains("0.100"));
    }
}
