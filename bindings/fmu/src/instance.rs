//! An instance: the permitted order of calls, and a step.
//!
//! A refused call changes nothing, so that a master may correct it and continue.

mod evaluate;
mod saved;
mod values;

use std::collections::BTreeMap;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper_model::{MAX_EFFECTS, Model};

use crate::contents::Contents;
use crate::refusal::{Refusal, finite};
use crate::state::{Phase, State};
use crate::types::ValueReference;
use crate::variables::{self, INPUTS, Kind, MM_PER_M, Variable};
use evaluate::evaluate;

/// Newtons in a kilonewton, the unit of models.
const N_PER_KN: f64 = 1e3;
/// Largest distance of a step from whole ticks, in ticks: a step that is written with few digits.
const ROUNDED: f64 = 1e-3;
/// Roundings, in units of the last place, of the point of a step: of a master's sum and of ours, and of the difference that gives
/// its size.
const ROUNDINGS: f64 = 4.0;
/// Most ticks of one step: a day at 10 kHz.
const MOST_TICKS: f64 = 1e9;

/// One damper.
#[derive(Debug)]
pub struct Instance {
    contents: Contents,
    variables: BTreeMap<ValueReference, Variable>,
    model: Model,
    law: AugmentedLaw<f64, MAX_EFFECTS>,
    /// Present amplitude of the law, mm.
    law_amplitude: f64,
    state: State,
    saved: BTreeMap<usize, Box<State>>,
    next_saved: usize,
    has_left_range: bool,
}

/// The index of an input among the settable values.
fn place(reference: ValueReference) -> Option<usize> {
    usize::try_from(reference).ok().filter(|it| *it < INPUTS)
}

impl Instance {
    /// With its start values.
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
            reached: 0.0,
            inputs,
            slopes: [[0.0; 2]; INPUTS],
            amplitude,
            force: 0.0,
            is_within: true,
            law: law.at_rest(),
        }
    }

    /// Its contents.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// The phase in the order of calls.
    pub fn phase(&self) -> Phase {
        self.state.phase
    }

    /// Whether the motion left the operating range since the last query.
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
    /// It was called too late, a time is NaN, or the stop is before the start.
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
        self.state.reached = start;
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

    /// `fmi2ExitInitializationMode`: the first tick, with the present inputs.
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

    /// `fmi2Reset`: the state after instantiation. Saved states stay.
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
    /// Called out of order, a point other than the end of the last step, or a size that is no whole number of ticks.
    pub fn step(&mut self, point: f64, size: f64) -> Result<(), Refusal> {
        self.expect("fmi2DoStep", &[Phase::Stepping])?;
        finite("currentCommunicationPoint", point)?;
        finite("communicationStepSize", size)?;
        let rate = self.contents.settings.tick_rate;
        let reached = self.state.reached;
        // One rounding of the master's time, in ticks.
        let rounding = f64::EPSILON * point.abs().max(reached.abs()) * rate;
        let allowed = ROUNDED + ROUNDINGS * rounding;
        if (point - reached).abs() * rate > allowed {
            return Err(Refusal::new(
                "currentCommunicationPoint",
                format_args!("{point} s"),
                format_args!("the last step ended at {reached} s"),
                "give that, or restore a state of the other time",
            ));
        }
        let ticks = size * rate;
        let whole = ticks.round();
        let refused = |problem: String, remedy: &str| {
            Err(Refusal::new(
                "communicationStepSize",
                format_args!("{size} s"),
                problem,
                remedy,
            ))
        };
        if whole < 1.0 || (ticks - whole).abs() > allowed {
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
        // A master that adds up its steps makes a rounding with each, and a step has a tick at least.
        let end = self.time() + whole / rate;
        let added = ROUNDED + (self.state.ticks as f64 + whole) * rounding;
        let drift = (point + size - end) * rate;
        if drift.abs() > added {
            return refused(
                format!("with the steps before it adds up to {drift} ticks beside whole ones"),
                "give a multiple of the tick with all its digits",
            );
        }
        if let Some(stop) = self.state.stop
            && (end - stop) * rate > added
        {
            return refused(
                format!("it ends at {end} s, after the stop time of {stop} s"),
                "end there, or give a later stopTime to fmi2SetupExperiment",
            );
        }
        self.take_amplitude()?;
        for tick in 1..=whole as u64 {
            self.tick(tick as f64 / rate);
        }
        self.state.ticks += whole as u64;
        self.state.reached = point + size;
        self.state.slopes = [[0.0; 2]; INPUTS];
        Ok(())
    }

    /// The law at the set amplitude, if that differs from its present one.
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

    /// Changes the law to the set amplitude.
    fn take_amplitude(&mut self) -> Result<(), Refusal> {
        if let Some(law) = self.law_at_amplitude()? {
            self.law.set_law(law);
            self.law_amplitude = self.state.amplitude;
        }
        Ok(())
    }

    /// Evaluates the law `after` s from the time at which the inputs were set.
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
}
