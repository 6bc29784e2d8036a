//! A sweep as one SVG: transmissibility and phase over frequency, a curve for each amplitude of the base.

use mesh_damper_model::respond::SweepPoint;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::charts::{self, AFTER, Area, BEFORE, Drawn, FINE, FONT, INK, Style};

/// Colours that remain distinct to the colour-blind (Okabe and Ito 2008).
const COLOURS: [RGBColor; 5] = [
    AFTER,
    BEFORE,
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
];

/// The points of a sweep, amplitude by amplitude.
pub fn picture(points: &[SweepPoint]) -> String {
    let curves: Vec<&[SweepPoint]> = points
        .chunk_by(|a, b| a.base_amplitude == b.base_amplitude)
        .collect();
    let style = Style::of_size(720, 760);
    charts::draw(&style, |area| {
        let (upper, lower) = area.split_vertically(FINE * 480);
        let decibels = |point: &SweepPoint| 20.0 * point.transmissibility.log10();
        panel(&upper, (&style, "transmissibility, dB"), &curves, decibels)?;
        legend(&upper, &curves)?;
        let phase = |point: &SweepPoint| point.phase;
        panel(&lower, (&style, "phase, degrees"), &curves, phase)
    })
}

fn panel(
    area: &Area<'_>,
    (style, label): (&Style, &str),
    curves: &[&[SweepPoint]],
    value: impl Fn(&SweepPoint) -> f64,
) -> Drawn {
    let points = || curves.iter().flat_map(|curve| curve.iter());
    let x = charts::padded(points().map(|point| point.frequency));
    let y = charts::padded(points().map(&value));
    let mut chart = charts::axes(area, style, (x, y), ("frequency, Hz", label))?;
    for (curve, colour) in curves.iter().zip(COLOURS.iter().cycle()) {
        let points = curve.iter().map(|point| (point.frequency, value(point)));
        chart.draw_series(LineSeries::new(points, colour.stroke_width(2 * FINE)))?;
    }
    Ok(())
}

/// The amplitudes beside their colours, in the upper right corner: a mass that is isolated leaves room there.
fn legend(area: &Area<'_>, curves: &[&[SweepPoint]]) -> Drawn {
    let font = (FINE * charts::SMALL.font()) as i32;
    let left = area.dim_in_pixel().0 as i32 - 10 * font;
    for (row, (curve, colour)) in (1..).zip(curves.iter().zip(COLOURS.iter().cycle())) {
        let y = 3 * font * row / 2 + font;
        let line = vec![(left, y), (left + 2 * font, y)];
        area.draw(&PathElement::new(line, colour.stroke_width(2 * FINE)))?;
        let text = (FONT, font).into_font().color(&INK);
        let text = text.pos(Pos::new(HPos::Left, VPos::Center));
        let amplitude = curve.first().map_or(0.0, |point| point.base_amplitude);
        area.draw(&Text::new(
            format!("base ±{amplitude} mm"),
            (left + 5 * font / 2, y),
            text,
        ))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_amplitude_has_a_curve_in_both_panels_and_a_name() {
        let point = |base_amplitude, frequency| SweepPoint {
            frequency,
            base_amplitude,
            transmissibility: 10.0 / frequency,
            phase: -frequency,
            peak: 1.0,
            damper_amplitude: 0.1,
            damper_speed: 1.0,
            cycles: 8,
            steady: true,
            change: 0.0,
        };
        let points: Vec<SweepPoint> = [0.1, 0.5]
            .iter()
            .flat_map(|&a| [5.0, 10.0, 20.0].map(|f| point(a, f)))
            .collect();
        let svg = picture(&points);
        for text in [
            "base ±0.1 mm",
            "base ±0.5 mm",
            "transmissibility, dB",
            "phase, degrees",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        // Two curves in two panels, and two lines of the legend.
        assert!(svg.matches("<polyline").count() >= 6);
        assert!(picture(&[]).starts_with("<svg"));
    }
}
