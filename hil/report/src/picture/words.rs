//! A picture in words: its contents, with the figures that a reader would take from it.

use super::{Axis, Layer, Look, Panel, Picture};
use crate::text;

/// More panels than this are described by their titles and the ranges of their axes.
const DETAILED: usize = 3;
/// A layer with at most this many points is described point by point.
const READ_OUT: usize = 8;

/// `Force over displacement. Measured: displacement −0.2 to 0.2 mm, force …`
pub fn of(picture: &Picture) -> String {
    let detailed = picture.panels.len() <= DETAILED;
    let panels = picture.panels.iter().map(|panel| {
        let title = match &panel.title[..] {
            "" => String::new(),
            title => format!("{title}: "),
        };
        let over = format!("{title}{} over {}. ", panel.y.name, panel.x.name);
        let layers = panel.layers.iter().filter(|layer| !layer.points.is_empty());
        let described: String = match detailed {
            true => layers.map(|layer| described(panel, layer)).collect(),
            false => {
                let all = || layers.clone().flat_map(|layer| &layer.points);
                format!(
                    "{}; {}. ",
                    span(&panel.x, all().map(|point| point.0)),
                    span(&panel.y, all().map(|point| point.1))
                )
            }
        };
        over + &described
    });
    let all: String = panels.collect();
    all.trim_end().to_owned()
}

fn described(panel: &Panel, layer: &Layer) -> String {
    let name = match &layer.name[..] {
        "" => String::new(),
        name => format!("{name}: "),
    };
    let (x, y) = (&panel.x, &panel.y);
    match &layer.look {
        Look::Cells(map) => {
            let filled = map.values.iter().filter(|value| value.is_finite()).count();
            let far = map
                .values
                .iter()
                .filter(|value| value.abs() > 0.5 * map.scale)
                .count();
            let half = text::number(0.5 * map.scale);
            format!(
                "{name}{filled} cells, {far} of them larger than ±{half} {}. ",
                map.unit
            )
        }
        Look::Band => {
            format!(
                "{name}a band, {}. ",
                span(y, layer.points.iter().map(|point| point.1))
            )
        }
        _ if layer.points.len() <= READ_OUT => {
            let points = layer
                .points
                .iter()
                .filter(|(x, y)| x.is_finite() && y.is_finite());
            let points: Vec<String> = points
                .map(|&(at, value)| format!("{} at {}", valued(y, value), valued(x, at)))
                .collect();
            format!("{name}{}. ", points.join("; "))
        }
        _ => format!(
            "{name}{}, {}. ",
            span(x, layer.points.iter().map(|point| point.0)),
            span(y, layer.points.iter().map(|point| point.1))
        ),
    }
}

/// `force −0.2 to 0.3 kN`
fn span(axis: &Axis, values: impl Iterator<Item = f64>) -> String {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return format!("{} without values", axis.name);
    }
    format!(
        "{} {} to {}",
        axis.name,
        text::number(low),
        valued(axis, high)
    )
}

fn valued(axis: &Axis, value: f64) -> String {
    match &axis.unit[..] {
        "" => text::number(value),
        unit => format!("{} {unit}", text::number(value)),
    }
}
