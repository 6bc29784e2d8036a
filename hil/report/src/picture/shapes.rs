//! Layers as SVG: lines, marks, dots, stems, bands and cells; and a sample of each for a legend.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::curve::{self, FINE};
use super::draw::{Sheet, digits, escaped, short};
use super::{Cells, Dash, Dot, Layer, Look, Mark};
use crate::palette;

/// Radius of a mark, px.
const MARK: f64 = 4.0;

/// A layer at these places in px of the frame; `zero` is the height of 0.
pub fn drawn(sheet: &mut Sheet, layer: &Layer, places: Vec<(f64, f64)>, zero: f64) {
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

/// A mark at a place in px, in units of 1/`fine` px.
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

/// The cells between two corners; those of one colour form one path.
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
    let mut by_colour = BTreeMap::<String, String>::new();
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

/// A sample of a layer for a legend, starting at `at`; its length is in px.
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
