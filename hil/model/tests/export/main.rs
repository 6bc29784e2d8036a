//! A model as a pack, as a Rust module and as C is the same law with the same description.

mod modules;
mod motion;
mod written;

use mesh_damper::effects::residual_table::CELLS;
use mesh_damper::effects::{DESCRIPTIONS, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::pack::{Expectation, PackInfo, decode};
use mesh_damper_model::correction::CorrectionTable;
use mesh_damper_model::export::{Export, ExportError, ExportSettings};
use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_model::predict::{motion_at, predict_embedded};
use mesh_damper_model::{AddedEffect, Control, Family, LawNode, MAX_EFFECTS, Model};

use motion::{CURRENT, TICK_RATE, two_sines};

fn node(amplitude: f64, k1: f64) -> LawNode {
    LawNode {
        amplitude,
        k1,
        k3: 10.5,
        c: 0.1114,
        alpha: 0.3969,
    }
}

fn file(law: Vec<LawNode>, effects: Vec<AddedEffect>) -> ModelFile {
    let is_controlled = effects.iter().any(|each| each.family.depends_on_control());
    let control = Control {
        name: CURRENT.into(),
        range: [0.0, 2.0],
    };
    let model = Model {
        law,
        effects,
        correction: None,
        controls: is_controlled.then_some(control).into_iter().collect(),
    };
    let range = FittedRange {
        displacement: [-0.2, 0.25],
        velocity: [-6.3, 6.5],
    };
    ModelFile::new(model, range)
}

fn settings(name: &str) -> ExportSettings {
    ExportSettings {
        density: Some(3.0),
        revision: 4,
        ..ExportSettings::at(TICK_RATE, name)
    }
}

/// The law alone, and every effect of the crate, in the reverse order of a type.
fn models() -> Vec<(String, ModelFile)> {
    let alone = (
        "alone".to_owned(),
        file(vec![node(0.0, 1.0539)], Vec::new()),
    );
    let parts = DESCRIPTIONS.chunks(MAX_EFFECTS).enumerate();
    let parts = parts.map(|(part, chunk)| {
        let effects = chunk.iter().rev().map(AddedEffect::typical).collect();
        let law = node(0.1 * (part % 2) as f64, 1.0539);
        (format!("part_{part}"), file(vec![law], effects))
    });
    std::iter::once(alone).chain(parts).collect()
}

/// A force in every module, at every tick of a trajectory, equals that of the pack and of `hil predict`, to the last bit.
#[test]
fn a_module_gives_the_force_of_the_pack_bit_for_bit_and_says_the_same() {
    let trajectory = two_sines();
    let motions: Vec<Motion<f32>> = (0..trajectory.len())
        .map(|tick| motion_at(&trajectory, tick))
        .collect();
    let exports: Vec<(String, Export)> = models()
        .iter()
        .map(|(name, file)| (name.clone(), Export::new(file, &settings(name)).unwrap()))
        .collect();
    let ran = modules::run(&exports, &motions);
    for (((name, export), (_, file)), ran) in exports.iter().zip(models()).zip(ran) {
        let mut slot = FastLaw::<MAX_EFFECTS>::EMPTY;
        let expected = Expectation::at(TICK_RATE as f32);
        let pack = export.pack().unwrap();
        decode(&pack, &mut slot, &expected).unwrap();
        assert_eq!(PackInfo::of(&pack), Ok(Some(export.info().clone())));
        let mut packed = RunningLaw::new(slot);
        let predicted = predict_embedded(&file.model(), &trajectory).unwrap();
        assert_eq!(ran.forces.len(), predicted.len());
        let mut largest: f32 = 0.0;
        for (tick, (force, predicted)) in ran.forces.into_iter().zip(predicted).enumerate() {
            let of_pack = packed.force(&motions[tick]);
            assert_eq!(force.to_bits(), of_pack.to_bits(), "{name}, tick {tick}");
            assert_eq!(f64::from(force), predicted, "{name}, tick {tick}");
            largest = largest.max(force.abs());
        }
        assert!(largest > 0.1, "{largest}");
        let info = export.info();
        let said = format!(
            "{:?}",
            (
                info.name.as_str(),
                info.stamp.identity.0,
                info.stamp.revision,
                info.stamp.tick_rate,
                info.operating_range.as_ref().unwrap(),
                info.amplitude,
                info.density,
            )
        );
        assert_eq!(ran.said, said);
    }
}

/// An export lists the control input at each index, in Rust and in C.
#[test]
fn an_export_names_its_control_inputs() {
    let is_set = |(_, file): &(String, ModelFile)| !file.model().controls.is_empty();
    let (set, free): (Vec<_>, Vec<_>) = models().into_iter().partition(is_set);
    let [(_, set)] = &set[..] else {
        panic!("one effect depends on an input");
    };
    let set = Export::new(set, &settings("set")).unwrap();
    let module = set.rust().unwrap();
    let line = format!("pub const CONTROLS: [&str; 1] = [{CURRENT:?}];");
    assert!(module.lines().any(|each| each == line), "{module}");
    let [header, _] = set.c("set").unwrap();
    let line = "#define SET_CONTROL_0 \"current_A\"";
    assert!(header.lines().any(|each| each == line), "{header}");
    for (name, file) in &free {
        let [header, _] = Export::new(file, &settings(name)).unwrap().c(name).unwrap();
        assert!(!header.contains("CONTROL"), "{header}");
    }
}

/// The identity depends on the contents of the model, not on the file's layout, the rate, the name or the revision.
#[test]
fn an_identity_is_the_models() {
    let models = models();
    let [_, (_, first), (_, second), ..] = &models[..] else {
        panic!("more effects than a law has");
    };
    let compact = serde_json::to_vec(first).unwrap();
    let again = ModelFile::from_bytes("m.json", &compact).unwrap();
    assert_eq!(again.identity(), first.identity());
    assert_ne!(first.identity(), second.identity());
    let other = ExportSettings {
        revision: 9,
        ..ExportSettings::at(1e4, "another")
    };
    let other = Export::new(first, &other).unwrap();
    assert_eq!(other.info().stamp.identity, first.identity());
    let mut changed = serde_json::to_value(first).unwrap();
    changed["law"][0]["k1"] = 1.053_900_000_000_1.into();
    let changed = ModelFile::from_bytes("m.json", changed.to_string().as_bytes()).unwrap();
    assert_ne!(changed.identity(), first.identity());
    changed_range_is_another(first);
}

fn changed_range_is_another(file: &ModelFile) {
    let mut wider = serde_json::to_value(file).unwrap();
    wider["fitted_range"]["velocity"][1] = 6.6.into();
    let wider = ModelFile::from_bytes("m.json", wider.to_string().as_bytes()).unwrap();
    assert_ne!(wider.identity(), file.identity());
}

#[test]
fn a_law_over_amplitude_is_taken_at_the_largest_or_the_one_that_is_asked() {
    let file = file(vec![node(0.1, 1.0), node(0.2, 2.0)], Vec::new());
    let taken = |amplitude| {
        let settings = ExportSettings {
            amplitude,
            ..settings("two")
        };
        let export = Export::new(&file, &settings)?;
        let mut law = FastLaw::<MAX_EFFECTS>::EMPTY;
        decode(&export.pack()?, &mut law, &Expectation::default()).unwrap();
        let k1 = law.augmented().law().k1();
        Ok::<_, ExportError>((export.info().amplitude, k1))
    };
    assert_eq!(taken(None), Ok((Some(0.2), 2.0)));
    assert_eq!(taken(Some(0.125)), Ok((Some(0.125), 1.25)));
    for amplitude in [0.05, 0.3, -0.1] {
        let error = taken(Some(amplitude)).unwrap_err().to_string();
        assert_eq!(error, format!("amplitude = {amplitude} is outside 0.1…0.2"));
    }
    assert_eq!(
        taken(Some(f64::NAN)).unwrap_err().to_string(),
        "amplitude is not a finite number"
    );
}

#[test]
fn what_cannot_be_exported_is_refused_by_name() {
    let (_, alone) = models().swap_remove(0);
    let refused = |file: &ModelFile, settings: &ExportSettings| {
        Export::new(file, settings).unwrap_err().to_string()
    };
    for (rate, said) in [
        (0.0, "tick_rate = 0 is outside 1…1000000"),
        (2e6, "tick_rate = 2000000 is outside 1…1000000"),
        (f64::NAN, "tick_rate is not a finite number"),
    ] {
        assert_eq!(refused(&alone, &ExportSettings::at(rate, "m")), said);
    }
    assert_eq!(
        refused(&alone, &ExportSettings::at(1e4, "n".repeat(33))),
        "name holds at most 32"
    );
    let with_amplitude = ExportSettings {
        amplitude: Some(0.1),
        ..settings("m")
    };
    assert!(refused(&alone, &with_amplitude).contains("same coefficients at every amplitude"));
    let heavy = ExportSettings {
        density: Some(0.0),
        ..settings("m")
    };
    assert!(refused(&alone, &heavy).starts_with("density = 0 is outside"));
    // 30 ms are 300 ticks at 10 kHz, and an image can store 255.
    let late = AddedEffect {
        family: Family::named("delay").unwrap(),
        parameters: [("time".to_owned(), 0.03)].into(),
    };
    let late = file(vec![node(0.0, 1.0)], vec![late]);
    assert!(Export::new(&late, &ExportSettings::at(2e3, "m")).is_ok());
    let said = refused(&late, &ExportSettings::at(1e4, "m"));
    assert!(said.starts_with("effects[0] (delay): time"), "{said}");
}

/// A pack can carry a residual table, a static type cannot.
#[test]
fn a_residual_table_goes_into_a_pack_alone() {
    let table = CorrectionTable {
        reach: 0.2,
        speed: 6.3,
        unit: 1e-6,
        cells: vec![7; CELLS],
        memory: None,
    };
    let model = Model {
        law: vec![node(0.0, 1.0)],
        effects: Vec::new(),
        correction: Some(table),
        controls: Vec::new(),
    };
    let range = FittedRange {
        displacement: [-0.2, 0.2],
        velocity: [-6.3, 6.3],
    };
    let export = Export::new(&ModelFile::new(model, range), &settings("m")).unwrap();
    assert_eq!(export.rust(), Err(ExportError::ResidualTable));
    let mut law = FastLaw::<MAX_EFFECTS>::EMPTY;
    decode(&export.pack().unwrap(), &mut law, &Expectation::default()).unwrap();
    assert!(law.augmented().residual_table().is_some());
}

/// The numbers of the C are those of the pack; that it compiles is tested with `hil export`.
#[test]
fn c_holds_the_packs_bytes_and_what_they_say() {
    let mut export_of = settings("Mount 4 \"new\"");
    export_of.amplitude = Some(0.1);
    let file = file(vec![node(0.1, 1.0), node(0.2, 2.0)], Vec::new());
    let export = Export::new(&file, &export_of).unwrap();
    let [header, source] = export.c("mount-4").unwrap();
    for line in [
        r#"#define MOUNT_4_NEW_NAME "Mount 4 \"new\"""#,
        "#define MOUNT_4_NEW_REVISION 4u",
        "#define MOUNT_4_NEW_TICK_RATE 2000.0f",
        "extern const float Mount_4_new_displacement[2];",
        "extern const float Mount_4_new_density;",
    ] {
        assert!(header.lines().any(|each| each == line), "{line}: {header}");
    }
    for line in [
        "#include \"mount-4.h\"",
        "const float Mount_4_new_displacement[2] = {-0.2f, 0.25f};",
        "const float Mount_4_new_velocity[2] = {-6.3f, 6.5f};",
        "const float Mount_4_new_amplitude = 0.1f;",
    ] {
        assert!(source.lines().any(|each| each == line), "{line}: {source}");
    }
    let body = source.split("_pack[MOUNT_4_NEW_PACK_LENGTH] = {").nth(1);
    let body = body.unwrap().split('}').next().unwrap();
    let bytes = body
        .split(',')
        .map(str::trim)
        .filter(|byte| !byte.is_empty());
    let bytes = bytes.map(|byte| u8::from_str_radix(byte.trim_start_matches("0x"), 16));
    let bytes: Vec<u8> = bytes.map(Result::unwrap).collect();
    assert_eq!(bytes, export.pack().unwrap());
}
