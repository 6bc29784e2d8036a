//! The pictures of what is left: maps over displacement and velocity, spectra, and autocorrelation.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Series;
use super::charts::{
    AFTER, Area, BEFORE, Drawn, FINE, FONT, INK, Style, axes, axes_labelled, draw, padded, tick,
};
use super::residual::{Autocorrelation, CELLS, Law, Map, spectrum};
use super::text;

/// The force left over displacement and velocity, from −`scale` (blue) to `scale` (red) kN; white where it is none, and
/// nothing where the motion never was.
pub fn map_chart(map: &Map, scale: f64, style: &Style) -> String {
    let (y, v) = (map.displacement, map.velocity);
    let displacement = |value: f64| tick(value, &(-y..y));
    // The axis carries the cube root of the velocity over its largest, as the cells do.
    let velocity = |root: f64| text::nominal(v * (root * 10.0).round().powi(3) / 1000.0);
    draw(style, |area| {
        let (left, right) = area.split_horizontally(area.dim_in_pixel().0 * 17 / 20);
        let labels = ("displacement, mm", "velocity, mm/s, by its cube root");
        let mut chart = axes_labelled(
            &left,
            style,
            (-y..y, -1.0..1.0),
            labels,
            (&displacement, &velocity),
        )?;
        let step = 2.0 / CELLS as f64;
        let cells = map.cells.iter().enumerate().filter_map(|(index, cell)| {
            let (row, column) = ((index / CELLS) as f64, (index % CELLS) as f64);
            let corner = (y * (step * column - 1.0), step * row - 1.0);
            let opposite = (corner.0 + y * step, corner.1 + step);
            let colour = colour((*cell)? / scale);
            Some(Rectangle::new([corner, opposite], colour.filled()))
        });
        chart.draw_series(cells)?;
        scale_bar(&right, scale, style)
    })
}

/// The colours from −`scale` to `scale` with what they stand for.
fn scale_bar(area: &Area<'_>, scale: f64, style: &Style) -> Drawn {
    const STEPS: i32 = 40;
    let font = (FINE * style.font) as i32;
    let (top, bottom) = (2 * font, area.dim_in_pixel().1 as i32 - 4 * font);
    let (left, right) = (font / 2, font * 3 / 2);
    for step in 0..STEPS {
        let at = |step: i32| bottom - (bottom - top) * step / STEPS;
        let part = 2.0 * (f64::from(step) + 0.5) / f64::from(STEPS) - 1.0;
        let corners = [(left, at(step + 1)), (right, at(step))];
        area.draw(&Rectangle::new(corners, colour(part).filled()))?;
    }
    let font_style = (FONT, font as u32).into_font().color(&INK);
    let place = font_style.pos(Pos::new(HPos::Left, VPos::Center));
    for (part, y) in [(1.0, top), (0.0, (top + bottom) / 2), (-1.0, bottom)] {
        let label = text::number(part * scale);
        area.draw(&Text::new(label, (right + font / 3, y), place.clone()))?;
    }
    area.draw(&Text::new("kN", (left, top - font), place))?;
    Ok(())
}

/// White at 0, to blue below and red above (ColorBrewer's RdBu, which the colour-blind can read).
fn colour(part: f64) -> RGBColor {
    let part = part.clamp(-1.0, 1.0);
    let end = if part > 0.0 {
        [178.0, 24.0, 43.0]
    } else {
        [33.0, 102.0, 172.0]
    };
    let [red, green, blue] = end.map(|end| (247.0 + (end - 247.0) * part.abs()).round() as u8);
    RGBColor(red, green, blue)
}

/// Amplitude over frequency of what is left, on logarithmic axes: before, and `with_after` also after.
pub fn spectrum_chart(series: &[Series], with_after: bool, style: &Style) -> String {
    let logarithm = |(frequency, amplitude): (f64, f64)| {
        (frequency.log10(), amplitude.max(f64::MIN_POSITIVE).log10())
    };
    let lines =
        |law| -> Vec<(f64, f64)> { spectrum(series, law).into_iter().map(logarithm).collect() };
    let (before, after) = (lines(Law::Before), lines(Law::After));
    let all = || before.iter().chain(&after);
    let (x, y) = (padded(all().map(|p| p.0)), padded(all().map(|p| p.1)));
    // Lines of an exactly silent channel would stretch the axis beyond use.
    let y = y.start.max(y.end - 7.0)..y.end;
    let power = |value: f64| text::nominal(10f64.powf(value));
    draw(style, |area| {
        let labels = ("frequency, Hz", "amplitude left, kN");
        let mut chart = axes_labelled(area, style, (x, y), labels, (&power, &power))?;
        chart.draw_series(LineSeries::new(before.clone(), BEFORE.stroke_width(FINE)))?;
        if with_after {
            chart.draw_series(LineSeries::new(after.clone(), AFTER.stroke_width(2 * FINE)))?;
        }
        Ok(())
    })
}

/// The autocorrelation of what is left, with the band that white noise keeps to.
pub fn autocorrelation_chart(found: &Autocorrelation, style: &Style) -> String {
    let points: Vec<(f64, f64)> = (1..)
        .map(f64::from)
        .zip(found.values.iter().copied())
        .collect();
    let x = 0.0..found.values.len() as f64 + 1.0;
    let ends = [-3.0 * found.white, 3.0 * found.white];
    let y = padded(points.iter().map(|p| p.1).chain(ends));
    draw(style, |area| {
        let mut chart = axes(
            area,
            style,
            (x.clone(), y),
            ("lag, samples", "autocorrelation"),
        )?;
        let band = [(x.start, -found.white), (x.end, found.white)];
        chart.draw_series([Rectangle::new(band, INK.mix(0.12).filled())])?;
        let stems = points.iter().map(|&(lag, r)| {
            PathElement::new(vec![(lag, 0.0), (lag, r)], AFTER.stroke_width(2 * FINE))
        });
        chart.draw_series(stems)?;
        Ok(())
    })
}
