//! The pictures, as SVG: force–displacement loops, and residuals over time.

use std::ops::Range;

use mesh_damper_recording::extremes::least_and_largest;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Series;
use super::text;

/// Colours that remain distinct to the colour-blind (Okabe and Ito 2008), on white.
pub const MEASURED: RGBColor = RGBColor(90, 90, 90);
/// The law alone.
pub const BEFORE: RGBColor = RGBColor(213, 94, 0);
/// The law with what was found.
pub const AFTER: RGBColor = RGBColor(0, 114, 178);
pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
const GRID: RGBColor = RGBColor(228, 228, 228);
pub(super) const FONT: &str = "Helvetica, Arial, sans-serif";

/// Units of the drawing in a pixel of the page: the library rounds to whole units, which would show as steps in a
/// curve.
pub(super) const FINE: u32 = 4;

/// Most points of one curve.
pub(super) const CURVE_POINTS: usize = 400;
/// Columns into which a long time is gathered, each with its least and largest value.
const TIME_COLUMNS: usize = 900;

/// How large a chart is and what it shows beside its curves, px.
pub struct Style {
    pub(super) size: (u32, u32),
    pub(super) font: u32,
    legend: bool,
}

/// One of many.
pub const SMALL: Style = Style {
    size: (380, 300),
    font: 15,
    legend: false,
};
/// A file of its own.
pub const STANDALONE: Style = Style {
    size: (720, 520),
    font: 17,
    legend: true,
};
/// Half of the page's width.
pub const HALF: Style = Style {
    size: (570, 330),
    font: 13,
    legend: false,
};
/// A row to each of many, high enough for `rows`.
pub(super) const fn tall(rows: usize) -> Style {
    /// Of what stands beside the rows, and of each, px.
    const BESIDE: u32 = 126;
    const ROW: u32 = 23;
    let height = BESIDE + ROW * rows as u32;
    Style {
        size: (900, if height > 1000 { height } else { 1000 }),
        font: 14,
        legend: false,
    }
}
/// The page's whole width.
pub const WIDE: Style = Style {
    size: (1150, 300),
    font: 13,
    legend: false,
};

/// Six panels, each like [`SMALL`].
pub const PANELS: Style = Style {
    size: (1140, 640),
    font: 15,
    legend: false,
};

impl Style {
    /// Of this size in px, with letters as in [`SMALL`].
    pub fn of_size(width: u32, height: u32) -> Self {
        Self {
            size: (width, height),
            ..SMALL
        }
    }

    /// Size of the letters, px.
    pub fn font(&self) -> u32 {
        self.font
    }
}

/// Force over displacement for the samples of one cycle: measured, before, after.
pub fn loop_chart(series: &Series, cycle: &Range<usize>, style: &Style) -> String {
    let samples = thinned(cycle.clone(), CURVE_POINTS);
    let points = |force: &[f64]| -> Vec<(f64, f64)> {
        let point = |&i: &usize| Some((*series.displacement.get(i)?, *force.get(i)?));
        samples.iter().filter_map(point).collect()
    };
    let (measured, before, after) = (
        points(&series.force),
        points(&series.before),
        points(&series.after),
    );
    let all = || measured.iter().chain(&before).chain(&after);
    let x = padded(all().map(|point| point.0));
    let y = padded(all().map(|point| point.1));
    draw(style, |area| {
        let mut chart = axes(area, style, (x, y), ("displacement, mm", "force, kN"))?;
        let wide = FINE * if style.legend { 7 } else { 6 };
        chart.draw_series(LineSeries::new(
            measured,
            MEASURED.mix(0.45).stroke_width(wide),
        ))?;
        chart.draw_series(LineSeries::new(before, BEFORE.stroke_width(2 * FINE)))?;
        chart.draw_series(LineSeries::new(after, AFTER.stroke_width(2 * FINE)))?;
        if style.legend {
            legend(&chart.plotting_area().strip_coord_spec(), style.font)?;
        }
        Ok(())
    })
}

