//! A picture as SVG.
//!
//! The curves of a panel are in an inner `svg` with its own coordinates, which cuts them off at the axes: a change of its `viewBox`
//! zooms. `data-` attributes give the values at its edges. Nothing in the file needs a script.

use std::fmt::Write as _;
use std::ops::Range;

use super::curve::FINE;
use super::shapes::drawn;
use super::{Axis, Panel, Picture, legend};
use crate::palette::{self, Colour};

/// Width of a digit, in heights of the font.
const DIGIT: f64 = 0.57;
/// Approximate width of a letter.
pub const LETTER: f64 = 0.58;

/// The text written so far.
#[derive(Default)]
pub struct Sheet(pub String);

impl Sheet {
    pub fn into_text(self) -> String {
        self.0
    }

    pub fn put(&mut self, written: std::fmt::Arguments<'_>) {
        // Writing into a string does not fail.
        let _ = self.0.write_fmt(written);
    }

    /// A line of text at the height `y`, starting at, centred on or ending at `x`.
    pub fn text(&mut self, (x, y): (f64, f64), anchor: &str, text: &str) {
        self.put(format_args!(
            "<text x=\"{}\" y=\"{}\" dy=\".35em\" text-anchor=\"{anchor}\">{}</text>",
            short(x),
            short(y),
            escaped(text)
        ));
    }
}

/// The SVG of a picture.
pub fn svg(picture: &Picture, alone: bool) -> String {
    let (width, height) = picture.size;
    let (legend, above) = match alone {
        true => legend::above(picture),
        false => (String::new(), 0.0),
    };
    let all = f64::from(height) + above;
    let mut sheet = Sheet::default();
    let namespace = if alone {
        " xmlns=\"http://www.w3.org/2000/svg\""
    } else {
        ""
    };
    sheet.put(format_args!(
        "<svg{namespace} class=\"picture\" width=\"{width}\" height=\"{all}\" viewBox=\"0 0 {width} {all}\" role=\"img\" \
         font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{}\" fill=\"{}\"><title>{}</title><desc>{}</desc>",
        picture.font,
        Colour::Ink.light(),
        escaped(&picture.title),
        escaped(&picture.in_words())
    ));
    if alone {
        sheet.put(format_args!("<style>{}</style>", palette::rules()));
    }
    sheet.put(format_args!(
        "<rect width=\"{width}\" height=\"{all}\" fill=\"{}\"/>{legend}",
        Colour::Paper.light()
    ));
    let columns = picture.columns.max(1);
    let rows = picture.panels.len().div_ceil(columns).max(1);
    let size = (
        f64::from(width) / columns as f64,
        f64::from(height) / rows as f64,
    );
    for (index, one) in picture.panels.iter().enumerate() {
        let (row, column) = (index / columns, index % columns);
        let corner = (size.0 * column as f64, above + size.1 * row as f64);
        panel(&mut sheet, one, corner, size, f64::from(picture.font));
    }
    sheet.0.push_str("</svg>");
    sheet.0
}

/// The place of a panel's curves, px, and the range that it covers.
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: Range<f64>,
    y: Range<f64>,
}

impl Frame {
    /// The position of a place of the axes within the frame, px.
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (
            (x - self.x.start) / (self.x.end - self.x.start) * self.width,
            (self.y.end - y) / (self.y.end - self.y.start) * self.height,
        )
    }
}

