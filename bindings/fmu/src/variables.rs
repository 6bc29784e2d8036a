//! The variables of an FMU for a model, and their value references.

use mesh_damper::effects::CONTROLS;

use crate::contents::Contents;
use crate::refusal::Refusal;
use crate::types::ValueReference;

/// Number of possible inputs: the motion, the temperature, the cycles and the control inputs. Their value references are their
/// indices.
pub const INPUTS: usize = FIRST_CONTROL + CONTROLS;
/// Displacement, m.
pub const DISPLACEMENT: usize = 0;
/// Velocity, m/s.
pub const VELOCITY: usize = 1;
/// Acceleration, m/s².
pub const ACCELERATION: usize = 2;
/// Temperature, °C.
pub const TEMPERATURE: usize = 3;
/// Cycles since the test began.
pub const CYCLES: usize = 4;
/// The first control input, in the unit of its name.
pub const FIRST_CONTROL: usize = 5;
/// Force, N.
pub const FORCE: ValueReference = 16;
/// Whether the motion is within the range on which the model was fitted.
pub const WITHIN_RANGE: ValueReference = 17;
/// Amplitude of the law, m.
pub const AMPLITUDE: ValueReference = 32;
/// Ticks per second, Hz.
pub const TICK_RATE: ValueReference = 33;
/// Revision of the export.
pub const REVISION: ValueReference = 34;
/// Identity of the model.
pub const IDENTITY: ValueReference = 35;

/// The kind of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A real input with its start value.
    Input(f64),
    /// A real output.
    Output,
    /// A Boolean output.
    BooleanOutput,
    /// A parameter that may change between steps: start value, smallest and largest value.
    Parameter(f64, [f64; 2]),
    /// A real constant.
    Real(f64),
    /// A constant text.
    Text(String),
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Value reference.
    pub reference: ValueReference,
    /// Its name for a master.
    pub name: String,
    /// Symbol of its unit; empty without a unit.
    pub unit: String,
    /// Its kind.
    pub kind: Kind,
    /// In a few words.
    pub description: String,
}

/// The variables of an FMU with these `contents`, in the order of the description.
///
/// # Errors
/// A control input has the name of another variable.
pub fn variables(contents: &Contents) -> Result<Vec<Variable>, Refusal> {
    let model = contents.file.model();
    let range = contents.file.fitted_range();
    let variable = |reference, name: &str, unit: &str, kind, description: String| Variable {
        reference,
        name: name.into(),
        unit: unit.into(),
        kind,
        description,
    };
    let input = |place: usize, name: &str, unit: &str, start, description| {
        variable(
            place as ValueReference,
            name,
            unit,
            Kind::Input(start),
            description,
        )
    };
    let [low, high] = range.displacement;
    let [slowest, fastest] = range.velocity;
    let mut all = vec![
        input(
            DISPLACEMENT,
            "displacement",
            "m",
            0.0,
            format!("Displacement of the damper; the model was fitted from {low} to {high} mm"),
        ),
        input(
            VELOCITY,
            "velocity",
            "m/s",
            0.0,
            format!(
                "Velocity of the damper; the model was fitted from {slowest} to {fastest} mm/s"
            ),
        ),
        input(
            ACCELERATION,
            "acceleration",
            "m/s2",
            0.0,
            "Acceleration of the damper".into(),
        ),
    ];
    if model.depends_on_temperature() {
        all.push(input(
            TEMPERATURE,
            "temperature",
            "degC",
            contents.settings.temperature,
            "Temperature of the damper".into(),
        ));
    }
    if model.depends_on_cycles() {
        all.push(input(
            CYCLES,
            "cycles",
            "1",
            0.0,
            "Cycles since the test began, the fraction of the current one included".into(),
        ));
    }
    for (place, control) in model.controls.iter().enumerate() {
        let [low, high] = control.range;
        // A column's name ends with its unit.
        let unit = control.name.rsplit_once('_').map_or("", |(_, unit)| unit);
        all.push(input(
            FIRST_CONTROL + place,
            &control.name,
            unit,
            0.0,
            format!("Control input; the model was fitted from {low} to {high}"),
        ));
    }
    all.push(variable(
        FORCE,
        "force",
        "N",
        Kind::Output,
        "Force that the damper resists the motion with, at the end of the step".into(),
    ));
    all.push(variable(
        WITHIN_RANGE,
        "within_operating_range",
        "",
        Kind::BooleanOutput,
        "Whether displacement and velocity lie within those that the model was fitted on".into(),
    ));
    if let Some(amplitude) = contents.settings.amplitude {
        // In metres: they are multiplied back later.
        let ends = [model.law.first(), model.law.last()];
        let ends = ends.map(|node| node.map_or(amplitude, |node| node.amplitude) / MM_PER_M);
        all.push(variable(
            AMPLITUDE,
            "amplitude",
            "m",
            Kind::Parameter(amplitude / MM_PER_M, ends),
            "Amplitude of the cycles that the law's coefficients are for".into(),
        ));
    }
    all.push(variable(
        TICK_RATE,
        "tick_rate",
        "Hz",
        Kind::Real(contents.settings.tick_rate),
        "Evaluations of the law per second: a step is a whole number of ticks".into(),
    ));
    all.push(variable(
        REVISION,
        "revision",
        "",
        Kind::Real(contents.settings.revision.into()),
        "Revision of the export".into(),
    ));
    all.push(variable(
        IDENTITY,
        "identity",
        "",
        Kind::Text(contents.file.identity().to_string()),
        "Identity of the model".into(),
    ));
    for (place, each) in all.iter().enumerate() {
        if each.name.chars().any(char::is_control)
            || all[..place].iter().any(|other| other.name == each.name)
        {
            return Err(Refusal::new(
                "controls",
                &each.name,
                "no name of its own among the variables of an FMU",
                "rename the control input in the model",
            ));
        }
    }
    Ok(all)
}

/// Size of a metre in the unit of models.
pub const MM_PER_M: f64 = 1e3;
