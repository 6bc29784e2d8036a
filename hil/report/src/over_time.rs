//! Values with their intervals over time or another quantity, one panel each, as one SVG.

use super::palette::Colour;
use super::picture::{Axis, Dash, Layer, Look, Mark, Panel as Drawn, Picture, SMALL};

/// One value over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Text above the panel.
    pub title: String,
    /// Of its axis.
    pub name: String,
    /// Of its axis.
    pub unit: String,
    /// Whether the value changed: the title says so.
    pub changed: bool,
    /// The chance of such a difference if nothing changed, as text, if known.
    pub p: Option<String>,
    /// In the order of time.
    pub values: Vec<Value>,
}

/// A value at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// Time or another abscissa; in any unit that is the same for all.
    pub time: f64,
    /// In the panel's unit.
    pub value: f64,
    /// The ends of its interval, if known.
    pub interval: Option<(f64, f64)>,
}

/// Panels in rows of three, with the abscissa `over`.
pub fn picture(title: &str, over: &str, panels: &[Panel]) -> String {
    let panel = |panel: &Panel| {
        let colour = if panel.changed {
            Colour::Before
        } else {
            Colour::After
        };
        // A line for each interval, interrupted between them.
        let ends = panel
            .values
            .iter()
            .filter_map(|one| Some((one.time, one.interval?)));
        let ends =
            ends.flat_map(|(time, (low, high))| [(time, low), (time, high), (f64::NAN, f64::NAN)]);
        let values = panel.values.iter().map(|one| (one.time, one.value));
        let ends: Vec<_> = ends.collect();
        let intervals = Layer::new(
            "90 % interval",
            Colour::Measured,
            Look::Line(Dash::Solid),
            ends,
        );
        let values = Layer::new(
            "value",
            colour,
            Look::Both(Mark::Disc, Dash::Short),
            values.collect(),
        );
        let layers = [intervals, values].into_iter();
        Drawn {
            title: {
                let changed = panel.changed.then_some("changed").map(str::to_owned);
                let said: Vec<String> = changed.into_iter().chain(panel.p.clone()).collect();
                match said.is_empty() {
                    true => panel.title.clone(),
                    false => format!("{}: {}", panel.title, said.join(", ")),
                }
            },
            x: Axis::new(over, ""),
            y: Axis::new(panel.name.clone(), panel.unit.clone()),
            layers: layers.filter(|layer| !layer.points.is_empty()).collect(),
        }
    };
    Picture::of_panels(title, SMALL, 3, panels.iter().map(panel).collect()).alone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_and_what_changed_is_drawn() {
        let value = |time, value| Value {
            time,
            value,
            interval: Some((value - 0.1, value + 0.1)),
        };
        let panel = |title: &str, changed| Panel {
            title: title.into(),
            name: "k1".into(),
            unit: "kN/mm".into(),
            changed,
            p: (!changed).then(|| "p = 0.31".to_owned()),
            values: vec![value(0.0, 1.0), value(3.0, 2.0)],
        };
        let svg = picture(
            "all",
            "time",
            &[panel("law k1", true), panel("law c", false)],
        );
        assert!(
            svg.contains("law k1: changed") && svg.contains("law c: p = 0.31"),
            "{svg}"
        );
        assert!(
            !svg.contains("law c: changed") && !svg.contains("NaN"),
            "{svg}"
        );
    }
}
