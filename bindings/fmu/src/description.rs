//! `modelDescription.xml` of an FMU for one model.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::contents::Contents;
use crate::refusal::Refusal;
use crate::units::by_symbol;
use crate::variables::{Kind, Variable, variables};
use crate::{IDENTIFIER, functions};

/// The description of an FMU with these `contents`.
///
/// # Errors
/// A control input has the name of another variable.
pub fn description(contents: &Contents) -> Result<String, Refusal> {
    let variables = variables(contents)?;
    let settings = &contents.settings;
    let file = &contents.file;
    let name = match settings.name.as_str() {
        "" => "damper",
        name => name,
    };
    let tool = concat!("mesh-damper ", env!("CARGO_PKG_VERSION"));
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string does not fail.
    let _ = write!(
        xml,
        "<fmiModelDescription fmiVersion=\"2.0\" modelName={} guid={} description={} version=\"{}\" \
         generationTool=\"{tool}\" variableNamingConvention=\"flat\">\n  \
         <CoSimulation modelIdentifier=\"{IDENTIFIER}\" canHandleVariableCommunicationStepSize=\"true\" \
         canInterpolateInputs=\"true\" canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" \
         canSerializeFMUstate=\"true\"/>\n",
        quoted(name),
        quoted(&contents.guid),
        quoted(&format!(
            "Metal mesh damper, model {}: force of a motion",
            file.identity()
        )),
        settings.revision,
    );
    units(&mut xml, &variables);
    let range = file.fitted_range();
    let number = |name: &str, value: Option<f64>| {
        value.map_or(String::new(), |value| format!(" {name}=\"{value:?}\""))
    };
    let _ = write!(
        xml,
        "  <LogCategories>\n    <Category name=\"{}\"/>\n    <Category name=\"{}\"/>\n  </LogCategories>\n  \
         <DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"{:?}\"/>\n  \
         <VendorAnnotations>\n    <Tool name=\"mesh-damper\">\n      \
         <Export identity=\"{}\" revision=\"{}\" tickRate=\"{:?}\"{}{} leastDisplacement=\"{:?}\" largestDisplacement=\"{:?}\" \
         leastVelocity=\"{:?}\" largestVelocity=\"{:?}\"/>\n    </Tool>\n  </VendorAnnotations>\n",
        functions::ERRORS.to_string_lossy(),
        functions::WARNINGS.to_string_lossy(),
        1.0 / settings.tick_rate,
        file.identity(),
        settings.revision,
        settings.tick_rate,
        number("amplitude", settings.amplitude),
        number("density", settings.density),
        range.displacement[0],
        range.displacement[1],
        range.velocity[0],
        range.velocity[1],
    );
    xml += "  <ModelVariables>\n";
    for variable in &variables {
        scalar(&mut xml, variable);
    }
    xml += "  </ModelVariables>\n  <ModelStructure>\n";
    // Counted from 1.
    let outputs: Vec<usize> = (1..)
        .zip(&variables)
        .filter(|(_, it)| matches!(it.kind, Kind::Output | Kind::BooleanOutput))
        .map(|(place, _)| place)
        .collect();
    for list in ["Outputs", "InitialUnknowns"] {
        let _ = writeln!(xml, "    <{list}>");
        for place in &outputs {
            let _ = writeln!(xml, "      <Unknown index=\"{place}\"/>");
        }
        let _ = writeln!(xml, "    </{list}>");
    }
    xml += "  </ModelStructure>\n</fmiModelDescription>\n";
    Ok(xml)
}

/// The units of `variables`, each once.
fn units(xml: &mut String, variables: &[Variable]) {
    let symbols: BTreeSet<&str> = variables
        .iter()
        .map(|variable| variable.unit.as_str())
        .filter(|symbol| !symbol.is_empty())
        .collect();
    *xml += "  <UnitDefinitions>\n";
    for symbol in symbols {
        let _ = write!(xml, "    <Unit name={}", quoted(symbol));
        let Some(unit) = by_symbol(symbol) else {
            *xml += "/>\n";
            continue;
        };
        *xml += ">\n      <BaseUnit";
        for (base, exponent) in unit.exponents {
            let _ = write!(xml, " {base}=\"{exponent}\"");
        }
        if unit.factor != 1.0 {
            let _ = write!(xml, " factor=\"{:?}\"", unit.factor);
        }
        if unit.offset != 0.0 {
            let _ = write!(xml, " offset=\"{:?}\"", unit.offset);
        }
        *xml += "/>\n    </Unit>\n";
    }
    *xml += "  </UnitDefinitions>\n";
}

fn scalar(xml: &mut String, variable: &Variable) {
    let (attributes, kind) = match &variable.kind {
        Kind::Input(start) => (
            "causality=\"input\" variability=\"continuous\"",
            format!("Real start=\"{start:?}\""),
        ),
        // A law with memory is evaluated at ticks, and its force is constant from tick to tick.
        Kind::Output => (
            "causality=\"output\" variability=\"continuous\" initial=\"calculated\"",
            "Real".into(),
        ),
        Kind::BooleanOutput => (
            "causality=\"output\" variability=\"discrete\" initial=\"calculated\"",
            "Boolean".into(),
        ),
        Kind::Parameter(start, [low, high]) => (
            "causality=\"parameter\" variability=\"tunable\" initial=\"exact\"",
            format!("Real start=\"{start:?}\" min=\"{low:?}\" max=\"{high:?}\""),
        ),
        Kind::Real(value) => (
            "causality=\"local\" variability=\"constant\" initial=\"exact\"",
            format!("Real start=\"{value:?}\""),
        ),
        Kind::Text(text) => (
            "causality=\"local\" variability=\"constant\" initial=\"exact\"",
            format!("String start={}", quoted(text)),
        ),
    };
    let unit = match variable.unit.as_str() {
        "" => String::new(),
        unit => format!(" unit={}", quoted(unit)),
    };
    let _ = write!(
        xml,
        "    <ScalarVariable name={} valueReference=\"{}\" {attributes} description={}>\n      <{kind}{unit}/>\n    </ScalarVariable>\n",
        quoted(&variable.name),
        variable.reference,
        quoted(&variable.description),
    );
}

/// As the value of an attribute. A control character that XML 1.0 does not allow becomes a question mark.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for sign in text.chars() {
        match sign {
            '&' => quoted += "&amp;",
            '<' => quoted += "&lt;",
            '>' => quoted += "&gt;",
            '"' => quoted += "&quot;",
            '\u{fffe}' | '\u{ffff}' => quoted.push('?'),
            _ if sign.is_control() => quoted.push('?'),
            _ => quoted.push(sign),
        }
    }
    quoted + "\""
}
