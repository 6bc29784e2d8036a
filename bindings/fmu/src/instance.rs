//! An instance: what may be called when, and a step.
//!
//! A call that is refused changes nothing, so that a master may mend it and go on.

use std::collections::BTreeMap;

use mesh_damper::effects::{AugmentedLaw, CONTROLS, Motion};
use mesh_damper::law::Law;
use mesh_damper_model::file::FittedRange;
use mesh_damper_model::{MAX_EFFECTS, Model};

use crate::contents::Contents;
use crate::refusal::{Refusal, finite};
use crate::state::{Phase, State};
use crate::types::ValueReference;
use crate::variables::{self, FIRST_CONTROL, INPUTS, Kind, MM_PER_M, Variable};

/// Newtons in a kilonewton, the unit of models.
const N_PER_KN: f64 = 1e3;
/// How far a time may lie from a tick, in ticks: what a master's sums of steps round off.
const ROUNDED: f64 = 1e-3;
/// Most ticks of one step: a day at 10 kHz.
const MOST_TICKS: f64 = 1e9;

/// One damper.
#[derive(Debug)]
pub struct Instance {
    contents: Contents,
    variables: BTreeMap<ValueReference, Variable>,
    model: Model,
    law: AugmentedLaw<f64, MAX_EFFECTS>,
    /// Amplitude that the law is at, mm.
    law_amplitude: f64,
    state: State,
    saved: BTreeMap<usize, Box<State>>,
    next_saved: usize,
    has_left_range: bool,
}

/// Where an input stands among the values that are set.
fn place(reference: ValueReference) -> Option<usize> {
    usize::try_from(reference).ok().filter(|it| *it < INPUTS)
}

impl Instance {
    /// At its start values.
    ///
    /// # Errors
    /// A model that cannot run at the tick rate.
    pub fn new(contents: Contents) -> Result<Self, Refusal> {
        let model = contents.file.model();
        let amplitude = contents.settings.amplitude.unwrap_or_default();
        let tick_rate = contents.settings.tick_rate;
        let law = model
            .augmented::<f64>(amplitude, 1.0 / tick_rate)
            .map_err(|error| {
                Refusal::new("tick_rate", tick_rate, error, "export the model at another")
            })?;
        let variables: BTreeMap<_, _> = variables::variables(&contents)?
            .into_iter()
            .map(|each| (each.reference, each))
            .collect();
        let state = Self::at_start(&variables, &law, amplitude);
        Ok(Self {
            contents,
            variables,
            model,
            law,
            law_amplitude: amplitude,
            state,
            saved: BTreeMap::new(),
            next_saved: 1,
            has_left_range: false,
        })
    }

    fn at_start(
        variables: &BTreeMap<ValueReference, Variable>,
        law: &AugmentedLaw<f64, MAX_EFFECTS>,
        amplitude: f64,
    ) -> State {
        let mut inputs = [0.0; INPUTS];
        for (reference, variable) in variables {
            if let (Kind::Input(start), Some(place)) = (&variable.kind, place(*reference)) {
                inputs[place] = *start;
            }
        }
        State {
            phase: Phase::Instantiated,
            is_set_up: false,
            start: 0.0,
            stop: None,
            ticks: 0,
            inputs,
            slopes: [[0.0; 2]; INPUTS],
            amplitude,
            force: 0.0,
            is_within: true,
            law: law.at_rest(),
        }
    }

    /// What it was made of.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// What was called last of what is called in order.
    pub fn phase(&self) -> Phase {
        self.state.phase
    }

    /// Whether the motion left the operating range since this was asked last.
    pub fn take_left_range(&mut self) -> bool {
        std::mem::take(&mut self.has_left_range)
    }

    fn expect(&self, function: &str, phases: &[Phase]) -> Result<(), Refusal> {
        if phases.contains(&self.state.phase) {
            return Ok(());
        }
        let remedy = match self.state.phase {
            Phase::Instantiated => {
                "call fmi2EnterInitializationMode and fmi2ExitInitializationMode first"
            }
            Phase::Initialization => "call fmi2ExitInitializationMode first",
            Phase::Stepping => "call it before the first step, or fmi2Reset first",
            Phase::Terminated => "call fmi2Reset first",
        };
        Err(Refusal::new(
            function,
            format_args!("called when {:?}", self.state.phase),
            "out of order",
            remedy,
        ))
    }

