//! A hidden effect as text: `viscous:c=0.006`.

use mesh_damper_output::error::{InputError, quoted};
use mesh_damper_rig::specimen::HiddenEffect;
use serde_json::{Map, Value, json};

/// The option with which effects are given.
const OPTION: &str = "--effect";
const FORM: &str =
    "write family:name=value,name=value, as in stick_slip:stiffness=1.2,slip_limit=0.03";

/// Parses an effect. [`HiddenEffect`] describes its numbers.
///
/// A control input takes one of five levels from 0 to `most` A for `hold` s each, in an order by `seed`. Stick-slip is Bouc–Wen
/// with an `exponent`, Iwan with a number of `sliders`, and otherwise one Jenkins element.
///
/// # Errors
/// A family or a parameter that does not exist, a parameter that is missing, or a value that no specimen can have.
pub fn parse(text: &str) -> Result<HiddenEffect, InputError> {
    let refused = |problem: String| InputError::new(OPTION, problem, FORM);
    let (family, parameters) = text.split_once(':').unwrap_or((text, ""));
    let mut fields = Map::new();
    for parameter in parameters.split(',').filter(|part| !part.trim().is_empty()) {
        let (name, value) = parameter
            .split_once('=')
            .ok_or_else(|| refused(format!("{} is not name=value", quoted(parameter))))?;
        // A number or a truth value, otherwise a word.
        let value = value.trim();
        let value = serde_json::from_str(value).unwrap_or_else(|_| value.into());
        fields.insert(name.trim().to_owned(), value);
    }
    let family = family.trim();
    if family == "stick_slip" {
        let shape = if let Some(exponent) = fields.remove("exponent") {
            json!({ "smooth": { "exponent": exponent } })
        } else if let Some(sliders) = fields.remove("sliders") {
            json!({ "spread": { "sliders": sliders } })
        } else {
            json!("sharp")
        };
        fields.insert("shape".to_owned(), shape);
    }
    if family == "control_input" {
        let known = ["most", "hold", "seed"];
        let schedule: Map<String, Value> = known
            .iter()
            .filter_map(|&name| Some((name.to_owned(), fields.remove(name)?)))
            .collect();
        fields.insert("schedule".to_owned(), schedule.into());
    }
    fields.insert("family".to_owned(), family.into());
    let effect: HiddenEffect = serde_json::from_value(Value::Object(fields))
        .map_err(|error| refused(format!("{}: {error}", quoted(text))))?;
    if effect.is_admissible() {
        Ok(effect)
    } else {
        let remedy = match family {
            "unlisted" => "give finite values; a velocity, time, stretch, width and frequency above 0, an order between 0 and 1, and a damping of at least 0".to_owned(),
            _ => format!("see docs/effects/{family}.md for the ranges"),
        };
        let problem = format!("{}: a parameter is outside its range", quoted(text));
        Err(InputError::new(OPTION, problem, remedy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_damper_rig::specimen::{Schedule, SlipShape, Unlisted};

    #[test]
    fn an_effect_is_read_as_it_is_written() {
        let viscous = parse("viscous:c=0.006").unwrap();
        assert_eq!(viscous, HiddenEffect::Viscous { c: 0.006 });
        let friction = parse("stick_slip:stiffness=1.2, slip_limit=0.03, exponent=2").unwrap();
        let smooth = HiddenEffect::StickSlip {
            stiffness: 1.2,
            slip_limit: 0.03,
            shape: SlipShape::Smooth { exponent: 2.0 },
        };
        assert_eq!(friction, smooth);
        let loose = parse("gap:half_width=0.01,loose=true").unwrap();
        let gap = HiddenEffect::Gap {
            half_width: 0.01,
            loose: true,
        };
        assert_eq!(loose, gap);
        let text =
            "control_input:stiffness=1,force=0.03,rate=0.6,c=0.004,lag=0.05,most=1,hold=2,seed=3";
        let controlled = HiddenEffect::ControlInput {
            stiffness: 1.0,
            force: 0.03,
            rate: 0.6,
            c: 0.004,
            lag: 0.05,
            schedule: Schedule {
                most: 1.0,
                hold: 2.0,
                seed: 3,
            },
        };
        assert_eq!(parse(text).unwrap(), controlled);
        let drag = parse("unlisted:kind=quadratic_drag,c=0.001").unwrap();
        let expected = HiddenEffect::Unlisted(Unlisted::QuadraticDrag { c: 0.001 });
        assert_eq!(drag, expected);
    }

    #[test]
    fn what_cannot_be_is_refused_in_one_line() {
        for (text, told) in [
            ("viscose:c=1", "unknown variant `viscose`"),
            ("viscous", "missing field `c`"),
            ("viscous:c=1,d=2", "unknown field `d`"),
            ("viscous:c", "is not name=value"),
            ("viscous:c=much", "invalid type"),
            (
                "relaxation:stiffness=1,time=0",
                "a parameter is outside its range; see docs/effects/relaxation.md",
            ),
        ] {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(told), "{text}: {error}");
            assert_eq!(error.lines().count(), 1);
        }
    }
}
