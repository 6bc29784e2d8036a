//! The description matches the library.

use mesh_damper_fmu::functions::*;
use mesh_damper_fmu::variables::{Kind, variables};
use roxmltree::{Document, Node};

use crate::master::{MODEL_WITH_HISTORY, Unpacked};

fn awkward_model() -> String {
    MODEL_WITH_HISTORY
        .replace(
            r#""effects": ["#,
            r#""effects": [ { "family": "temperature", "parameters": { "beta": 0.005, "reference": 20.0 } },
              { "family": "drift", "parameters": { "cycles": 3.0, "elastic_change": 0.2 } },
              { "family": "control_input", "parameters": { "stiffness": 2.0, "yield_stretch": 0.04, "rate": 0.3 } },"#,
        )
        .replace(
            r#""fitted_range""#,
            r#""controls": [ { "name": "a<\"&ä>_A", "range": [0.0, 1.0] }, { "name": "tension_N/x", "range": [0.0, 1.0] } ], "fitted_range""#,
        )
}

#[test]
fn it_is_well_formed_and_its_variables_are_those_of_the_library() {
    for (json, inputs) in [(MODEL_WITH_HISTORY.to_owned(), 3), (awkward_model(), 7)] {
        let unpacked = Unpacked::new(&json, 1e4);
        let document = Document::parse(&unpacked.description).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("fmiVersion"), Some("2.0"));
        assert_eq!(
            root.attribute("guid"),
            Some(unpacked.contents.guid.as_str())
        );
        let all = |tag: &'static str| {
            document
                .descendants()
                .filter(move |it| it.has_tag_name(tag))
        };
        let units: Vec<&str> = all("Unit")
            .map(|unit| unit.attribute("name").unwrap())
            .collect();
        let master = unpacked.instance();
        master.set_up(0.0);
        let scalars: Vec<Node<'_, '_>> = all("ScalarVariable").collect();
        let known = variables(&unpacked.contents).unwrap();
        assert_eq!(scalars.len(), known.len());
        let mut seen = 0;
        for (scalar, variable) in scalars.iter().zip(&known) {
            assert_eq!(scalar.attribute("name"), Some(variable.name.as_str()));
            let reference: u32 = scalar.attribute("valueReference").unwrap().parse().unwrap();
            assert_eq!(reference, variable.reference);
            let kind = scalar.first_element_child().unwrap();
            if let Some(unit) = kind.attribute("unit") {
                assert!(units.contains(&unit), "{unit}");
            }
            match variable.kind {
                Kind::Text(_) | Kind::BooleanOutput => {}
                Kind::Output => {
                    assert!(kind.has_tag_name("Real"));
                    master.get(reference);
                }
                // The start value is the stated one.
                Kind::Input(_) | Kind::Parameter(..) | Kind::Real(_) => {
                    let start: f64 = kind.attribute("start").unwrap().parse().unwrap();
                    assert_eq!(master.get(reference), start, "{}", variable.name);
                }
            }
            if scalar.attribute("causality") == Some("input") {
                seen += 1;
                master.well(master.set(&[reference], &[1e-4]));
                assert_eq!(master.get(reference), 1e-4);
            }
        }
        assert_eq!(seen, inputs);
        // Only the variables have references.
        for reference in 0..64 {
            let is_known = known.iter().any(|variable| variable.reference == reference);
            let answer = master.try_get(reference).0;
            let said = master.said();
            let is_unknown = said
                .iter()
                .any(|(_, said)| said.contains("no variable of this FMU"));
            assert_eq!(is_known, !is_unknown, "{reference}: {answer:?}");
        }
        for unknown in all("Unknown") {
            let index: usize = unknown.attribute("index").unwrap().parse().unwrap();
            assert_eq!(scalars[index - 1].attribute("causality"), Some("output"));
        }
        master.well(fmi2ExitInitializationMode(master.handle));
    }
}

#[test]
fn a_control_input_needs_a_name_of_its_own() {
    let json = awkward_model().replace("tension_N/x", "force");
    let unpacked = std::panic::catch_unwind(|| Unpacked::new(&json, 1e4));
    assert!(unpacked.is_err());
}
