//! Pictures of a batch: errors over noise, and parameters by group.

use super::groups::{Group, estimates};
use super::{BatchRow, NOISE_LIMITED, outcomes};
use crate::charts::{AFTER, BEFORE};
use crate::palette::Colour;
use crate::picture::{Axis, Dash, Dot, HALF, Layer, Look, Panel, Picture, WIDE};
use crate::text;

/// Most pictures of parameters: those with the most traces.
const MOST_PARAMETERS: usize = 8;
/// Steps of a straight line.
const LINE: usize = 100;
/// Most groups with a separate line in such a picture.
const MOST_LINES: usize = 12;

/// Whether a trace can be drawn among the errors, whose axes are logarithmic.
pub fn is_drawn(noise: f64, before: f64, after: f64) -> bool {
    [noise, before, after]
        .iter()
        .all(|value| value.is_finite() && *value > 0.0)
}

/// Errors before and after over the noise, in %; `None` if there is nothing to draw.
pub fn errors(rows: &[BatchRow]) -> Option<Picture> {
    let drawn = outcomes(rows).filter(|one| is_drawn(one.noise, one.nrmse_before, one.nrmse_after));
    let noises = drawn.clone().map(|one| 100.0 * one.noise);
    let (low, high) = mesh_damper_recording::extremes::least_and_largest(noises);
    if low > high {
        return None;
    }
    let points = |error: fn(&super::BatchOutcome) -> f64| -> Vec<(f64, f64)> {
        let points = drawn.clone();
        points
            .map(|one| (100.0 * one.noise, 100.0 * error(one)))
            .collect()
    };
    let line = |name: String, factor: f64, dash| {
        // A reading refers to a point of the line.
        let noises =
            (0..=LINE).map(|i| 0.9 * low * (1.1 * high / (0.9 * low)).powf(i as f64 / LINE as f64));
        let points = noises.map(|noise| (noise, factor * noise)).collect();
        Layer::new(name, Colour::Ink, Look::Line(dash), points)
    };
    let cloud = |name, colour, dot, points| {
        Layer::new(name, colour, Look::Cloud(dot), points).of_rows("tr[data-drawn]")
    };
    let panel = Panel {
        title: String::new(),
        x: Axis::new("noise", "%").logarithmic(),
        y: Axis::new("error", "%").logarithmic(),
        layers: vec![
            cloud(
                BEFORE,
                Colour::Before,
                Dot::Square,
                points(|one| one.nrmse_before),
            ),
            cloud(
                AFTER,
                Colour::After,
                Dot::Disc,
                points(|one| one.nrmse_after),
            ),
            line("the noise".into(), 1.0, Dash::Solid),
            line(
                format!("{NOISE_LIMITED} times the noise"),
                NOISE_LIMITED,
                Dash::Long,
            ),
        ],
    };
    let size = ((WIDE.0.0, 440), WIDE.1);
    Some(Picture::of(
        "Errors before and after over the noise",
        size,
        panel,
    ))
}

/// The values of the parameters that most traces have, with a row of points for each group.
pub fn parameters(groups: &[Group<'_>]) -> Vec<Picture> {
    let all = estimates(groups);
    let count = |of_groups: &[Vec<_>]| of_groups.iter().map(Vec::len).sum::<usize>();
    let mut most: Vec<_> = all.iter().collect();
    most.sort_by_key(|(_, of_groups)| std::cmp::Reverse(count(of_groups)));
    let drawn = most.into_iter().take(MOST_PARAMETERS);
    drawn
        .map(|((family, name), of_groups)| {
            let mut lines: Vec<_> = groups.iter().zip(of_groups).collect();
            lines.retain(|(_, estimates)| !estimates.is_empty());
            lines.sort_by_key(|(_, estimates)| std::cmp::Reverse(estimates.len()));
            lines.truncate(MOST_LINES);
            lines.sort_by(|a, b| b.0.name.cmp(&a.0.name));
            let labels = lines.iter().enumerate();
            let labels = labels.map(|(place, (group, _))| (place as f64, shortened(&group.name)));
            let points = lines
                .iter()
                .enumerate()
                .flat_map(|(place, (_, estimates))| {
                    let values = estimates.iter().map(|one| one.value);
                    values.map(move |value| (value, place as f64))
                });
            let unit = lines
                .first()
                .map_or("", |(_, estimates)| &estimates[0].unit[..]);
            let name = name.replace('_', " ");
            let panel = Panel {
                title: String::new(),
                x: Axis::new(&name, text::unit(unit)),
                y: Axis {
                    labels: Some(labels.collect()),
                    ..Axis::new("", "").over(-0.7..lines.len() as f64 - 0.3)
                },
                layers: vec![Layer::new(
                    "",
                    Colour::After,
                    Look::Cloud(Dot::Disc),
                    points.collect(),
                )],
            };
            let height = 90 + 30 * lines.len() as u32;
            let title = format!("{}: {name}", text::name(family));
            Picture::of(title, ((HALF.0.0, height), HALF.1), panel)
        })
        .collect()
}

/// A label shortened to the space in a picture.
fn shortened(name: &str) -> String {
    const MOST: usize = 22;
    match name.chars().count() > MOST {
        true => name.chars().take(MOST - 1).chain(['…']).collect(),
        false => name.to_owned(),
    }
}
