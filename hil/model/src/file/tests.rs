//! A model file comes back as written, and a wrong one is refused by the name of its field.

use super::*;
use crate::Family;
use crate::correction::{MemoryAxis, Remembered};
use mesh_damper::effects::residual_table::CELLS;

fn correction() -> CorrectionTable {
    let cells = |count| {
        (0..count)
            .map(|cell| 100 * (cell as i16 % 300) - 15_000)
            .collect()
    };
    CorrectionTable {
        reach: 0.2,
        speed: 6.3,
        unit: 1e-6,
        cells: cells(CELLS),
        memory: Some(MemoryAxis {
            of: Remembered::Lag { time: 0.05 },
            range: [-0.1, 0.1],
        }),
    }
}

fn example() -> ModelFile {
    let node = |amplitude| LawNode {
        amplitude,
        k1: 1.2,
        k3: 30.0,
        c: 0.1,
        alpha: 0.3,
    };
    let effect = |family, parameters: &[(&str, f64)]| AddedEffect {
        family: Family::named(family).unwrap(),
        parameters: parameters
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect(),
    };
    ModelFile::new(
        Model {
            law: vec![node(0.05), node(0.1 + 0.2)],
            effects: vec![
                effect("offset", &[("force", -0.1)]),
                effect("asymmetry", &[("k2", 3.0)]),
                effect("hardening", &[("k5", 100.0)]),
                effect("viscous", &[("c1", 0.01)]),
                effect("inertia", &[("mass", 2.0)]),
                effect(
                    "stick_slip",
                    &[
                        ("stiffness", 1.2),
                        ("slip_limit", 0.03),
                        ("stiffness_2", 0.5),
                        ("slip_limit_2", 0.1),
                    ],
                ),
                effect(
                    "relaxation",
                    &[
                        ("stiffness", 0.4),
                        ("time", 0.05),
                        ("stiffness_2", 0.3),
                        ("time_2", 0.7),
                    ],
                ),
                effect("temperature", &[("beta", 0.004), ("reference", 20.0)]),
            ],
            correction: Some(correction()),
            controls: vec![Control {
                name: "current_A".into(),
                range: [0.0, 1.5],
            }],
        },
        FittedRange {
            displacement: [-0.2, 0.2],
            velocity: [-6.3, 6.3],
        },
    )
}

fn read_changed(change: impl FnOnce(&mut serde_json::Value)) -> String {
    let mut value = serde_json::to_value(example()).unwrap();
    change(&mut value);
    ModelFile::from_bytes("m.json", value.to_string().as_bytes())
        .unwrap_err()
        .to_string()
}

#[test]
fn comes_back_as_it_was() {
    let file = example();
    let bytes = serde_json::to_vec_pretty(&file).unwrap();
    assert_eq!(ModelFile::from_bytes("m.json", &bytes).unwrap(), file);
}

#[test]
fn a_zero_is_kept_and_changes_neither_older_files_nor_the_identity() {
    let file = example();
    assert!(!serde_json::to_string(&file).unwrap().contains("zero"));
    let moved = file.clone().with_displacement_zero([0.13, 0.14]);
    assert_eq!(moved.identity(), file.identity());
    let bytes = serde_json::to_vec(&moved).unwrap();
    let read = ModelFile::from_bytes("m.json", &bytes).unwrap();
    assert_eq!(read.displacement_zero(), [0.13, 0.14]);
    assert!(
        read_changed(|v| v["displacement_zero"] = serde_json::json!([1.0, 0.0]))
            .starts_with("m.json: field displacement_zero: 1 to 0 is not a finite range")
    );
}

#[test]
fn the_error_elsewhere_is_kept_and_changes_neither_older_files_nor_the_identity() {
    let file = example();
    assert!(!serde_json::to_string(&file).unwrap().contains("elsewhere"));
    let elsewhere = Elsewhere {
        conditions: 5,
        most: 0.1 + 0.2,
    };
    let known = file.clone().with_elsewhere(Some(elsewhere));
    assert_eq!(known.identity(), file.identity());
    let bytes = serde_json::to_vec(&known).unwrap();
    let read = ModelFile::from_bytes("m.json", &bytes).unwrap();
    assert_eq!(read.elsewhere(), Some(elsewhere));
    let refused =
        read_changed(|v| v["elsewhere"] = serde_json::json!({"conditions": 1, "most": -0.1}));
    assert!(
        refused.starts_with("m.json: field elsewhere.most: -0.1 is no fraction of a force"),
        "{refused}"
    );
}