fn panel(sheet: &mut Sheet, panel: &Panel, corner: (f64, f64), size: (f64, f64), font: f64) {
    let points = || panel.layers.iter().flat_map(|layer| &layer.points);
    let (x, y) = (
        panel.x.ends(points().map(|point| point.0)),
        panel.y.ends(points().map(|point| point.1)),
    );
    let title = if panel.title.is_empty() { 0.6 } else { 1.9 };
    let (top, height) = (corner.1 + title * font, size.1 - (title + 3.2) * font);
    let y_ticks = panel.y.ticks(&y, (height / (2.6 * font)) as usize);
    let longest = y_ticks.iter().map(|(_, label)| label.chars().count()).max();
    let beside = font * (2.4 + DIGIT * longest.unwrap_or(0) as f64);
    let frame = Frame {
        left: corner.0 + beside,
        top,
        width: size.0 - beside - font,
        height,
        x,
        y,
    };
    // Labels are separated by half of their width.
    let most = |label: f64| (frame.width / (font * DIGIT * 1.6 * label)).max(2.0) as usize;
    let tried = panel.x.ticks(&frame.x, most(4.0));
    let longest = tried.iter().map(|(_, label)| label.chars().count()).max();
    let x_ticks = panel
        .x
        .ticks(&frame.x, most(longest.unwrap_or(4).max(4) as f64));
    sheet.put(format_args!(
        "<g class=\"panel\" data-at=\"{} {} {} {}\" data-x=\"{}\" data-y=\"{}\">",
        short(frame.left),
        short(frame.top),
        short(frame.width),
        short(frame.height),
        axis_data(&panel.x, &frame.x),
        axis_data(&panel.y, &frame.y)
    ));
    if !panel.title.is_empty() {
        // A long title begins further left, so that it ends within the panel.
        let long = LETTER * font * panel.title.chars().count() as f64;
        let left = frame
            .left
            .min(corner.0 + size.0 - long)
            .max(corner.0 + 0.3 * font);
        sheet.text((left, corner.1 + font), "start", &panel.title);
    }
    ticks(sheet, &frame, &x_ticks, &y_ticks, font);
    let middle = frame.left + 0.5 * frame.width;
    sheet.text(
        (middle, top + height + 2.5 * font),
        "middle",
        &panel.x.label(),
    );
    let (along, up) = (corner.0 + 0.9 * font, top + 0.5 * height);
    sheet.put(format_args!(
        "<text transform=\"translate({} {}) rotate(-90)\" dy=\".35em\" text-anchor=\"middle\">{}</text>",
        short(along),
        short(up),
        escaped(&panel.y.label())
    ));
    sheet.put(format_args!(
        "<svg class=\"curves\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\" preserveAspectRatio=\"none\">",
        short(frame.left),
        short(frame.top),
        short(frame.width),
        short(frame.height),
        (FINE * frame.width).round(),
        (FINE * frame.height).round()
    ));
    for layer in &panel.layers {
        let places = layer
            .points
            .iter()
            .map(|&(x, y)| frame.at(panel.x.scale.place(x), panel.y.scale.place(y)));
        drawn(sheet, layer, places.collect(), frame.at(0.0, 0.0).1);
    }
    sheet.put(format_args!(
        "</svg><rect class=\"edge\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{}\"/></g>",
        short(frame.left),
        short(frame.top),
        short(frame.width),
        short(frame.height),
        Colour::Faint.light()
    ));
}

/// Grid, ticks and their numbers: a zoom writes them again.
fn ticks(sheet: &mut Sheet, frame: &Frame, x: &[(f64, String)], y: &[(f64, String)], font: f64) {
    let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
    let mut grid = String::new();
    sheet.0.push_str("<g class=\"ticks\">");
    for (place, label) in x {
        let at = frame.left + frame.at(*place, 0.0).0;
        let _ = write!(
            grid,
            "M{} {}V{}",
            short(at),
            short(frame.top),
            short(bottom)
        );
        sheet.text((at, bottom + 0.9 * font), "middle", label);
    }
    for (place, label) in y {
        let at = frame.top + frame.at(0.0, *place).1;
        let _ = write!(
            grid,
            "M{} {}H{}",
            short(frame.left),
            short(at),
            short(right)
        );
        sheet.text((frame.left - 0.4 * font, at), "end", label);
    }
    sheet.put(format_args!(
        "<path d=\"{grid}\" stroke=\"{}\" fill=\"none\"/></g>",
        Colour::Grid.light()
    ));
}

/// `displacement|mm|lin|-0.2|0.2`: the last two are places; for a logarithmic axis they are logarithms.
fn axis_data(axis: &Axis, ends: &Range<f64>) -> String {
    let scale = match axis.labels {
        Some(_) => "names",
        None => axis.scale.name(),
    };
    format!(
        "{}|{}|{scale}|{}|{}",
        escaped(&axis.name),
        escaped(&axis.unit),
        digits(ends.start),
        digits(ends.end)
    )
}

/// A number of px, to a hundredth.
pub fn short(value: f64) -> String {
    let rounded = (100.0 * value).round() / 100.0;
    // Without the sign of −0.
    (rounded + 0.0).to_string()
}

/// A number with as many digits as can be read off a picture.
pub fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.7e}").parse().unwrap_or(value);
    rounded.to_string()
}

pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
