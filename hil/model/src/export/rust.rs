//! A law as a Rust module of constants, composed statically.

use std::fmt::Write as _;

use mesh_damper::effects::DESCRIPTIONS;
use mesh_damper::effects::description::Description;

use super::{Export, ExportError};

/// The module's text. Each number has the fewest digits that read back as the same number.
pub fn module(export: &Export) -> Result<String, ExportError> {
    if export.model.correction.is_some() {
        return Err(ExportError::ResidualTable);
    }
    let effects = effects(export)?;
    let mut text = head(export, &effects);
    constants(export, &effects, &mut text);
    composed(&effects, &mut text);
    Ok(text)
}

/// An effect and its parameters.
type Parametrized = (&'static Description, Vec<f64>);

/// In the order of the effects in a type.
fn effects(export: &Export) -> Result<Vec<Parametrized>, ExportError> {
    let mut effects = export
        .model
        .effects
        .iter()
        .map(|effect| effect.values(|| effect.family.to_string()))
        .collect::<Result<Vec<_>, _>>()?;
    let place = |number: u8| DESCRIPTIONS.iter().position(|each| each.number == number);
    effects.sort_by_key(|(description, _)| place(description.number));
    Ok(effects)
}

/// The name of an effect's type.
fn type_of(description: &Description) -> String {
    let words = description.name.split('_');
    words
        .map(|word| {
            let (first, rest) = word.split_at(1);
            first.to_ascii_uppercase() + rest
        })
        .collect()
}

fn head(export: &Export, effects: &[Parametrized]) -> String {
    let mut used = String::new();
    if !effects.is_empty() {
        let types: Vec<String> = effects.iter().map(|(each, _)| type_of(each)).collect();
        let _ = writeln!(
            used,
            "use mesh_damper::effects::{{Equations as _, {}}};",
            types.join(", ")
        );
    }
    format!(
        "//! The model {identity} as a law for {tick_rate} ticks a second.\n\
         //!\n\
         //! Written by `hil export` of mesh-damper {version}: export the model again instead of changing this. It needs the crate\n\
         //! `mesh-damper` and nothing else. Keep a [`DamperLaw`] in a static and [`fill`] it before the first tick.\n\n\
         {used}\
         use mesh_damper::error::ConfigError;\n\
         use mesh_damper::law::Law;\n\
         use mesh_damper::operating_range::OperatingRange;\n\
         use mesh_damper::power::PowerSeed;\n\
         use mesh_damper::static_law::StaticLaw;\n\n",
        identity = export.info.stamp.identity,
        tick_rate = export.info.stamp.tick_rate,
        version = env!("CARGO_PKG_VERSION"),
    )
}

fn constants(export: &Export, effects: &[Parametrized], text: &mut String) {
    let info = &export.info;
    let law = export.law.augmented().law();
    let seed = export.law.damping();
    let mut constant = |doc: &str, declaration: &str, value: String| {
        let _ = write!(text, "/// {doc}\n{declaration} = {value};\n");
    };
    let name = format!("{:?}", info.name.as_str());
    constant("Name of the model.", "pub const NAME: &str", name);
    let identity = format!("{:?}", info.stamp.identity.0);
    constant(
        "Identity of the model, as in a pack.",
        "pub const IDENTITY: [u8; 8]",
        identity,
    );
    let revision = info.stamp.revision.to_string();
    constant(
        "Revision of this export.",
        "pub const REVISION: u32",
        revision,
    );
    let tick_rate = format!("{:?}", info.stamp.tick_rate);
    constant(
        "Ticks per second that the law is for, Hz.",
        "pub const TICK_RATE: f32",
        tick_rate,
    );
    if let Some(range) = &info.operating_range {
        for (quantity, name, ends) in [
            ("Displacement in mm", "DISPLACEMENT", range.displacement()),
            ("Velocity in mm/s", "VELOCITY", range.velocity()),
        ] {
            constant(
                &format!("{quantity} of the motion that the law was fitted on: least and largest."),
                &format!("pub const {name}: [f32; 2]"),
                format!("{ends:?}"),
            );
        }
    }
    let amplitude = format!("{:?}", info.amplitude);
    constant(
        "Amplitude that the law was taken at, mm; none where it is the same at every one.",
        "pub const AMPLITUDE: Option<f32>",
        amplitude,
    );
    let density = format!("{:?}", info.density);
    constant(
        "Density of the specimen, g/cm³; none where it is not known.",
        "pub const DENSITY: Option<f32>",
        density,
    );
    let controls: Vec<&str> = export
        .model
        .controls
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    if !controls.is_empty() {
        constant(
            "Control inputs by their index in `Motion::controls`, with their units.",
            &format!("pub const CONTROLS: [&str; {}]", controls.len()),
            format!("{controls:?}"),
        );
    }
    constant(
        "k1 in kN/mm, k3 in kN/mm³, c in kN·(s/mm)^α, and α.",
        "pub const LAW: [f32; 4]",
        format!("{:?}", [law.k1(), law.k3(), law.c(), law.alpha()]),
    );
    for (description, values) in effects {
        constant(
            &format!(
                "Parameters of the effect {}: {}.",
                description.name,
                parameters(description)
            ),
            &format!(
                "pub const {}: [f64; {}]",
                constant_of(description),
                values.len()
            ),
            format!("{values:?}"),
        );
    }
    if !effects.is_empty() {
        constant(
            "One tick, s.",
            "const TICK: f64",
            format!("{:?}", export.tick),
        );
    }
    let octave: String = seed
        .octave()
        .iter()
        .map(|row| format!("    {row:?},\n"))
        .collect();
    constant(
        "Seed of the table of c·|v|^α, computed in f64 on the host.",
        &format!("const OCTAVE: [[f32; 4]; {}]", seed.octave().len()),
        format!("[\n{octave}]"),
    );
    let scale: String = seed.scale().chunks(4).map(row_of).collect();
    constant(
        "Its factor in each octave.",
        &format!("const SCALE: [f32; {}]", seed.scale().len()),
        format!("[\n{scale}]"),
    );
}

fn row_of(values: &[f32]) -> String {
    let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    format!("    {},\n", values.join(", "))
}

fn constant_of(description: &Description) -> String {
    description.name.to_ascii_uppercase()
}

/// Names and units of one element's parameters.
fn parameters(description: &Description) -> String {
    let named = |name: &str, unit: &str| match unit {
        "1" => name.to_owned(),
        unit => format!("{name} in {unit}"),
    };
    let parameters = description.parameters.iter();
    let words: Vec<String> = parameters.map(|each| named(each.name, each.unit)).collect();
    let each = if description.most > 1 {
        ", of each element"
    } else {
        ""
    };
    words.join(", ") + each
}

fn composed(effects: &[Parametrized], text: &mut String) {
    let types: Vec<String> = effects
        .iter()
        .map(|(each, _)| format!("{}<f32>", type_of(each)))
        .collect();
    // A tuple of one needs a comma.
    let types = match &types[..] {
        [one] => format!("{one},"),
        types => types.join(", "),
    };
    let built: String = effects
        .iter()
        .map(|(each, _)| {
            let (effect, constant) = (type_of(each), constant_of(each));
            format!("        {effect}::<f32>::from_parameters(&{constant}, TICK)?,\n")
        })
        .collect();
    let (built, effects) = match &*built {
        "" => (String::new(), "()"),
        built => (format!("    let effects = (\n{built}    );\n"), "effects"),
    };
    let _ = write!(
        text,
        "\n/// The law with the effects that it has, and no others.\n\
         pub type DamperLaw = StaticLaw<({types})>;\n\n\
         /// Fills `law` where it is, at rest.\n\
         ///\n\
         /// # Errors\n\
         /// A number that this version of the crate refuses.\n\
         pub fn fill(law: &mut DamperLaw) -> Result<(), ConfigError> {{\n\
         \x20   let [k1, k3, c, alpha] = LAW;\n\
         \x20   let seed = const {{\n\
         \x20       match PowerSeed::from_parts(LAW[2], LAW[3], OCTAVE, SCALE) {{\n\
         \x20           Ok(seed) => seed,\n\
         \x20           Err(_) => panic!(\"LAW, OCTAVE or SCALE was changed: export the model again\"),\n\
         \x20       }}\n\
         \x20   }};\n\
         {built}\
         \x20   law.set_with_seed(Law::new(k1, k3, c, alpha)?, &seed, {effects})\n\
         }}\n\n\
         /// The motion that the law was fitted on, without a margin for overshoot and noise.\n\
         ///\n\
         /// # Errors\n\
         /// None for the constants as they were exported.\n\
         pub fn operating_range() -> Result<OperatingRange<f32>, ConfigError> {{\n\
         \x20   OperatingRange::new(DISPLACEMENT, VELOCITY)\n\
         }}\n"
    );
}

#[cfg(test)]
mod tests {
    use mesh_damper::effects::Effect;

    use super::*;

    /// A variant of [`Effect`] has the same name as its type.
    #[test]
    fn the_type_of_every_effect_is_named_right() {
        for each in DESCRIPTIONS {
            let effect = Effect::<f32>::from_parameters(each.number, each.typical, 1e-4).unwrap();
            let begins = format!("{effect:?}").starts_with(&format!("{}({0} {{", type_of(each)));
            assert!(begins, "{effect:?}");
        }
    }
}
