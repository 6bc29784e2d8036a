//! A sweep as one SVG: transmissibility and phase over frequency, with a curve for each amplitude of the base.

use mesh_damper_model::respond::SweepPoint;

use super::palette::Colour;
use super::picture::{Axis, Dash, Layer, Look, Panel, Picture};

/// One for each amplitude, in turn.
const LOOKS: [(Colour, Dash); 5] = [
    (Colour::After, Dash::Solid),
    (Colour::Before, Dash::Long),
    (Colour::Green, Dash::Mixed),
    (Colour::Pink, Dash::Short),
    (Colour::Yellow, Dash::Dotted),
];

/// The points of a sweep, amplitude by amplitude.
pub fn picture(points: &[SweepPoint]) -> String {
    let curves: Vec<&[SweepPoint]> = points
        .chunk_by(|a, b| a.base_amplitude == b.base_amplitude)
        .collect();
    let panel = |name: &str, unit: &str, value: fn(&SweepPoint) -> f64| Panel {
        title: String::new(),
        x: Axis::new("frequency", "Hz"),
        y: Axis::new(name, unit),
        layers: curves
            .iter()
            .zip(LOOKS.iter().cycle())
            .map(|(curve, &(colour, dash))| {
                let amplitude = curve.first().map_or(0.0, |point| point.base_amplitude);
                let points = curve.iter().map(|point| (point.frequency, value(point)));
                let name = format!("base ±{amplitude} mm");
                Layer::new(name, colour, Look::Line(dash), points.collect())
            })
            .collect(),
    };
    let panels = vec![
        panel("transmissibility", "dB", |point| {
            20.0 * point.transmissibility.log10()
        }),
        panel("phase", "degrees", |point| point.phase),
    ];
    let title = "Transmissibility and phase over frequency";
    Picture::of_panels(title, ((720, 380), 15), 1, panels).alone()
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
            ">base ±0.1 mm</text>",
            ">base ±0.5 mm</text>",
            "transmissibility, dB",
            "phase, degrees",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        // Two curves in two panels.
        assert_eq!(svg.matches("data-curve=").count(), 4);
        assert!(picture(&[]).starts_with("<svg"));
    }
}