/// The force's error before and after over time, recordings one after another.
pub fn residual_chart(series: &[Series], style: &Style) -> String {
    let residuals = |force: fn(&Series) -> &[f64]| -> Vec<(f64, f64)> {
        let mut offset = 0.0;
        let mut points = Vec::new();
        for one in series {
            let start = one.time.first().copied().unwrap_or_default();
            let measured = |&i: &usize| one.measured.get(i).copied().unwrap_or(true);
            let point = |i: usize| {
                let time = one.time.get(i)? - start + offset;
                Some((time, one.force.get(i)? - force(one).get(i)?))
            };
            points.extend((0..one.time.len()).filter(measured).filter_map(point));
            offset += one.time.last().map_or(0.0, |end| end - start);
        }
        points
    };
    let before = residuals(|one| &one.before);
    let after = residuals(|one| &one.after);
    let x = padded(before.iter().map(|point| point.0));
    let y = padded(before.iter().chain(&after).map(|point| point.1));
    let label = if series.len() > 1 {
        "time, s (recordings one after another)"
    } else {
        "time, s"
    };
    draw(style, |area| {
        let mut chart = axes(area, style, (x, y), (label, "measured − law, kN"))?;
        for (points, colour) in [(before, BEFORE), (after, AFTER)] {
            let columns = envelope(&points, TIME_COLUMNS);
            chart.draw_series(LineSeries::new(columns, colour.stroke_width(FINE)))?;
        }
        Ok(())
    })
}

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Drawn = Result<(), Box<dyn std::error::Error>>;
pub(super) type Cartesian =
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>;

/// The SVG that `paint` draws on white. Drawing into memory does not fail; were it to, the picture is empty.
pub(super) fn draw(style: &Style, paint: impl FnOnce(&Area<'_>) -> Drawn) -> String {
    let (width, height) = style.size;
    let fine = (FINE * width, FINE * height);
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, fine).into_drawing_area();
        let painted = area
            .fill(&WHITE)
            .map_err(Into::into)
            .and_then(|()| paint(&area));
        if painted
            .and_then(|()| area.present().map_err(Into::into))
            .is_err()
        {
            return String::new();
        }
    }
    let size = |(width, height)| format!("width=\"{width}\" height=\"{height}\" viewBox");
    svg.replacen(&size(fine), &size(style.size), 1)
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian>;

/// A chart with its grid, ticks and labels.
pub(super) fn axes<'a, 'b>(
    area: &'a Area<'b>,
    style: &Style,
    (x, y): (Range<f64>, Range<f64>),
    labels: (&str, &str),
) -> Result<Chart<'a, 'b>, Box<dyn std::error::Error>> {
    let written = (|value: f64| tick(value, &x), |value: f64| tick(value, &y));
    axes_labelled(
        area,
        style,
        (x.clone(), y.clone()),
        labels,
        (&written.0, &written.1),
    )
}

/// The same with ticks that are written so.
pub(super) fn axes_labelled<'a, 'b>(
    area: &'a Area<'b>,
    style: &Style,
    (x, y): (Range<f64>, Range<f64>),
    (x_label, y_label): (&str, &str),
    (x_tick, y_tick): (&dyn Fn(f64) -> String, &dyn Fn(f64) -> String),
) -> Result<Chart<'a, 'b>, Box<dyn std::error::Error>> {
    let font = FINE * style.font;
    let mut chart = ChartBuilder::on(area)
        .margin(font / 2)
        .margin_right(font)
        .x_label_area_size(3 * font)
        .y_label_area_size(5 * font)
        .build_cartesian_2d(x, y)?;
    let text = (FONT, font).into_font().color(&INK);
    chart
        .configure_mesh()
        .x_desc(x_label)
        .y_desc(y_label)
        .x_labels((style.size.0 / (5 * style.font)) as usize)
        .y_labels((style.size.1 / (3 * style.font)) as usize)
        .x_label_formatter(&|value| x_tick(*value))
        .y_label_formatter(&|value| y_tick(*value))
        .max_light_lines(0)
        .set_all_tick_mark_size(5 * FINE)
        .bold_line_style(GRID.stroke_width(FINE))
        .axis_style(INK.mix(0.6).stroke_width(FINE))
        .label_style(text.clone())
        .axis_desc_style(text)
        .draw()?;
    Ok(chart)
}

