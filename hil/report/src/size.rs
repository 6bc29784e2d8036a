//! What a trace takes over the number of rows, as one SVG: memory and processor time, both axes logarithmic.

use mesh_damper_studies::size::{Measured, Motion, mebibytes, memory_limit};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{self, AFTER, Area, BEFORE, Drawn, FINE, FONT, INK, MEASURED, Style};

/// Each motion's colour.
const COLOURS: [RGBColor; 2] = [AFTER, BEFORE];
/// Points of the line of the limit.
const POINTS: usize = 60;
/// Width and height, px.
const SIZE: (u32, u32) = (860, 380);

/// The picture of what was measured, and of the limit of the memory.
pub fn picture(all: &[Measured]) -> String {
    let style = Style::of_size(SIZE.0, SIZE.1);
    charts::draw(&style, |area| {
        let (left, right) = area.split_horizontally(FINE * SIZE.0 / 2);
        let decades = charts::padded(all.iter().map(|one| (one.rows as f64).log10()));
        let steps = (0..=POINTS).map(|step| step as f64 / POINTS as f64);
        let span = decades.end - decades.start;
        let limit = steps.map(|part| {
            let rows = 10_f64.powf(decades.start + part * span);
            (rows, mebibytes(memory_limit(rows as usize)))
        });
        let memory = |one: &Measured| mebibytes(one.memory);
        panel(&left, all, "memory, MiB", memory, limit.collect())?;
        panel(&right, all, "processor, s", |one| one.processor, Vec::new())
    })
}

fn panel(
    area: &Area<'_>,
    all: &[Measured],
    label: &str,
    value: impl Fn(&Measured) -> f64,
    limit: Vec<(f64, f64)>,
) -> Drawn {
    let logarithms = |(x, y): (f64, f64)| (x.log10(), y.log10());
    let limit: Vec<(f64, f64)> = limit.into_iter().map(logarithms).collect();
    let curve = |motion: Motion| -> Vec<(f64, f64)> {
        let of_motion = all.iter().filter(|one| one.motion == motion);
        let points = of_motion.map(|one| logarithms((one.rows as f64, value(one))));
        points.collect()
    };
    let curves = Motion::ALL.map(curve);
    let points = || curves.iter().flatten().chain(&limit);
    let x = charts::padded(points().map(|point| point.0));
    let y = charts::padded(points().map(|point| point.1));
    let style = Style::of_size(SIZE.0 / 2, SIZE.1);
    let rows = |x: f64| format!("{:.0e}", 10_f64.powf(x));
    let values = |y: f64| two_digits(10_f64.powf(y));
    let labels = ("rows", label);
    let mut chart = charts::axes_labelled(area, &style, (x, y), labels, (&rows, &values))?;
    let line = |colour: RGBColor| colour.stroke_width(2 * FINE);
    let mut entries = vec![];
    if !limit.is_empty() {
        chart.draw_series(LineSeries::new(limit, line(MEASURED)))?;
        entries.push((MEASURED, "limit: 400 bytes a row and 64 MiB"));
    }
    for ((motion, points), colour) in Motion::ALL.into_iter().zip(&curves).zip(COLOURS) {
        chart.draw_series(LineSeries::new(points.iter().copied(), line(colour)))?;
        let dot = |&at: &(f64, f64)| Circle::new(at, 4 * FINE, colour.filled());
        chart.draw_series(points.iter().map(dot))?;
        entries.push((colour, motion.in_words()));
    }
    legend(area, &entries)
}

/// A positive number with two digits that count.
fn two_digits(value: f64) -> String {
    let last = 10_f64.powf(value.log10().floor() - 1.0);
    let rounded = (value / last).round() * last;
    format!("{rounded:.*}", (-last.log10()).max(0.0).round() as usize)
}

/// Names beside their colours, in the upper left corner, where what grows leaves room.
fn legend(area: &Area<'_>, entries: &[(RGBColor, &str)]) -> Drawn {
    let font = (FINE * charts::SMALL.font()) as i32;
    for (row, (colour, name)) in (1..).zip(entries) {
        let (left, y) = (7 * font, 3 * font * row / 2);
        let line = vec![(left, y), (left + 2 * font, y)];
        area.draw(&PathElement::new(line, colour.stroke_width(2 * FINE)))?;
        let text = (FONT, font).into_font().color(&INK);
        let text = text.pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(*name, (left + 5 * font / 2, y), text))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_two_digits() {
        let written = [0.0316, 0.98, 9.96, 63.1, 631.0].map(two_digits);
        assert_eq!(written, ["0.032", "0.98", "10.0", "63", "630"]);
    }

    #[test]
    fn every_measurement_is_a_point_of_both_panels_beside_the_limit() {
        let measured = |motion, rows| Measured {
            motion,
            rows,
            duration: 10.0,
            processor: rows as f64 / 1e5,
            elapsed: 1.0,
            memory: 200 * rows as u64 + (20 << 20),
        };
        let all: Vec<Measured> = Motion::ALL
            .into_iter()
            .flat_map(|motion| [10_000, 100_000, 1_000_000].map(|rows| measured(motion, rows)))
            .collect();
        let svg = picture(&all);
        assert_eq!(svg.matches("<circle").count(), 2 * all.len());
        for said in ["limit", "blocks of sines", "random", "memory, MiB"] {
            assert!(svg.contains(said), "{said}");
        }
    }
}
