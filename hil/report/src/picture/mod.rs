//! Pictures of curves: their contents, as SVG and in words.
//!
//! The code describes a picture and does not draw it: panels with axes, and layers of points over them. So all pictures have the
//! same grid and legend, a title and a description for readers who do not see them, colours for light and dark screens, and the
//! data that a script needs to zoom and to read values.

mod axis;
mod curve;
mod draw;
mod legend;
mod shapes;
mod words;

pub use axis::{Axis, Scale, padded};
pub use curve::{CURVE_POINTS, TIME_COLUMNS, envelope, thinned};
pub use legend::key;

use crate::palette::Colour;

/// A picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Its subject in a few words: its name for a screen reader.
    pub title: String,
    /// Width and height, px.
    pub size: (u32, u32),
    /// Size of the letters, px.
    pub font: u32,
    /// Panels side by side.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

/// One pair of axes with its layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Text above it; may be empty.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// In the order in which they are drawn.
    pub layers: Vec<Layer>,
}

/// Points that belong together. A point that is not finite interrupts a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Its name in the legend; layers with the same name are shown and hidden together. Empty if it needs no name.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// How it is drawn.
    pub look: Look,
    /// In order; x and y in the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// The rows of a table in the page that the points belong to, as a CSS selector; empty if there are none.
    pub rows: &'static str,
    /// Offset added to all y to separate layers that would cover each other; a reading of the picture subtracts it.
    pub raised: f64,
}

/// The look of a layer. No two layers of a panel differ by their colour alone.
#[derive(Clone, Debug, PartialEq)]
pub enum Look {
    /// A line.
    Line(Dash),
    /// A thin line, of many points.
    Fine,
    /// A broad line beneath the others, for measurements.
    Broad,
    /// Marks alone.
    Marks(Mark),
    /// Marks that a line joins.
    Both(Mark, Dash),
    /// Small discs, or small squares, for thousands of points.
    Cloud(Dot),
    /// Upright lines from 0.
    Stems,
    /// The area between the first point and the second, pale.
    Band,
    /// Equal cells between two opposite corners, which are the layer's points.
    Cells(Cells),
}

/// The shape of a point of a cloud.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dot {
    /// Round.
    Disc,
    /// Square.
    Square,
}

/// A map of equal cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Row by row from the lowest; NaN for an absent cell.
    pub values: Vec<f64>,
    /// Cells in a row.
    pub columns: usize,
    /// The value of a fully red cell; its negative is fully blue. > 0.
    pub scale: f64,
    /// Of the values.
    pub unit: &'static str,
}

/// The pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Long dashes.
    Long,
    /// Short dashes.
    Short,
    /// Dashes and dots.
    Mixed,
    /// Dots.
    Dotted,
}

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A full circle.
    Disc,
    /// An empty one.
    Ring,
    /// A full square.
    Square,
    /// A full square on its corner.
    Diamond,
    /// A full triangle.
    Triangle,
    /// Two strokes.
    Cross,
}

impl Picture {
    /// One panel.
    pub fn of(title: impl Into<String>, (size, font): Size, panel: Panel) -> Self {
        Self {
            title: title.into(),
            size,
            font,
            columns: 1,
            panels: vec![panel],
        }
    }

    /// Panels in rows, each of the size.
    pub fn of_panels(
        title: impl Into<String>,
        ((width, height), font): Size,
        columns: usize,
        panels: Vec<Panel>,
    ) -> Self {
        let columns = columns.clamp(1, panels.len().max(1));
        let rows = panels.len().div_ceil(columns).max(1);
        Self {
            title: title.into(),
            size: (width * columns as u32, height * rows as u32),
            font,
            columns,
            panels,
        }
    }

    /// The SVG within a page, whose style sheet has its dark colours, and which has a [`key`] next to it.
    pub fn within_page(&self) -> String {
        draw::svg(self, false)
    }

    /// The SVG as a separate file, with its legend and its dark colours.
    pub fn alone(&self) -> String {
        draw::svg(self, true)
    }

    /// The smallest width at which its letters can be read, px.
    pub fn least_width(&self) -> u32 {
        /// Height of the smallest letters, px.
        const LEAST: u32 = 9;
        self.size.0 * LEAST / self.font
    }

    /// Its contents, in words with figures.
    pub fn in_words(&self) -> String {
        words::of(self)
    }

    /// The names of its layers in order, each with its looks.
    fn named(&self) -> Vec<Vec<&Layer>> {
        let mut named: Vec<Vec<&Layer>> = Vec::new();
        for layer in self.panels.iter().flat_map(|panel| &panel.layers) {
            if layer.name.is_empty() {
                continue;
            }
            match named.iter_mut().find(|others| others[0].name == layer.name) {
                Some(others) if others.iter().any(|other| other.look == layer.look) => {}
                Some(others) => others.push(layer),
                None => named.push(vec![layer]),
            }
        }
        named
    }
}

impl Layer {
    /// A layer of these points.
    pub fn new(
        name: impl Into<String>,
        colour: Colour,
        look: Look,
        points: Vec<(f64, f64)>,
    ) -> Self {
        Self {
            name: name.into(),
            colour,
            look,
            points,
            rows: "",
            raised: 0.0,
        }
    }

    /// The same layer, with points that belong to rows of a table.
    pub fn of_rows(self, rows: &'static str) -> Self {
        Self { rows, ..self }
    }

    /// The same layer, raised by an offset.
    pub fn raised(self, raised: f64) -> Self {
        Self { raised, ..self }
    }
}

/// Width and height of a picture or a panel, and of its letters, px.
pub type Size = ((u32, u32), u32);

/// One of many in a row of three.
pub const SMALL: Size = ((380, 300), 15);
/// A separate file.
pub const STANDALONE: Size = ((720, 520), 17);
/// Half of the page's width.
pub const HALF: Size = ((570, 350), 15);
/// The page's whole width.
pub const WIDE: Size = ((1150, 320), 14);

#[cfg(test)]
mod script_tests;
#[cfg(test)]
mod tests;
