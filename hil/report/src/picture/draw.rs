//! A picture as SVG.
//!
//! The curves of a panel lie in an inner `svg` of its own coordinates, which cuts them off at the axes: who changes its `viewBox` zooms.
//! `data-` attributes say which values its edges are. Nothing in the file needs a script.

use std::fmt::Write as _;
use std::ops::Range;

use super::curve::{self, FINE};
use super::{Axis, Cells, Dash, Dot, Layer, Look, Mark, Panel, Picture, legend};
use crate::palette::{self, Colour};

/// Radius of a mark, px.
const MARK: f64 = 4.0;
/// Width of a letter of a number, in heights of the font.
const DIGIT: f64 = 0.57;

/// What is written so far.
#[derive(Default)]
pub struct Sheet(String);

impl Sheet {
    pub fn into_text(self) -> String {
        self.0
    }

    fn put(&mut self, written: std::fmt::Arguments<'_>) {
        // Writing into a string does not fail.
        let _ = self.0.write_fmt(written);
    }

    /// A line of text about the height `y`, from, about or up to `x`.
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

/// Where a panel's curves lie, px, and between which places.
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: Range<f64>,
    y: Range<f64>,
}

impl Frame {
    /// Where a place of the axes lies within the frame, px.
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
    // Labels stand apart by half of their width.
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
        sheet.text((frame.left, corner.1 + font), "start", &panel.title);
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

/// Grid, ticks and their numbers: what a zoom writes again.
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

/// `displacement|mm|lin|-0.2|0.2`: the last two are places, which a logarithmic axis has the logarithms of.
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

/// A layer at these places in px of the frame; `zero` is the height of 0.
fn drawn(sheet: &mut Sheet, layer: &Layer, places: Vec<(f64, f64)>, zero: f64) {
    let colour = layer.colour.light();
    sheet.put(format_args!("<g data-curve=\"{}\"", escaped(&layer.name)));
    if !layer.rows.is_empty() {
        sheet.put(format_args!(" data-rows=\"{}\"", layer.rows));
    }
    if layer.raised != 0.0 {
        sheet.put(format_args!(" data-raised=\"{}\"", digits(layer.raised)));
    }
    match &layer.look {
        Look::Line(_) | Look::Fine | Look::Broad | Look::Both(..) => {
            sheet.0.push('>');
            line(
                sheet,
                &layer.look,
                colour,
                &curve::path(places.iter().copied()),
            );
        }
        Look::Cloud(dot) => sheet.put(format_args!(
            "><path d=\"{}\" stroke=\"{colour}\" stroke-width=\"{}\" stroke-linecap=\"{}\"/>",
            curve::dots(places.iter().copied()),
            FINE * 5.0,
            match dot {
                Dot::Disc => "round",
                Dot::Square => "square",
            }
        )),
        Look::Stems => {
            let stems = places
                .iter()
                .flat_map(|&(x, y)| [(f64::NAN, 0.0), (x, zero), (x, y)]);
            sheet.put(format_args!(
                "><path class=\"stems\" d=\"{}\" stroke=\"{colour}\" stroke-width=\"{}\" fill=\"none\"/>",
                curve::path(stems),
                FINE * 2.0
            ));
        }
        Look::Band => {
            if let [a, b] = places[..] {
                sheet.put(format_args!(
                    " class=\"band\"><path d=\"{}z\" fill=\"{colour}\" fill-opacity=\".16\"/>",
                    curve::path([a, (b.0, a.1), b, (a.0, b.1)].into_iter())
                ));
            } else {
                sheet.0.push('>');
            }
        }
        Look::Cells(map) => cells(sheet, map, &places),
        Look::Marks(_) => sheet.0.push('>'),
    }
    if let Look::Marks(mark) | Look::Both(mark, _) = layer.look {
        for &(x, y) in places
            .iter()
            .filter(|(x, y)| x.is_finite() && y.is_finite())
        {
            marked(sheet, mark, colour, (x, y), FINE);
        }
    }
    sheet.0.push_str("</g>");
}

fn line(sheet: &mut Sheet, look: &Look, colour: &str, path: &str) {
    let (width, dash) = match look {
        Look::Broad => (6.0, Dash::Solid),
        Look::Fine => (1.0, Dash::Solid),
        Look::Line(dash) | Look::Both(_, dash) => (2.0, *dash),
        _ => (2.0, Dash::Solid),
    };
    let dashes: &[f64] = match dash {
        Dash::Solid => &[],
        Dash::Long => &[9.0, 4.0],
        Dash::Short => &[4.0, 3.0],
        Dash::Mixed => &[9.0, 3.0, 2.0, 3.0],
        Dash::Dotted => &[2.0, 3.0],
    };
    let dashes: Vec<String> = dashes
        .iter()
        .map(|length| (FINE * length).to_string())
        .collect();
    let dashed = match dashes.is_empty() {
        true => String::new(),
        false => format!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
    };
    sheet.put(format_args!(
        "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"{}\" stroke-linejoin=\"round\" fill=\"none\"{dashed}/>",
        FINE * width
    ));
}

/// A mark about a place in px, in units of 1/`fine` px.
fn marked(sheet: &mut Sheet, mark: Mark, colour: &str, (x, y): (f64, f64), fine: f64) {
    let (x, y) = ((fine * x).round(), (fine * y).round());
    let r = fine * MARK;
    let far = 1.25 * r;
    let (shape, is_full) = match mark {
        Mark::Disc => (format!("circle r=\"{r}\""), true),
        Mark::Ring => (format!("circle r=\"{r}\""), false),
        Mark::Square => (format!("path d=\"M-{r}-{r}H{r}V{r}H-{r}z\""), true),
        Mark::Diamond => (
            format!("path d=\"M0-{far}L{far},0 0,{far}-{far},0z\""),
            true,
        ),
        Mark::Triangle => (
            format!("polygon points=\"0,-{far} {far},{r} -{far},{r}\""),
            true,
        ),
        Mark::Cross => (
            format!("path d=\"M-{r}-{r}L{r},{r}M-{r},{r}L{r}-{r}\""),
            false,
        ),
    };
    let paint = match is_full {
        true => format!("fill=\"{colour}\""),
        false => format!(
            "fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"",
            fine * 1.6
        ),
    };
    sheet.put(format_args!(
        "<{shape} {paint} transform=\"translate({x} {y})\"/>"
    ));
}

/// The cells between two corners, those of one colour as one path.
fn cells(sheet: &mut Sheet, map: &Cells, places: &[(f64, f64)]) {
    let Cells {
        columns,
        scale,
        unit,
        ..
    } = *map;
    let values: Vec<f64> = map.values.iter().map(|value| value / scale).collect();
    let written = values.iter().map(|value| match value.is_finite() {
        true => format!("{}", (1000.0 * value).round()),
        false => String::new(),
    });
    sheet.put(format_args!(
        " data-columns=\"{columns}\" data-scale=\"{}\" data-unit=\"{unit}\" data-cells=\"{}\">",
        digits(scale),
        written.collect::<Vec<_>>().join(",")
    ));
    let (&[from, to], true) = (places, columns > 0) else {
        return;
    };
    let rows = values.len().div_ceil(columns).max(1);
    let mut by_colour = std::collections::BTreeMap::<String, String>::new();
    for (index, &value) in values
        .iter()
        .enumerate()
        .filter(|(_, value)| value.is_finite())
    {
        let edge = |start: f64, end: f64, place: usize, count: usize| {
            (FINE * (start + (end - start) * place as f64 / count as f64)).round()
        };
        let (row, column) = (index / columns, index % columns);
        let x = [column, column + 1].map(|place| edge(from.0, to.0, place, columns));
        let y = [row, row + 1].map(|place| edge(from.1, to.1, place, rows));
        let path = by_colour.entry(palette::shade(value, false)).or_default();
        let _ = write!(path, "M{},{}H{}V{}H{}z", x[0], y[0], x[1], y[1], x[0]);
    }
    for (colour, path) in by_colour {
        sheet.put(format_args!("<path fill=\"{colour}\" d=\"{path}\"/>"));
    }
}

/// A sample of a layer for a legend: so many px long, from `at` on.
pub fn piece(sheet: &mut Sheet, layer: &Layer, at: (f64, f64), length: f64) {
    let colour = layer.colour.light();
    let fine = 1.0 / FINE;
    let ends = [(0.0, 0.0), (length, 0.0)];
    sheet.put(format_args!(
        "<g transform=\"translate({} {})\">",
        short(at.0),
        short(at.1)
    ));
    let middle = (0.5 * length, 0.0);
    match &layer.look {
        Look::Line(_) | Look::Fine | Look::Broad | Look::Both(..) | Look::Stems => {
            sheet.put(format_args!("<g transform=\"scale({fine})\">"));
            line(sheet, &layer.look, colour, &curve::path(ends.into_iter()));
            sheet.0.push_str("</g>");
        }
        Look::Band => sheet.put(format_args!(
            "<rect y=\"-5\" width=\"{length}\" height=\"10\" fill=\"{colour}\" fill-opacity=\".16\"/>"
        )),
        Look::Cloud(Dot::Disc) => marked(sheet, Mark::Disc, colour, middle, 1.0),
        Look::Cloud(Dot::Square) => marked(sheet, Mark::Square, colour, middle, 1.0),
        Look::Marks(_) | Look::Cells(..) => {}
    }
    if let Look::Marks(mark) | Look::Both(mark, _) = layer.look {
        marked(sheet, mark, colour, middle, 1.0);
    }
    sheet.0.push_str("</g>");
}

/// A number of px, to a hundredth.
fn short(value: f64) -> String {
    let rounded = (100.0 * value).round() / 100.0;
    // Without the sign of −0.
    (rounded + 0.0).to_string()
}

/// A number with the digits that a reading of a picture can have.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.7e}").parse().unwrap_or(value);
    rounded.to_string()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
