//! The excitation of the mass, at equal time steps.

use mesh_damper::effects::CONTROLS;
use mesh_damper_recording::trajectory::TrajectoryPolicy;

use super::RespondError;
use super::oscillator::Input;
use super::signal::refined;
use crate::Model;

/// A force on the mass or a motion of the base, with temperature and control inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Excitation {
    tick: f64,
    drive: Drive,
    /// °C, one per sample, if known.
    temperature: Option<Vec<f64>>,
    /// Control inputs by index, each with a value per sample.
    controls: Vec<Vec<f64>>,
}

#[derive(Clone, Debug, PartialEq)]
enum Drive {
    /// kN
    Force(Vec<f64>),
    /// mm
    Base(Vec<f64>),
}

impl Excitation {
    /// A force on the mass in kN, sampled every `tick` s.
    pub fn force(tick: f64, force: Vec<f64>) -> Self {
        Self::new(tick, Drive::Force(force))
    }

    /// The displacement of the base in mm, sampled every `tick` s.
    pub fn base(tick: f64, displacement: Vec<f64>) -> Self {
        Self::new(tick, Drive::Base(displacement))
    }

    fn new(tick: f64, drive: Drive) -> Self {
        Self {
            tick,
            drive,
            temperature: None,
            controls: Vec::new(),
        }
    }

    /// Adds the damper's temperature in °C at every sample. Without it, room temperature applies.
    #[must_use]
    pub fn with_temperature(mut self, temperature: Option<Vec<f64>>) -> Self {
        self.temperature = temperature;
        self
    }

    /// Adds control inputs of the damper, by their index in the model, with a value at every sample. Without them, they are 0.
    #[must_use]
    pub fn with_controls(mut self, controls: Vec<Vec<f64>>) -> Self {
        self.controls = controls;
        self
    }

    /// Time between samples, s.
    pub fn tick(&self) -> f64 {
        self.tick
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        match &self.drive {
            Drive::Force(samples) | Drive::Base(samples) => samples.len(),
        }
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// # Errors
    /// Fewer than two samples, a tick outside the limits of the effects, a sample that is not finite, or too few control inputs for
    /// the model.
    pub(super) fn check(&self, model: &Model) -> Result<(), RespondError> {
        let (Drive::Force(samples) | Drive::Base(samples)) = &self.drive;
        let wrong = |field: String, problem: String, remedy| {
            Err(RespondError::Excitation {
                field,
                problem,
                remedy,
            })
        };
        let control = |place: usize| match model.controls.get(place) {
            Some(control) => format!("control input {}", control.name),
            None => format!("control input {place}"),
        };
        if samples.len() < 2 {
            return wrong(
                "excitation".into(),
                format!("has {} samples", samples.len()),
                "give at least 2",
            );
        }
        if !(1e-6..=1e3).contains(&self.tick) {
            return wrong(
                "tick".into(),
                format!("{} s is outside 1e-6…1000 s", self.tick),
                "give the time between samples in s",
            );
        }
        let (given, needed) = (self.controls.len(), model.controls.len());
        if given < needed {
            return wrong(
                "excitation".into(),
                format!("{given} control inputs are given, the model needs {needed}"),
                "give each with --control NAME=VALUE or a column",
            );
        }
        for (place, values) in self.controls.iter().enumerate() {
            if values.len() != samples.len() {
                return wrong(
                    control(place),
                    format!(
                        "{} samples, the excitation has {}",
                        values.len(),
                        samples.len()
                    ),
                    "give one per sample",
                );
            }
        }
        let controls = self.controls.iter().enumerate();
        let controls = controls.map(|(place, values)| (control(place), values));
        for (field, values) in std::iter::once(("excitation".to_owned(), samples)).chain(controls) {
            let mut values = values.iter().enumerate();
            if let Some((index, value)) = values.find(|(_, value)| !value.is_finite()) {
                return wrong(
                    field,
                    format!("sample {index} (counted from 0) is {value}, which is not finite"),
                    "correct the sample",
                );
            }
        }
        Ok(())
    }

    /// With `substeps` steps between each two samples.
    pub(super) fn refined(&self, substeps: usize) -> Refined<'_> {
        let (Drive::Force(samples) | Drive::Base(samples)) = &self.drive;
        Refined {
            excitation: self,
            values: refined(samples, substeps),
            substeps,
        }
    }
}

/// An excitation at the steps of an integration.
pub(super) struct Refined<'e> {
    excitation: &'e Excitation,
    values: Vec<f64>,
    substeps: usize,
}

impl Refined<'_> {
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Velocity of the base at the start, mm/s.
    pub fn base_velocity(&self) -> f64 {
        match (&self.excitation.drive, self.values.as_slice()) {
            (Drive::Base(_), [first, second, ..]) => {
                (second - first) * self.substeps as f64 / self.excitation.tick
            }
            _ => 0.0,
        }
    }

    pub fn at(&self, index: usize) -> Input {
        let temperature = match &self.excitation.temperature {
            Some(samples) => samples.get(index / self.substeps).copied(),
            None => None,
        };
        let temperature = temperature.unwrap_or(TrajectoryPolicy::in_use().room);
        let mut controls = [0.0; CONTROLS];
        for (control, samples) in controls.iter_mut().zip(&self.excitation.controls) {
            *control = samples
                .get(index / self.substeps)
                .copied()
                .unwrap_or_default();
        }
        let value = self.values[index];
        let (force, base) = match self.excitation.drive {
            Drive::Force(_) => (value, 0.0),
            Drive::Base(_) => (0.0, value),
        };
        Input {
            force,
            base,
            temperature,
            controls,
        }
    }
}
