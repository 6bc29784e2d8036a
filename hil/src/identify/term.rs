//! How each effect enters a fit: what is linear in it, what is not, and where the search starts.

use std::collections::BTreeMap;

use mesh_damper::effects::{
    Asymmetry, Drift, EffectForce, Hardening, Inertia, MAX_STICK_SLIP_ELEMENTS, Offset, Relaxation,
    StickSlip, Viscous,
};
use mesh_damper::error::ConfigError;

use crate::model::{AddedEffect, Family};
use crate::predict::motion_at;
use crate::recording::trajectory::Trajectory;

/// One added effect in a fit.
///
/// All but temperature add a force that is proportional to one parameter, the size; what else they have is a shape, a
/// positive number that is searched on a logarithmic scale. Temperature scales the law's own force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Which effect.
    pub family: Family,
    /// The temperature at which the law holds, °C; used by temperature only.
    pub reference: f64,
}

/// Range and starts of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Where a search starts, spread over what the data can show.
    pub starts: Vec<f64>,
}

impl Term {
    /// The name of the parameter that the force is proportional to, or `None` where there is none.
    pub fn size_name(&self) -> Option<&'static str> {
        match self.family {
            Family::Offset => Some("force"),
            Family::Asymmetry => Some("k2"),
            Family::Hardening => Some("k5"),
            Family::Viscous => Some("c1"),
            Family::Inertia => Some("mass"),
            Family::StickSlip | Family::Relaxation | Family::Drift => Some("stiffness"),
            Family::Temperature => None,
        }
    }

    /// The name of the shape, or `None` where the effect has none.
    pub fn shape_name(&self) -> Option<&'static str> {
        match self.family {
            Family::StickSlip => Some("slip_limit"),
            Family::Relaxation => Some("time"),
            Family::Drift => Some("cycles"),
            _ => None,
        }
    }

    /// Whether a parameter of it is searched: a shape, or temperature's β, which scales the law.
    pub fn is_searched(&self) -> bool {
        self.shape_name().is_some() || self.family == Family::Temperature
    }

    /// Whether a negative size would be a source of energy, or a mass that pushes.
    pub fn size_is_positive(&self) -> bool {
        matches!(
            self.family,
            Family::Viscous | Family::Inertia | Family::StickSlip | Family::Relaxation
        )
    }

    /// The shape's range and starts for these data, or `None` where the effect has none.
    pub fn shape(&self, trajectories: &[Trajectory]) -> Option<Shape> {
        let amplitude = largest(
            trajectories
                .iter()
                .flat_map(|t| t.amplitude.iter().copied()),
        );
        let duration = largest(trajectories.iter().map(|t| t.len() as f64 * t.tick));
        let tick = trajectories
            .iter()
            .map(|t| t.tick)
            .fold(f64::INFINITY, f64::min);
        let noise = largest(trajectories.iter().map(|t| t.motion.noise));
        let cycles = largest(trajectories.iter().filter_map(|t| t.cycles.last().copied()));
        let (low, high, count) = match self.family {
            // A smaller slip limit than the noise shows cannot be told from an error of the velocity at a reversal, and an
            // element that hardly slips is a spring.
            Family::StickSlip => {
                let high = 0.9 * amplitude;
                ((5.0 * noise).max(1e-3 * amplitude).min(0.5 * high), high, 8)
            }
            Family::Relaxation => (0.5 * tick, duration, 8),
            Family::Drift => (0.3, 10.0 * cycles, 6),
            _ => return None,
        };
        // The outermost starts stand one step inside the range.
        let step = (high / low).powf(1.0 / (count + 1) as f64);
        let starts = (1..=count).map(|i| low * step.powi(i)).collect();
        Some(Shape { low, high, starts })
    }

    /// The force in kN of the effect with size 1 and this shape at every sample of `trajectory`.
    ///
    /// # Errors
    /// A shape that the crate refuses.
    pub fn unit_force(&self, shape: f64, trajectory: &Trajectory) -> Result<Vec<f64>, ConfigError> {
        Ok(match self.family {
            Family::Offset => run(&Offset::new(1.0)?, trajectory),
            Family::Asymmetry => run(&Asymmetry::new(1.0)?, trajectory),
            Family::Hardening => run(&Hardening::new(1.0)?, trajectory),
            Family::Viscous => run(&Viscous::new(1.0)?, trajectory),
            Family::Inertia => run(&Inertia::new(1.0)?, trajectory),
            Family::StickSlip => run(&StickSlip::new(&[(1.0, shape)])?, trajectory),
            Family::Relaxation => run(&Relaxation::new(1.0, shape, trajectory.tick)?, trajectory),
            Family::Drift => run(&Drift::new(1.0, shape)?, trajectory),
            Family::Temperature => vec![0.0; trajectory.len()],
        })
    }
}

fn run<E: EffectForce<f64>>(effect: &E, trajectory: &Trajectory) -> Vec<f64> {
    let motion = |index| motion_at(trajectory, index).confined();
    let mut state = effect.begin(&motion(0));
    (0..trajectory.len())
        .map(|index| effect.force(&mut state, &motion(index), 0.0))
        .collect()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::MIN_POSITIVE, f64::max)
}

/// A term's parameters after a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermValue {
    /// The term.
    pub term: Term,
    /// What its force is proportional to; β for temperature.
    pub size: f64,
    /// Its shape; 0 where it has none.
    pub shape: f64,
}

/// The effects that fitted terms stand for: stick-slip terms become the elements of one effect.
pub fn added_effects(values: &[TermValue]) -> Vec<AddedEffect> {
    let mut effects: Vec<AddedEffect> = Vec::new();
    for value in values {
        let family = value.term.family;
        let known = effects.iter().position(|effect| effect.family == family);
        let index = known.unwrap_or_else(|| {
            effects.push(AddedEffect {
                family,
                parameters: BTreeMap::new(),
            });
            effects.len() - 1
        });
        let parameters = &mut effects[index].parameters;
        let suffix = match known {
            None => String::new(),
            Some(_) => format!("_{}", parameters.len() / 2 + 1),
        };
        match value.term.size_name() {
            Some(size) => {
                parameters.insert(format!("{size}{suffix}"), value.size);
            }
            None => {
                parameters.insert("beta".into(), value.size);
                parameters.insert("reference".into(), value.term.reference);
            }
        }
        if let Some(shape) = value.term.shape_name() {
            parameters.insert(format!("{shape}{suffix}"), value.shape);
        }
    }
    effects
}

/// How many terms of this family one model may have.
pub fn most_terms(family: Family) -> usize {
    match family {
        Family::StickSlip => MAX_STICK_SLIP_ELEMENTS,
        _ => 1,
    }
}
