//! Curves of several laws side by side, as one SVG of panels.

use super::charts;
use super::palette::Colour;
use super::picture::{CURVE_POINTS, Dash, Layer, Look, Panel as Drawn, Picture, SMALL, thinned};

/// One named curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its name in the legend.
    pub name: &'static str,
    /// In order.
    pub points: Vec<(f64, f64)>,
}

/// A panel: its title and its curves, the measured one first.
pub type Panel = (String, Vec<Curve>);

/// The measured curve is broad and pale, beneath the others.
const LOOKS: [(Colour, Look); 5] = [
    (Colour::Measured, Look::Broad),
    (Colour::Before, Look::Line(Dash::Long)),
    (Colour::Yellow, Look::Line(Dash::Short)),
    (Colour::Green, Look::Line(Dash::Mixed)),
    (Colour::After, Look::Line(Dash::Solid)),
];

/// Force over displacement, with panels in rows of three.
pub fn panels(title: &str, panels: &[Panel]) -> String {
    let panel = |(title, curves): &Panel| Drawn {
        title: title.clone(),
        x: charts::displacement(),
        y: charts::force(),
        layers: curves
            .iter()
            .zip(LOOKS)
            .map(|(curve, (colour, look))| {
                let chosen = thinned(0..curve.points.len(), CURVE_POINTS);
                // A loop is closed.
                let closed = chosen.iter().chain(chosen.first());
                let points = closed.map(|&i| curve.points[i]).collect();
                Layer::new(curve.name, colour, look, points)
            })
            .collect(),
    };
    Picture::of_panels(title, SMALL, 3, panels.iter().map(panel).collect()).alone()
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
        let svg = panels("Loops", &all);
        for text in ["2.0", "4.0", "measured", "law", "force, kN"] {
            assert!(svg.contains(text), "{text}");
        }
        // Two curves in two panels.
        assert_eq!(svg.matches("data-curve=").count(), 4);
        assert!(panels("None", &[]).starts_with("<svg"));
    }
}
