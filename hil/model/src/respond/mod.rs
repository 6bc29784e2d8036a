//! The motion of a mass on a damper, under a force or on a moving base.
//!
//! M·x″ + F(x − b, x′ − b′) = f. M is the mass that is fastened to the damper, plus the mass of the model's effect `inertia` if it
//! has one, which moves with the same end. F is the model's force without that effect. The crate computes F in f64, as it was
//! fitted.
//!
//! `docs/respond.md` says how each effect acts on the mass.
//!
//! The file `oscillator.rs` describes the time steps. [`respond`] halves the steps until the motion no longer changes.

mod energy;
mod excitation;
mod oscillator;
mod root;
mod running;
mod signal;
mod specimen;
mod sweep;

use mesh_damper::effects::CONTROLS;
use mesh_damper_output::error::{InputError, Place};

use crate::extrapolation::Extrapolation;
use crate::file::{FittedRange, model_error};
use crate::{Model, ModelError};
use energy::Work;
use oscillator::Oscillator;
use specimen::Specimen;

pub use energy::EnergyBalance;
pub use excitation::Excitation;
pub use specimen::LeftOut;
pub use sweep::{Sweep, SweepPoint, SweepRange, sweep};

/// Most steps of one run: their results take less than a gigabyte.
const MOST_STEPS: usize = 20_000_000;
/// Smallest number of steps in the shortest period of the mass on its damper in the first run: BDF2 has an error of about a percent
/// there.
const FEWEST_STEPS_PER_PERIOD: f64 = 32.0;
/// Shortest step that every effect accepts, s.
const SHORTEST_STEP: f64 = 1e-7;

/// The reason why a response cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RespondError {
    /// No motion is possible with a value.
    #[error("{field} = {value} {problem}; {remedy}")]
    Value {
        /// The field.
        field: &'static str,
        /// The value as given.
        value: f64,
        /// The error.
        problem: String,
        /// The remedy.
        remedy: &'static str,
    },
    /// The excitation cannot drive the model.
    #[error("{field}: {problem}; {remedy}")]
    Excitation {
        /// The excitation or one of its control inputs.
        field: String,
        /// The error.
        problem: String,
        /// The remedy.
        remedy: &'static str,
    },
    /// The model cannot be built.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No velocity balances the forces: a stiffness drives the motion.
    #[error(
        "no velocity below 1e6 mm/s balances the forces at {time} s; check the model's stiffness, the mass and the unit of the force"
    )]
    NoBalance {
        /// s since the start.
        time: f64,
    },
}

impl RespondError {
    /// The error about the model's file, or about the option that gave the value.
    pub fn about(&self, model: &str) -> InputError {
        match self {
            Self::Value {
                field,
                value,
                problem,
                remedy,
            } => {
                let problem = format!("{value} {problem}");
                if field.contains('(') {
                    return InputError::new(model, problem, *remedy)
                        .at(Place::Field((*field).into()));
                }
                // The state at the start has no option; the names of options have no blank.
                let field = match field.contains(' ') {
                    true => (*field).to_owned(),
                    false => format!("--{field}"),
                };
                InputError::new(field, problem, *remedy)
            }
            Self::Excitation {
                field,
                problem,
                remedy,
            } => InputError::new(field.as_str(), problem.as_str(), *remedy),
            Self::Model(error) => model_error(model, error),
            Self::NoBalance { time } => InputError::new(
                model,
                format!("no velocity below 1e6 mm/s balances the forces at {time:.4} s"),
                "check the model's stiffness, the mass and the unit of the force",
            ),
        }
    }
}

/// The state of mass and damper at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Of the mass, mm.
    pub displacement: f64,
    /// Of the mass, mm/s.
    pub velocity: f64,
    /// Of the mass, mm/s².
    pub acceleration: f64,
    /// Displacement of the mass relative to the base, mm: the damper's displacement channel would show it.
    pub relative_displacement: f64,
    /// Its rate, mm/s.
    pub relative_velocity: f64,
    /// The reading of the damper's force channel, kN, including the inertia of the model's own mass.
    pub force: f64,
    /// The force without that inertia, kN.
    damper: f64,
    /// Of the force and of the base, kN·mm/s.
    input_power: f64,
    /// Into the damper, kN·mm/s.
    damper_power: f64,
}

/// The conditions in addition to model and excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Mass on the damper, kg, 0…1e6; may be 0 if the model has its own mass.
    pub mass: f64,
    /// Whether the model's constant force acts on the mass.
    pub offset: bool,
    /// Steps are halved until displacements change by less than this fraction of their RMS.
    pub tolerance: f64,
    /// Displacement from the base in mm and velocity in mm/s at the start.
    pub start: [f64; 2],
    /// Control inputs of a sweep, by their index in the model.
    pub controls: [f64; CONTROLS],
}

impl Settings {
    /// A change of the displacement, after the steps are halved, that is far below the error of a model.
    pub const TOLERANCE: f64 = 1e-3;

    /// Settings for `mass` kg, starting at rest.
    pub fn new(mass: f64) -> Self {
        Self {
            mass,
            offset: false,
            tolerance: Self::TOLERANCE,
            start: [0.0; 2],
            controls: [0.0; CONTROLS],
        }
    }
}