    /// `fmi2SetupExperiment`: times in s.
    ///
    /// # Errors
    /// Called later, a time that is no number, or a stop before the start.
    pub fn set_up(&mut self, start: f64, stop: Option<f64>) -> Result<(), Refusal> {
        self.expect("fmi2SetupExperiment", &[Phase::Instantiated])?;
        let start = finite("startTime", start)?;
        if let Some(stop) = stop {
            finite("stopTime", stop)?;
            if stop < start {
                return Err(Refusal::new(
                    "stopTime",
                    stop,
                    format_args!("before the start at {start} s"),
                    "give one after it",
                ));
            }
        }
        self.state.start = start;
        self.state.stop = stop;
        self.state.is_set_up = true;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`
    ///
    /// # Errors
    /// Called out of order.
    pub fn enter_initialization(&mut self) -> Result<(), Refusal> {
        let function = "fmi2EnterInitializationMode";
        self.expect(function, &[Phase::Instantiated])?;
        if !self.state.is_set_up {
            return Err(Refusal::new(
                function,
                "called when Instantiated",
                "the start time is not known",
                "call fmi2SetupExperiment first",
            ));
        }
        self.state.phase = Phase::Initialization;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`: the first tick, of the inputs as they are.
    ///
    /// # Errors
    /// Called out of order.
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.expect("fmi2ExitInitializationMode", &[Phase::Initialization])?;
        self.take_amplitude()?;
        self.tick(0.0);
        self.state.phase = Phase::Stepping;
        Ok(())
    }

    /// `fmi2Terminate`
    ///
    /// # Errors
    /// Called out of order.
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.expect("fmi2Terminate", &[Phase::Stepping])?;
        self.state.phase = Phase::Terminated;
        Ok(())
    }

    /// `fmi2Reset`: as it was instantiated. Saved states stay.
    pub fn reset(&mut self) {
        let amplitude = self.contents.settings.amplitude.unwrap_or_default();
        self.state = Self::at_start(&self.variables, &self.law, amplitude);
        self.has_left_range = false;
    }

    /// s
    pub fn time(&self) -> f64 {
        self.state.start + self.state.ticks as f64 / self.contents.settings.tick_rate
    }

    /// `fmi2DoStep` from `point` by `size`, both in s.
    ///
    /// # Errors
    /// Called out of order, a point that is not where the last step ended, or a size that is no whole number of ticks.
    pub fn step(&mut self, point: f64, size: f64) -> Result<(), Refusal> {
        self.expect("fmi2DoStep", &[Phase::Stepping])?;
        finite("currentCommunicationPoint", point)?;
        finite("communicationStepSize", size)?;
        let rate = self.contents.settings.tick_rate;
        let now = self.time();
        if (point - now).abs() * rate > ROUNDED {
            return Err(Refusal::new(
                "currentCommunicationPoint",
                format_args!("{point} s"),
                format_args!("the last step ended at {now} s"),
                "give that, or restore a state of the other time",
            ));
        }
        let ticks = (now + size - self.state.start) * rate - self.state.ticks as f64;
        let whole = ticks.round();
        let refused = |problem: String, remedy: &str| {
            Err(Refusal::new(
                "communicationStepSize",
                format_args!("{size} s"),
                problem,
                remedy,
            ))
        };
        if whole < 1.0 || (ticks - whole).abs() > ROUNDED {
            return refused(
                format!(
                    "{ticks} ticks of {} s, and a step is a whole number of them, 1 or more",
                    1.0 / rate
                ),
                "give a multiple of the tick, or export the model with another --tick-rate",
            );
        }
        if whole > MOST_TICKS {
            return refused(
                format!("{ticks} ticks, and a step has {MOST_TICKS} at most"),
                "give shorter steps",
            );
        }
        if let Some(stop) = self.state.stop
            && (now + size - stop) * rate > ROUNDED
        {
            return refused(
                format!(
                    "it ends at {} s, after the stop time of {stop} s",
                    now + size
                ),
                "end there, or give a later stopTime to fmi2SetupExperiment",
            );
        }
        self.take_amplitude()?;
        for tick in 1..=whole as u64 {
            self.tick(tick as f64 / rate);
        }
        self.state.ticks += whole as u64;
        self.state.slopes = [[0.0; 2]; INPUTS];
        Ok(())
    }

    /// The law at the amplitude that is set, where that is another than its own.
    fn law_at_amplitude(&self) -> Result<Option<Law<f64>>, Refusal> {
        let amplitude = self.state.amplitude;
        if amplitude == self.law_amplitude {
            return Ok(None);
        }
        let law = self.model.law_at(amplitude).map_err(|error| {
            Refusal::new("amplitude", amplitude / MM_PER_M, error, "give another")
        })?;
        Ok(Some(law))
    }

    /// Puts the law at the amplitude that is set.
    fn take_amplitude(&mut self) -> Result<(), Refusal> {
        if let Some(law) = self.law_at_amplitude()? {
            self.law.set_law(law);
            self.law_amplitude = self.state.amplitude;
        }
        Ok(())
    }

    /// Evaluates the law `after` s from where the inputs were set.
    fn tick(&mut self, after: f64) {
        let was_within = self.state.is_within;
        evaluate(
            &self.law,
            &self.contents.file.fitted_range(),
            &mut self.state,
            after,
        );
        self.has_left_range |= was_within && !self.state.is_within;
    }

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

    /// Force in kN and range of the tick at the start, of the inputs as they are: while it is initialized they may still change.
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
    /// Called out of order, or no real variable.
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
    /// Called out of order, or no Boolean variable.
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
    /// Called out of order, or no text.
    pub fn text(&self, reference: ValueReference) -> Result<&str, Refusal> {
        self.expect_readable("fmi2GetString")?;
        let variable = self.variable(reference)?;
        match &variable.kind {
            Kind::Text(text) => Ok(text),
            _ => Err(not_of(variable, "fmi2GetString")),
        }
    }

    /// That no variable is of the type of `function`, which was asked for this one.
    pub fn none_of_type(&self, function: &str, reference: ValueReference) -> Refusal {
        match self.variable(reference) {
            Ok(variable) => not_of(variable, function),
            Err(unknown) => unknown,
        }
    }

    /// `fmi2SetReal`: all of the values, or none.
    ///
    /// # Errors
    /// Called out of order, a variable that is not to be set, or a value that it may not have.
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
    /// Called out of order, a variable that is no input, an order that is neither 1 nor 2, a value that is no number.
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

    /// `fmi2GetFMUstate`: its number, that of `over` where such a one is saved.
    ///
    /// # Errors
    /// `over` is no saved state.
    pub fn save(&mut self, over: usize) -> Result<usize, Refusal> {
        if over != 0 {
            *self.saved_mut(over)? = self.state.clone();
            return Ok(over);
        }
        Ok(self.keep(self.state.clone()))
    }

    fn keep(&mut self, state: State) -> usize {
        let number = self.next_saved;
        self.next_saved += 1;
        self.saved.insert(number, Box::new(state));
        number
    }

    fn unknown_state(number: usize) -> Refusal {
        Refusal::new(
            "FMUstate",
            number,
            "no state that this instance saved, or one that was freed",
            "give one of fmi2GetFMUstate or fmi2DeSerializeFMUstate",
        )
    }

    fn saved_mut(&mut self, number: usize) -> Result<&mut State, Refusal> {
        match self.saved.get_mut(&number) {
            Some(state) => Ok(state),
            None => Err(Self::unknown_state(number)),
        }
    }

    /// `fmi2SetFMUstate`
    ///
    /// # Errors
    /// No saved state.
    pub fn restore(&mut self, number: usize) -> Result<(), Refusal> {
        self.state = self.saved_mut(number)?.clone();
        Ok(())
    }

    /// `fmi2FreeFMUstate`
    ///
    /// # Errors
    /// No saved state.
    pub fn free_saved(&mut self, number: usize) -> Result<(), Refusal> {
        let removed = self.saved.remove(&number);
        removed.map(drop).ok_or_else(|| Self::unknown_state(number))
    }

    /// The bytes of a saved state.
    ///
    /// # Errors
    /// No saved state.
    pub fn serialized(&mut self, number: usize) -> Result<Vec<u8>, Refusal> {
        let state = self.saved_mut(number)?.clone();
        state.to_bytes(&self.contents.guid)
    }

    /// Keeps a state of these bytes, and gives its number.
    ///
    /// # Errors
    /// As [`State::from_bytes`].
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<usize, Refusal> {
        let state = State::from_bytes(bytes, &self.contents.guid)?;
        Ok(self.keep(state))
    }
}