#[test]
fn refuses_naming_the_field() {
    for (said, error) in [
        (
            "m.json: field version: version 2 is not supported",
            read_changed(|v| v["version"] = 2.into()),
        ),
        (
            "m.json: field version: the version is missing",
            read_changed(|v| drop(v.as_object_mut().unwrap().remove("version"))),
        ),
        (
            "m.json: field format: missing",
            read_changed(|v| drop(v.as_object_mut().unwrap().remove("format"))),
        ),
        (
            "m.json: field effects[1].family: unknown variant `magic`",
            read_changed(|v| v["effects"][1]["family"] = "magic".into()),
        ),
        (
            "m.json: field law[1].alpha: alpha = 1.5 is outside 0…1",
            read_changed(|v| v["law"][1]["alpha"] = 1.5.into()),
        ),
        (
            "m.json: field law[0].c: c = -1 is outside",
            read_changed(|v| v["law"][0]["c"] = (-1.0).into()),
        ),
        (
            "m.json: field law: amplitudes must increase",
            read_changed(|v| v["law"][1]["amplitude"] = 0.0.into()),
        ),
        (
            "m.json: field law: there is no node",
            read_changed(|v| v["law"] = serde_json::json!([])),
        ),
        (
            "m.json: field effects[5] (stick_slip): slip_limit = 0 is outside",
            read_changed(|v| v["effects"][5]["parameters"]["slip_limit_2"] = 0.0.into()),
        ),
        (
            "m.json: field effects[0] (offset): parameter force is missing",
            read_changed(|v| v["effects"][0]["parameters"] = serde_json::json!({})),
        ),
        (
            "m.json: field fitted_range.velocity:",
            read_changed(|v| v["fitted_range"]["velocity"] = serde_json::json!([1.0, -1.0])),
        ),
        (
            "m.json: field fitted_range.displacement: 0 to 10000000000",
            read_changed(|v| v["fitted_range"]["displacement"] = serde_json::json!([0, 1e300])),
        ),
        (
            "m.json: field units.force: unknown variant `N`",
            read_changed(|v| v["units"]["force"] = "N".into()),
        ),
        (
            "m.json: field correction: cells = 305 is outside 306",
            read_changed(|v| drop(v["correction"]["cells"].as_array_mut().unwrap().pop())),
        ),
        (
            "m.json: field correction.memory.of: unknown variant `dreams`",
            read_changed(|v| v["correction"]["memory"]["of"] = "dreams".into()),
        ),
        (
            "m.json: field law[0].k1: invalid type: string",
            read_changed(|v| v["law"][0]["k1"] = "1".into()),
        ),
    ] {
        assert!(error.starts_with(said), "{error}");
        assert!(!error.contains('\n'));
    }
}

#[test]
fn what_was_removed_is_refused_by_name() {
    for (of, name) in [
        (
            serde_json::json!({ "cycles": { "cycles": 10.0 } }),
            "cycles",
        ),
        (serde_json::json!({ "level": { "time": 0.2 } }), "level"),
        (serde_json::json!("acceleration"), "acceleration"),
    ] {
        assert_eq!(
            read_changed(|v| v["correction"]["memory"]["of"] = of),
            format!(
                "m.json: field correction.memory.of: there is no residual table over {name} any more; \
                 trace the recordings again with this program"
            )
        );
    }
}

#[test]
fn says_how_far_a_motion_goes_beyond() {
    let fitted = example().fitted_range();
    let motion = FittedRange::of(&[-0.1, 0.25], &[-6.0, 6.0]).unwrap();
    // (0.25 − 0.2)/0.2
    let [displacement, velocity] = fitted.exceeded_in(&motion);
    assert!((displacement - 0.25).abs() < 1e-12);
    assert_eq!(velocity, 0.0);
    assert_eq!(motion.exceeded_in(&motion), [0.0; 2]);
}

/// The last one of two would count in silence.
#[test]
fn a_key_that_is_given_twice_is_refused_at_every_depth() {
    let text = serde_json::to_string(&example()).unwrap();
    for (once, twice, field, key) in [
        (
            r#""version":1"#,
            r#""version":1,"version":1"#,
            ".",
            "version",
        ),
        (
            r#""force":"kN""#,
            r#""force":"kN","force":"kN""#,
            "units",
            "force",
        ),
        (r#""k3":30.0"#, r#""k3":30.0,"k3":31.0"#, "law[0]", "k3"),
        (
            r#""k2":3.0"#,
            r#""k2":3.0,"k2":-3.0"#,
            "effects[1].parameters",
            "k2",
        ),
        (
            r#""lag":{"time":0.05}"#,
            r#""lag":{"time":0.05,"time":0.05}"#,
            "correction.memory.of.lag",
            "time",
        ),
        (
            r#""reach":0.2"#,
            r#""reach":0.2,"\u0072each":0.2"#,
            "correction",
            "reach",
        ),
    ] {
        assert!(text.contains(once), "{text}");
        let said = ModelFile::from_bytes("m.json", text.replacen(once, twice, 1).as_bytes())
            .unwrap_err()
            .to_string();
        let expected = format!("m.json: field {field}: {key:?} is given twice");
        assert!(said.starts_with(&expected), "{said}");
    }
    // Two objects may have the same keys.
    assert!(ModelFile::from_bytes("m.json", text.as_bytes()).is_ok());
    let said = ModelFile::from_bytes("m.json", format!("{text} 1").as_bytes());
    assert!(
        said.unwrap_err()
            .to_string()
            .contains("not JSON: trailing characters")
    );
}

/// No lag is 0, of the one sign: 1/−0 is the other infinity.
#[test]
fn a_negative_zero_that_would_be_divided_by_is_refused_by_the_name_of_its_field() {
    let with = |lag: f64| {
        serde_json::json!({
            "family": "control_input",
            "parameters": { "stiffness": 1.0, "yield_stretch": 0.05, "rate": 1.0, "lag": lag },
        })
    };
    let said = read_changed(|v| v["effects"][0] = with(-0.0));
    assert!(
        said.starts_with("m.json: field effects[0] (control_input): lag = -0 is outside 0…1000000"),
        "{said}"
    );
    let mut value = serde_json::to_value(example()).unwrap();
    value["effects"][0] = with(0.0);
    assert!(ModelFile::from_bytes("m.json", value.to_string().as_bytes()).is_ok());
}