/// The motion of the mass.
#[derive(Clone, Debug)]
pub struct Response {
    /// Time between two moments, s: that of the excitation's samples.
    pub tick: f64,
    /// The motion at the excitation's samples.
    pub moments: Vec<Moment>,
    /// The integration step, s.
    pub step: f64,
    /// Steps between two moments.
    pub substeps: usize,
    /// Change of the displacements when the steps were last halved, RMS over RMS. The error of the steps is about a third of it.
    pub change: f64,
    /// Whether that change is within the tolerance.
    pub settled: bool,
    /// The energy balance.
    pub energy: EnergyBalance,
    /// Mass of the model's own effect `inertia`, kg.
    pub model_mass: f64,
    /// Effects that act on the mass differently than in a prediction.
    pub left_out: Vec<LeftOut>,
}

impl Response {
    /// The part of the damper's motion outside the operating range of its model.
    pub fn extrapolation(&self, range: &FittedRange) -> Extrapolation {
        let of = |channel: fn(&Moment) -> &f64| self.moments.iter().map(channel);
        Extrapolation::of(
            range,
            of(|moment| &moment.relative_displacement),
            of(|moment| &moment.relative_velocity),
        )
    }
}

/// The motion of a mass on the damper of `model` under `excitation`.
///
/// # Errors
/// No motion is possible with the excitation, mass, tolerance or start; an effect cannot be integrated; the crate refuses the
/// model; or no velocity balances the forces.
pub fn respond(
    model: &Model,
    excitation: &Excitation,
    settings: &Settings,
) -> Result<Response, RespondError> {
    settings.check()?;
    excitation.check(model)?;
    let specimen = Specimen::new(model, settings.mass, settings.offset)?;
    let tick = excitation.tick();
    let most = (MOST_STEPS / excitation.len().max(1)).min((tick / SHORTEST_STEP) as usize);
    let wanted = tick * specimen.fastest() * FEWEST_STEPS_PER_PERIOD / std::f64::consts::TAU;
    let mut substeps = (wanted.ceil().max(1.0) as usize).min((most / 2).max(1));
    let mut coarse = integrate(&specimen, excitation, settings, substeps)?.0;
    loop {
        substeps *= 2;
        let (moments, energy) = integrate(&specimen, excitation, settings, substeps)?;
        let change = change_between(&coarse, &moments);
        let settled = change <= settings.tolerance;
        if settled || 2 * substeps > most {
            return Ok(Response {
                tick,
                moments,
                step: tick / substeps as f64,
                substeps,
                change,
                settled,
                energy,
                model_mass: specimen.model_mass,
                left_out: specimen.left_out,
            });
        }
        coarse = moments;
    }
}

/// As [`respond`], with `substeps` steps per tick of the excitation, whatever their error.
///
/// # Errors
/// As [`respond`].
pub fn respond_in_steps(
    model: &Model,
    excitation: &Excitation,
    settings: &Settings,
    substeps: usize,
) -> Result<(Vec<Moment>, EnergyBalance), RespondError> {
    settings.check()?;
    excitation.check(model)?;
    let specimen = Specimen::new(model, settings.mass, settings.offset)?;
    integrate(&specimen, excitation, settings, substeps.max(1))
}

impl Settings {
    fn check(&self) -> Result<(), RespondError> {
        let values = [
            ("tolerance", self.tolerance, 1e-12, 1.0, ""),
            ("start displacement", self.start[0], -1e4, 1e4, " mm"),
            ("start velocity", self.start[1], -1e6, 1e6, " mm/s"),
        ];
        for (field, value, low, high, unit) in values {
            if !(low..=high).contains(&value) {
                return Err(RespondError::Value {
                    field,
                    value,
                    problem: format!("is outside {low}…{high}{unit}"),
                    remedy: "give a value within this range",
                });
            }
        }
        Ok(())
    }
}

fn integrate(
    specimen: &Specimen,
    excitation: &Excitation,
    settings: &Settings,
    substeps: usize,
) -> Result<(Vec<Moment>, EnergyBalance), RespondError> {
    let inputs = excitation.refined(substeps);
    let step = excitation.tick() / substeps as f64;
    let (mut oscillator, first) = Oscillator::new(
        specimen,
        step,
        settings.start,
        (&inputs.at(0), inputs.base_velocity()),
    )?;
    let amplitude = oscillator.amplitude();
    let mut work = Work::from(first);
    let mut moments = vec![first];
    for index in 1..inputs.len() {
        let now = oscillator.step(&inputs.at(index))?;
        work.add(now, step);
        if index % substeps == 0 {
            moments.push(now);
        }
    }
    let energy = work.balance(specimen, [amplitude, oscillator.amplitude()])?;
    Ok((moments, energy))
}

/// RMS of the change of the displacements over their RMS: the larger of the mass's and the damper's.
fn change_between(coarse: &[Moment], fine: &[Moment]) -> f64 {
    let of = |channel: fn(&Moment) -> f64| {
        let (mut change, mut size) = (0.0, 0.0);
        for (coarse, fine) in coarse.iter().zip(fine) {
            change += (channel(fine) - channel(coarse)).powi(2);
            size += channel(fine).powi(2);
        }
        if change > 0.0 {
            (change / size).sqrt()
        } else {
            0.0
        }
    };
    of(|moment| moment.displacement).max(of(|moment| moment.relative_displacement))
}
