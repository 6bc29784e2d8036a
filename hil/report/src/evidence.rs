//! The pictures of the residual: maps over displacement and velocity, spectra, and autocorrelation.

use super::Series;
use super::charts::{self, AFTER, BEFORE};
use super::palette::{self, Colour};
use super::picture::{Axis, Cells, Dash, HALF, Layer, Look, Panel, Picture, Scale, WIDE, padded};
use super::residual::{Autocorrelation, CELLS, Law, Map, spectrum};
use super::text;

use maud::{Markup, html};

/// Decades of a spectrum: the lines of an exactly silent channel would make the axis too long.
const DECADES: f64 = 7.0;

/// The residual over displacement and velocity, from −`scale` (blue) to `scale` (red) kN. It has the paper's colour where it is 0,
/// and is empty where the motion never was.
pub fn map_chart(map: &Map, scale: f64, title: &str) -> Picture {
    let (y, v) = (map.displacement, map.velocity);
    let values = map.cells.iter().map(|cell| cell.unwrap_or(f64::NAN));
    let cells = Cells {
        values: values.collect(),
        columns: CELLS,
        scale,
        unit: "kN",
    };
    let layer = Layer::new(
        "mean residual",
        Colour::Ink,
        Look::Cells(cells),
        vec![(-y, -v), (y, v)],
    );
    let panel = Panel {
        title: String::new(),
        x: charts::displacement().over(-y..y),
        y: Axis {
            scale: Scale::CubeRoot,
            ..Axis::new("velocity", "mm/s").over(-v..v)
        },
        layers: vec![layer],
    };
    Picture::of(title, HALF, panel)
}

/// The colours of a map with their values.
pub fn map_key(scale: f64) -> Markup {
    const STEPS: i32 = 10;
    let end = text::number(scale);
    html! {
        p.scale {
            "below the law " (text::number(-scale)) " kN "
            svg.picture width="210" height="12" viewBox="0 0 21 1" preserveAspectRatio="none" aria-hidden="true" focusable="false" {
                @for step in -STEPS..=STEPS {
                    rect x=(step + STEPS) width="1.05" height="1" fill=(palette::shade(f64::from(step) / f64::from(STEPS), false)) {}
                }
            }
            " " (end) " kN above"
        }
    }
}

/// Amplitude of the residual over frequency, on logarithmic axes: before, and with `with_after` also after.
pub fn spectrum_chart(series: &[Series], with_after: bool, title: &str) -> Picture {
    let before = spectrum(series, Law::Before);
    let after = if with_after {
        spectrum(series, Law::After)
    } else {
        Vec::new()
    };
    let all = before.iter().chain(&after);
    let ends = padded(all.map(|line| line.1.max(f64::MIN_POSITIVE).log10()));
    let range = 10_f64.powf(ends.start.max(ends.end - DECADES))..10_f64.powf(ends.end);
    let mut layers = vec![Layer::new(
        BEFORE,
        Colour::Before,
        Look::Line(Dash::Long),
        before,
    )];
    if with_after {
        let look = Look::Line(Dash::Solid);
        layers.push(Layer::new(AFTER, Colour::After, look, after));
    }
    let panel = Panel {
        title: String::new(),
        x: Axis::new("frequency", "Hz").logarithmic(),
        y: Axis::new("amplitude of the residual", "kN")
            .logarithmic()
            .over(range),
        layers,
    };
    Picture::of(title, HALF, panel)
}

/// The autocorrelation of the residual, with the band of white noise.
pub fn autocorrelation_chart(found: &Autocorrelation) -> Picture {
    let points: Vec<(f64, f64)> = (1..)
        .map(f64::from)
        .zip(found.values.iter().copied())
        .collect();
    let last = found.values.len() as f64 + 1.0;
    let ends = [-3.0 * found.white, 3.0 * found.white];
    let y = padded(points.iter().map(|p| p.1).chain(ends));
    let band = vec![(0.0, -found.white), (last, found.white)];
    let panel = Panel {
        title: String::new(),
        x: Axis::new("lag", "samples").over(0.0..last),
        y: Axis::new("autocorrelation", "").over(y),
        layers: vec![
            Layer::new("white noise", Colour::Ink, Look::Band, band),
            Layer::new("residual", Colour::After, Look::Stems, points),
        ],
    };
    Picture::of("Autocorrelation of the residual", WIDE, panel)
}