/// Evaluates `law` on the inputs of `state`, `after` s from where they were set.
fn evaluate(
    law: &AugmentedLaw<f64, MAX_EFFECTS>,
    range: &FittedRange,
    state: &mut State,
    after: f64,
) {
    let motion = motion(state, after);
    let is_in = |[low, high]: [f64; 2], value: f64| (low..=high).contains(&value);
    state.force = law.force(&mut state.law, &motion);
    state.is_within =
        is_in(range.displacement, motion.displacement) && is_in(range.velocity, motion.velocity);
}

/// The inputs of `state`, `after` s from where they were set, in mm and s.
fn motion(state: &State, after: f64) -> Motion<f64> {
    let at = |place: usize| {
        let [first, second] = state.slopes[place];
        match [first, second] == [0.0; 2] {
            // Exactly what was set.
            true => state.inputs[place],
            false => state.inputs[place] + after * (first + 0.5 * after * second),
        }
    };
    let mut controls = [0.0; CONTROLS];
    for (place, control) in controls.iter_mut().enumerate() {
        *control = at(FIRST_CONTROL + place);
    }
    Motion {
        displacement: at(variables::DISPLACEMENT) * MM_PER_M,
        velocity: at(variables::VELOCITY) * MM_PER_M,
        acceleration: at(variables::ACCELERATION) * MM_PER_M,
        cycles: at(variables::CYCLES),
        temperature: at(variables::TEMPERATURE),
        controls,
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