/// Names beside their colours in the upper left corner, where a loop leaves room.
fn legend(area: &Area<'_>, font: u32) -> Drawn {
    let font = (FINE * font) as i32;
    let entries = [
        (MEASURED.mix(0.45), 7, "measured"),
        (BEFORE.mix(1.0), 2, "law before"),
        (AFTER.mix(1.0), 2, "law after"),
    ];
    for (row, (colour, width, name)) in (0..).zip(entries) {
        let y = font + row * (font * 3 / 2);
        let line = vec![(font, y), (font * 3, y)];
        area.draw(&PathElement::new(line, colour.stroke_width(FINE * width)))?;
        let text = (FONT, font).into_font().color(&INK);
        let place = Pos::new(HPos::Left, VPos::Center);
        area.draw(&Text::new(name, (font * 7 / 2, y), text.pos(place)))?;
    }
    Ok(())
}

/// A tick's label with as many decimals as `range` asks for.
pub(super) fn tick(value: f64, range: &Range<f64>) -> String {
    let span = range.end - range.start;
    if span.abs() < 1e-4 || span.abs() > 1e6 {
        return if value.abs() < 1e-9 * span.abs() {
            "0".into()
        } else {
            text::number(value)
        };
    }
    // Ticks are about a tenth of the range apart.
    let decimals = (1.0 - span.log10().floor()).max(0.0) as usize;
    let label = format!("{value:.decimals$}");
    let trimmed = if label.contains('.') {
        label.trim_end_matches('0').trim_end_matches('.')
    } else {
        &label
    };
    match trimmed {
        "-0" => "0".into(),
        other => other.replace('-', "−"),
    }
}

/// The range of `values` with room about it; never empty.
pub(super) fn padded(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = least_and_largest(values.filter(|value| value.is_finite()));
    if low > high {
        return -1.0..1.0;
    }
    let room = (0.06 * (high - low)).max(1e-9 + 1e-6 * high.abs());
    low - room..high + room
}

/// At most `most` of the samples, evenly spread, the last one among them.
pub(super) fn thinned(samples: Range<usize>, most: usize) -> Vec<usize> {
    let (start, count) = (samples.start, samples.len());
    if count <= most {
        return samples.collect();
    }
    (0..most)
        .map(|i| start + i * (count - 1) / (most - 1))
        .collect()
}

/// Points in order of x, gathered into columns of which the least and the largest value remain.
fn envelope(points: &[(f64, f64)], columns: usize) -> Vec<(f64, f64)> {
    let size = points.len().div_ceil(columns).max(1);
    if size <= 2 {
        return points.to_vec();
    }
    points
        .chunks(size)
        .flat_map(|column| {
            let least = column.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1));
            let largest = column.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
            let mut ends: Vec<(f64, f64)> = least.into_iter().chain(largest).collect();
            ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            ends
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_ends_and_the_peaks() {
        assert_eq!(thinned(5..8, 10), [5, 6, 7]);
        let chosen = thinned(10..100_010, 400);
        assert_eq!((chosen.len(), chosen[0], chosen[399]), (400, 10, 100_009));
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|i| (f64::from(i), 0.0)).collect();
        points[4321].1 = 7.0;
        points[8000].1 = -7.0;
        let thin = envelope(&points, 100);
        assert_eq!(thin.len(), 200);
        assert!(thin.contains(&points[4321]) && thin.contains(&points[8000]));
    }

    #[test]
    fn ticks_are_as_fine_as_the_range() {
        assert_eq!(tick(-0.15, &(-0.2..0.2)), "−0.15");
        assert_eq!(tick(20.0, &(0.0..100.0)), "20");
        assert_eq!(tick(-0.0, &(-1.0..1.0)), "0");
        assert_eq!(tick(0.002, &(0.0..0.01)), "0.002");
    }

    #[test]
    fn a_range_is_never_empty() {
        for values in [vec![], vec![1.0], vec![f64::NAN, 3.0, 3.0]] {
            let range = padded(values.into_iter());
            assert!(range.end > range.start);
        }
    }
}
