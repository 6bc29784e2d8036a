//! Curves of several laws side by side, as one SVG of panels.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{self, FINE, FONT, INK, MEASURED};

/// One named curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// As the legend has it.
    pub name: &'static str,
    /// In order.
    pub points: Vec<(f64, f64)>,
}

/// A panel: its title and its curves, the measured one first.
pub type Panel = (String, Vec<Curve>);

/// Colours that remain distinct to the colour-blind (Okabe and Ito 2008), the first for what was measured.
const COLOURS: [RGBColor; 5] = [
    MEASURED,
    RGBColor(213, 94, 0),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(0, 114, 178),
];

/// Up to five panels, and the legend in the place of the sixth.
pub fn panels(panels: &[Panel], labels: (&str, &str)) -> String {
    charts::draw(&charts::PANELS, |area| {
        let places = area.split_evenly((2, 3));
        for ((title, curves), place) in panels.iter().zip(&places) {
            let points = || curves.iter().flat_map(|curve| &curve.points);
            let x = charts::padded(points().map(|point| point.0));
            let y = charts::padded(points().map(|point| point.1));
            let mut chart = charts::axes(place, &charts::SMALL, (x, y), labels)?;
            for (index, (curve, colour)) in curves.iter().zip(COLOURS).enumerate() {
                let chosen = charts::thinned(0..curve.points.len(), charts::CURVE_POINTS);
                // A loop is closed.
                let closed = chosen
                    .iter()
                    .chain(chosen.first())
                    .map(|&i| curve.points[i]);
                chart.draw_series(LineSeries::new(closed, style_of(index, colour)))?;
            }
            let font = FINE * charts::SMALL.font();
            let text = (FONT, font).into_font().color(&INK);
            let text = text.pos(Pos::new(HPos::Left, VPos::Top));
            place.draw(&Text::new(
                title.clone(),
                (6 * font as i32, font as i32),
                text,
            ))?;
        }
        let (Some((_, curves)), Some(place)) = (panels.first(), places.last()) else {
            return Ok(());
        };
        let font = (FINE * charts::SMALL.font()) as i32;
        for (row, (curve, colour)) in (0..).zip(curves.iter().zip(COLOURS)) {
            let y = 2 * font * (row + 2);
            let line = vec![(3 * font, y), (6 * font, y)];
            place.draw(&PathElement::new(line, style_of(row as usize, colour)))?;
            let text = (FONT, font).into_font().color(&INK);
            let text = text.pos(Pos::new(HPos::Left, VPos::Center));
            place.draw(&Text::new(curve.name, (7 * font, y), text))?;
        }
        Ok(())
    })
}

/// What was measured lies broad and pale beneath the others.
fn style_of(index: usize, colour: RGBColor) -> ShapeStyle {
    match index {
        0 => colour.mix(0.45).stroke_width(6 * FINE),
        _ => colour.stroke_width(2 * FINE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_panel_and_every_name_is_drawn() {
        let curve = |name| Curve {
            name,
            points: vec![(0.0, 0.0), (1.0, 2.0), (-1.0, 1.0)],
        };
        let all: Vec<Panel> = ["2.0", "4.0"]
            .map(|title| (title.to_owned(), vec![curve("measured"), curve("law")]))
            .into();
        let svg = panels(&all, ("displacement, mm", "force, kN"));
        for text in ["2.0", "4.0", "measured", "law", "force, kN"] {
            assert!(svg.contains(text), "{text}");
        }
        // Two curves in two panels, and two lines of the legend.
        assert!(svg.matches("<polyline").count() >= 6);
        assert!(panels(&[], ("x", "y")).starts_with("<svg"));
    }
}
