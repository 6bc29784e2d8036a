//! A model as a pack, as a Rust module and as C is the same law with the same description.
//!
//! The generator writes the modules next to this file: `BLESS=1 cargo test -p mesh-damper-model --test export` writes them again.

#[rustfmt::skip]
mod alone;
#[rustfmt::skip]
mod first;
#[rustfmt::skip]
mod second;
#[rustfmt::skip]
mod third;
mod typical;

use std::path::Path;

use mesh_damper::effects::DESCRIPTIONS;
use mesh_damper::effects::residual_table::CELLS;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::pack::{Expectation, Identity, PackInfo, Stamp, decode};
use mesh_damper::tick_law::TickLaw;
use mesh_damper_model::correction::CorrectionTable;
use mesh_damper_model::export::{Export, ExportError, ExportSettings};
use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_model::predict::{motion_at, predict_embedded};
use mesh_damper_model::{AddedEffect, Control, Family, LawNode, MAX_EFFECTS, Model};

use typical::{CURRENT, TICK_RATE, two_sines, typical};

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

/// The models of the modules: the law alone, and every effect of the crate, in the reverse order of a type.
fn models() -> [(&'static str, ModelFile); 4] {
    let mut chunks = DESCRIPTIONS.chunks(MAX_EFFECTS);
    let mut next = || -> Vec<AddedEffect> {
        let chunk = chunks.next().unwrap_or_default();
        chunk.iter().rev().map(typical).collect()
    };
    let models = [
        ("alone", file(vec![node(0.0, 1.0539)], Vec::new())),
        ("first", file(vec![node(0.0, 1.0539)], next())),
        ("second", file(vec![node(0.1, 1.2)], next())),
        ("third", file(vec![node(0.0, 1.0539)], next())),
    ];
    assert!(chunks.next().is_none(), "one more module is needed");
    models
}

fn export(name: &str) -> Export {
    let models = models();
    let (_, file) = models.iter().find(|(each, _)| *each == name).unwrap();
    Export::new(file, &settings(name)).unwrap()
}

#[test]
fn the_modules_in_the_tree_are_what_is_written() {
    for (name, _) in models() {
        let text = export(name).rust().unwrap();
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/export/{name}.rs"));
        if std::env::var("BLESS").is_ok_and(|bless| bless == "1") {
            std::fs::write(&path, &text).unwrap();
        }
        let there = std::fs::read_to_string(&path).unwrap();
        assert!(text == there, "{}: run with BLESS=1", path.display());
    }
}

/// The force of `law` at every tick of the trajectory equals that of the pack and of `hil predict`, to the last bit.
fn is_the_packs(name: &str, law: &mut impl TickLaw) {
    let export = export(name);
    let mut slot = FastLaw::<MAX_EFFECTS>::EMPTY;
    let expected = Expectation::at(TICK_RATE as f32);
    let pack = export.pack().unwrap();
    decode(&pack, &mut slot, &expected).unwrap();
    assert_eq!(PackInfo::of(&pack), Ok(Some(export.info().clone())));
    let mut packed = RunningLaw::new(slot);
    let trajectory = two_sines();
    let models = models();
    let (_, file) = models.iter().find(|(each, _)| *each == name).unwrap();
    let predicted = predict_embedded(&file.model(), &trajectory).unwrap();
    let mut largest: f32 = 0.0;
    for (tick, predicted) in predicted.into_iter().enumerate() {
        let motion = motion_at(&trajectory, tick);
        let (force, of_pack) = (law.force(&motion), packed.force(&motion));
        assert_eq!(force.to_bits(), of_pack.to_bits(), "{name}, tick {tick}");
        assert_eq!(f64::from(force), predicted, "{name}, tick {tick}");
        largest = largest.max(force.abs());
    }
    assert!(largest > 0.1, "{largest}");
}

macro_rules! agrees {
    ($module:ident) => {{
        let mut law = Box::new($module::DamperLaw::empty());
        $module::fill(&mut law).unwrap();
        is_the_packs(stringify!($module), &mut *law);
        let info = PackInfo {
            operating_range: Some($module::operating_range().unwrap()),
            density: $module::DENSITY,
            amplitude: $module::AMPLITUDE,
            stamp: Stamp {
                tick_rate: $module::TICK_RATE,
                revision: $module::REVISION,
                identity: Identity($module::IDENTITY),
            },
            ..PackInfo::at($module::TICK_RATE)
                .named($module::NAME)
                .unwrap()
        };
        assert_eq!(&info, export(stringify!($module)).info());
    }};
}

#[test]
fn a_module_gives_the_force_of_the_pack_bit_for_bit_and_says_the_same() {
    agrees!(alone);
    agrees!(first);
    agrees!(second);
    agrees!(third);
}

/// An export lists the control input at each index, in Rust and in C.
#[test]
fn an_export_names_its_control_inputs() {
    assert_eq!(second::CONTROLS, [CURRENT]);
    let [header, _] = export("second").c("second").unwrap();
    let line = "#define SECOND_CONTROL_0 \"current_A\"";
    assert!(header.lines().any(|each| each == line), "{header}");
    let [header, _] = export("first").c("first").unwrap();
    assert!(!header.contains("CONTROL"), "{header}");
}

/// The identity depends on the contents of the model, not on the file's layout, the rate, the name or the revision.
#[test]
fn an_identity_is_the_models() {
    let [_, (_, first), (_, second), _] = models();
    let compact = serde_json::to_vec(&first).unwrap();
    let again = ModelFile::from_bytes("m.json", &compact).unwrap();
    assert_eq!(again.identity(), first.identity());
    assert_ne!(first.identity(), second.identity());
    let other = ExportSettings {
        revision: 9,
        ..ExportSettings::at(1e4, "another")
    };
    let other = Export::new(&first, &other).unwrap();
    assert_eq!(other.info().stamp.identity, first.identity());
    let mut changed = serde_json::to_value(&first).unwrap();
    changed["law"][0]["k1"] = 1.053_900_000_000_1.into();
    let changed = ModelFile::from_bytes("m.json", changed.to_string().as_bytes()).unwrap();
    assert_ne!(changed.identity(), first.identity());
    changed_range_is_another(&first);
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
    let [(_, alone), ..] = models();
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
