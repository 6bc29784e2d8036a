//! Values of an instance's variables: read, and set.

use super::{Instance, N_PER_KN, evaluate::evaluate, place};
use crate::refusal::{Refusal, finite};
use crate::state::Phase;
use crate::types::ValueReference;
use crate::variables::{Kind, MM_PER_M, Variable};

impl Instance {
    fn variable(&self, reference: ValueReference) -> Result<&Variable, Refusal> {
        self.variables.get(&reference).ok_or_else(|| {
            Refusal::new(
                "valueReference",
                reference,
                "no variable of this FMU has it",
                "take value references from modelDescription.xml",
            )
        })
    }

    fn expect_readable(&self, function: &str) -> Result<(), Refusal> {
        self.expect(
            function,
            &[Phase::Initialization, Phase::Stepping, Phase::Terminated],
        )
    }

    /// Force in kN and range of the tick at the start, with the present inputs: during initialization they may still change.
    fn preview(&self) -> Result<(f64, bool), Refusal> {
        let (mut law, mut state) = (self.law.clone(), self.state.clone());
        if let Some(other) = self.law_at_amplitude()? {
            law.set_law(other);
        }
        evaluate(&law, &self.contents.file.fitted_range(), &mut state, 0.0);
        Ok((state.force, state.is_within))
    }

    /// `fmi2GetReal` of one variable.
    ///
    /// # Errors
    /// It was called out of order, or this is no real variable.
    pub fn real(&self, reference: ValueReference) -> Result<f64, Refusal> {
        self.expect_readable("fmi2GetReal")?;
        let variable = self.variable(reference)?;
        Ok(match &variable.kind {
            Kind::Input(_) => self.state.inputs[place(reference).unwrap_or_default()],
            Kind::Output if self.state.phase == Phase::Initialization => {
                N_PER_KN * self.preview()?.0
            }
            Kind::Output => N_PER_KN * self.state.force,
            Kind::Parameter(..) => self.state.amplitude / MM_PER_M,
            Kind::Real(value) => *value,
            Kind::BooleanOutput | Kind::Text(_) => return Err(not_of(variable, "fmi2GetReal")),
        })
    }

    /// `fmi2GetBoolean` of one variable.
    ///
    /// # Errors
    /// It was called out of order, or this is no Boolean variable.
    pub fn boolean(&self, reference: ValueReference) -> Result<bool, Refusal> {
        self.expect_readable("fmi2GetBoolean")?;
        let variable = self.variable(reference)?;
        match variable.kind {
            Kind::BooleanOutput if self.state.phase == Phase::Initialization => {
                Ok(self.preview()?.1)
            }
            Kind::BooleanOutput => Ok(self.state.is_within),
            _ => Err(not_of(variable, "fmi2GetBoolean")),
        }
    }

    /// `fmi2GetString` of one variable.
    ///
    /// # Errors
    /// It was called out of order, or this is no text.
    pub fn text(&self, reference: ValueReference) -> Result<&str, Refusal> {
        self.expect_readable("fmi2GetString")?;
        let variable = self.variable(reference)?;
        match &variable.kind {
            Kind::Text(text) => Ok(text),
            _ => Err(not_of(variable, "fmi2GetString")),
        }
    }

    /// The refusal of `function` for this variable, because no variable has its type.
    pub fn none_of_type(&self, function: &str, reference: ValueReference) -> Refusal {
        match self.variable(reference) {
            Ok(variable) => not_of(variable, function),
            Err(unknown) => unknown,
        }
    }

    /// `fmi2SetReal`: all of the values, or none.
    ///
    /// # Errors
    /// It was called out of order, a variable cannot be set, or a value is not permitted.
    pub fn set_reals(
        &mut self,
        values: impl Iterator<Item = (ValueReference, f64)> + Clone,
    ) -> Result<(), Refusal> {
        self.expect(
            "fmi2SetReal",
            &[Phase::Instantiated, Phase::Initialization, Phase::Stepping],
        )?;
        for (reference, value) in values.clone() {
            let variable = self.variable(reference)?;
            finite(&variable.name, value)?;
            match variable.kind {
                Kind::Input(_) => {}
                Kind::Parameter(_, [low, high]) => {
                    if !(low..=high).contains(&value) {
                        return Err(Refusal::new(
                            &variable.name,
                            format_args!("{value} m"),
                            format_args!("the model was fitted from {low} to {high} m"),
                            "give one within",
                        ));
                    }
                }
                _ => {
                    return Err(Refusal::new(
                        "valueReference",
                        reference,
                        format_args!("{} is not to be set", variable.name),
                        "set inputs and parameters alone",
                    ));
                }
            }
        }
        for (reference, value) in values {
            match place(reference) {
                Some(place) => self.state.inputs[place] = value,
                None => self.state.amplitude = value * MM_PER_M,
            }
        }
        Ok(())
    }

    /// `fmi2SetRealInputDerivatives`: for the next step, all or none.
    ///
    /// # Errors
    /// It was called out of order, a variable is no input, an order is neither 1 nor 2, or a value is NaN.
    pub fn set_slopes(
        &mut self,
        values: impl Iterator<Item = (ValueReference, i32, f64)> + Clone,
    ) -> Result<(), Refusal> {
        self.expect(
            "fmi2SetRealInputDerivatives",
            &[Phase::Initialization, Phase::Stepping],
        )?;
        for (reference, order, value) in values.clone() {
            let variable = self.variable(reference)?;
            finite(&variable.name, value)?;
            if !matches!(variable.kind, Kind::Input(_)) {
                return Err(Refusal::new(
                    "valueReference",
                    reference,
                    format_args!("{} is no input", variable.name),
                    "give derivatives of inputs alone",
                ));
            }
            if ![1, 2].contains(&order) {
                return Err(Refusal::new(
                    "order",
                    order,
                    format_args!(
                        "of {}: first and second derivatives are taken",
                        variable.name
                    ),
                    "give 1 or 2",
                ));
            }
        }
        for (reference, order, value) in values {
            if let (Some(place), Ok(order)) = (place(reference), usize::try_from(order - 1)) {
                self.state.slopes[place][order] = value;
            }
        }
        Ok(())
    }
}

fn not_of(variable: &Variable, function: &str) -> Refusal {
    Refusal::new(
        "valueReference",
        variable.reference,
        format_args!("{} is not of the type of {function}", variable.name),
        "take types from modelDescription.xml",
    )
}
