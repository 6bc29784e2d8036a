//! Charts of several curves with points, side by side, for the figures of the paper.

use super::palette::Colour;
use super::picture::{Axis, CURVE_POINTS, Dash, Layer, Look, Mark, Panel, Picture, SMALL, thinned};

/// The look of the methods that the paper compares: colour, dashes and marks of each.
pub const TABLES: Style = Style(Colour::Measured, Dash::Solid, Mark::Disc);
/// Of eq 20.
pub const EQUATION: Style = Style(Colour::Before, Dash::Long, Mark::Square);
/// Of the crate's surfaces.
pub const SURFACES: Style = Style(Colour::After, Dash::Solid, Mark::Diamond);
/// Of finite elements.
pub const ELEMENTS: Style = Style(Colour::Green, Dash::Mixed, Mark::Triangle);
/// Statements of the text.
pub const SAID: Style = Style(Colour::Pink, Dash::Short, Mark::Ring);
/// One for each of the five densities or amplitudes.
pub const SHADES: [Style; 5] = [
    Style(Colour::Yellow, Dash::Solid, Mark::Disc),
    Style(Colour::Sky, Dash::Long, Mark::Square),
    Style(Colour::Green, Dash::Mixed, Mark::Triangle),
    Style(Colour::Before, Dash::Short, Mark::Diamond),
    Style(Colour::Ink, Dash::Dotted, Mark::Ring),
];

/// A colour with the dashes and the mark that also distinguish a curve.
#[derive(Clone, Copy, Debug)]
pub struct Style(Colour, Dash, Mark);

impl Style {
    /// A line.
    pub fn line(self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Layer {
        self.layer(name, Look::Line(self.1), &points)
    }

    /// Points alone.
    pub fn points(self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Layer {
        self.layer(name, Look::Marks(self.2), &points)
    }

    /// Points joined by a line.
    pub fn both(self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Layer {
        self.layer(name, Look::Both(self.2, self.1), &points)
    }

    /// A broad pale line beneath the others.
    pub fn broad(self, name: impl Into<String>, points: Vec<(f64, f64)>) -> Layer {
        self.layer(name, Look::Broad, &points)
    }

    fn layer(self, name: impl Into<String>, look: Look, points: &[(f64, f64)]) -> Layer {
        let chosen = thinned(0..points.len(), CURVE_POINTS);
        let points = chosen.into_iter().map(|i| points[i]).collect();
        Layer::new(name, self.0, look, points)
    }
}

/// A panel of curves.
pub fn panel(title: impl Into<String>, x: Axis, y: Axis, layers: Vec<Layer>) -> Panel {
    Panel {
        title: title.into(),
        x,
        y,
        layers,
    }
}

/// Each panel as a picture, which takes a separate row if the page is narrow. The panel's title is its caption.
pub fn panels(title: &str, all: Vec<Panel>) -> Vec<(String, Picture)> {
    let one = |mut panel: Panel| {
        let caption = match std::mem::take(&mut panel.title) {
            own if own.is_empty() => panel.y.name.clone(),
            own => own,
        };
        let picture = Picture::of(format!("{title}: {caption}"), SMALL, panel);
        (caption, picture)
    };
    all.into_iter().map(one).collect()
}
