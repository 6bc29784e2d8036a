//! A body driven by a part of its surface: compressed once, or moved as a sine until the loop repeats itself.

use std::f64::consts::TAU;

use mesh_damper_reference::turn::sin_cos_of_turn;
use serde::Serialize;

use super::FiniteElementError;
use super::body::{Body, Memory};
use super::relaxation::{Prony, Step};

/// Most cycles until a loop has to repeat itself.
const MOST_CYCLES: usize = 8;

/// A loop repeats itself if no force differs from the cycle before by more than this fraction of the largest. The remaining change
/// is smaller than that: it falls to a half or less from cycle to cycle.
const REPEATED: f64 = 5e-3;

/// A body and its drive.
pub(super) struct Drive {
    pub body: Body,
    /// The degrees of freedom that are moved together. All other prescribed ones stay where they are.
    pub moved: Vec<usize>,
    /// Reported force for 1 N on the moved degrees of freedom.
    pub force_scale: f64,
}

/// Force over displacement of a continuing compression.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StaticCurve {
    /// Displacement, mm, from 0.
    pub displacement: Vec<f64>,
    /// Force, kN.
    pub force: Vec<f64>,
}

/// One cycle of a sine that begins at y = 0, in equal time steps. The last sample is at the end of the cycle.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceLoop {
    /// Displacement, mm.
    pub displacement: Vec<f64>,
    /// Velocity, mm/s.
    pub velocity: Vec<f64>,
    /// Force, kN.
    pub force: Vec<f64>,
    /// Number of the cycle from rest, from 1.
    pub cycle: usize,
    /// Largest difference of the force from the cycle before, as a fraction of the largest force; 1 for the first cycle.
    pub change: f64,
}

/// The state of a body, and its state one step earlier; mm, for each degree of freedom.
struct At {
    displacements: Vec<f64>,
    before: Vec<f64>,
}

impl At {
    fn rest(body: &Body) -> Self {
        Self {
            displacements: body.undeformed(),
            before: body.undeformed(),
        }
    }
}

/// A sine motion that drives a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrivenSine {
    /// mm
    pub amplitude: f64,
    /// Hz
    pub frequency: f64,
    /// In a cycle.
    pub steps: usize,
}

/// A drive during the cycles of a sine.
pub(super) struct Cycles<'a> {
    drive: &'a Drive,
    motion: DrivenSine,
    at: At,
    memory: Memory,
    before: Vec<f64>,
    done: usize,
}

impl Drive {
    /// Displacements of the body compressed to `largest` mm in `points` equal steps.
    ///
    /// # Errors
    /// As [`Drive::static_curve`].
    #[cfg(test)]
    pub fn displaced(&self, largest: f64, points: usize) -> Result<Vec<f64>, FiniteElementError> {
        let mut at = At::rest(&self.body);
        for point in 1..=points {
            self.put(&mut at, largest * point as f64 / points as f64);
            self.body.rest(&mut at.displacements, None)?;
        }
        Ok(at.displacements)
    }

    /// Compresses the body to `largest` mm in `points` equal steps, without relaxation.
    ///
    /// # Errors
    /// No equilibrium is found.
    pub fn static_curve(
        &self,
        largest: f64,
        points: usize,
    ) -> Result<StaticCurve, FiniteElementError> {
        let mut at = At::rest(&self.body);
        let mut curve = StaticCurve {
            displacement: vec![0.0],
            force: vec![0.0],
        };
        for point in 1..=points {
            let displacement = largest * point as f64 / points as f64;
            self.put(&mut at, displacement);
            let forces = self.body.rest(&mut at.displacements, None)?;
            curve.displacement.push(displacement);
            curve.force.push(self.force(&forces));
        }
        Ok(curve)
    }

    /// The loops of successive cycles of `motion`, for a body that was at rest before and whose shear relaxes according to `prony`.
    pub fn cycles(&self, prony: Prony, motion: DrivenSine) -> Cycles<'_> {
        Cycles {
            drive: self,
            motion,
            at: At::rest(&self.body),
            memory: Memory::new(&self.body, prony),
            before: vec![0.0; motion.steps],
            done: 0,
        }
    }

    /// Moves the driven part to `displacement` mm, and continues the motion of the rest as an estimate of its equilibrium.
    fn put(&self, at: &mut At, displacement: f64) {
        for (now, before) in at.displacements.iter_mut().zip(&mut at.before) {
            let on = 2.0 * *now - *before;
            *before = *now;
            *now = on;
        }
        self.moved
            .iter()
            .for_each(|&unknown| at.displacements[unknown] = displacement);
    }

    fn force(&self, forces: &[f64]) -> f64 {
        self.force_scale
            * self
                .moved
                .iter()
                .map(|&unknown| forces[unknown])
                .sum::<f64>()
    }
}

impl Cycles<'_> {
    /// The loop of the next cycle.
    ///
    /// # Errors
    /// No equilibrium is found.
    pub fn next(&mut self) -> Result<ForceLoop, FiniteElementError> {
        let DrivenSine {
            amplitude,
            frequency,
            steps,
        } = self.motion;
        let body = &self.drive.body;
        let step = Step::new(&self.memory.prony, 1.0 / (frequency * steps as f64));
        let mut next = ForceLoop {
            displacement: vec![],
            velocity: vec![],
            force: vec![],
            cycle: self.done + 1,
            change: 0.0,
        };
        for n in 1..=steps {
            let (sin, cos) = sin_cos_of_turn(n as u64, steps as u64);
            self.drive.put(&mut self.at, amplitude * sin);
            let forces = body.rest(&mut self.at.displacements, Some((&self.memory, &step)))?;
            body.advance(&self.at.displacements, &mut self.memory, &step)?;
            next.displacement.push(amplitude * sin);
            next.velocity.push(amplitude * TAU * frequency * cos);
            next.force.push(self.drive.force(&forces));
        }
        let largest = next
            .force
            .iter()
            .fold(0.0_f64, |largest, f| largest.max(f.abs()));
        let pairs = next.force.iter().zip(&self.before);
        next.change = pairs.fold(0.0_f64, |most, (f, g)| most.max((f - g).abs())) / largest;
        self.before.clone_from(&next.force);
        self.done += 1;
        Ok(next)
    }

    /// The loop once it repeats itself. After each cycle the histories are set to their values after infinitely many such cycles.
    ///
    /// # Errors
    /// No equilibrium is found, or the loop still changes after the most cycles.
    pub fn steady(mut self) -> Result<ForceLoop, FiniteElementError> {
        for _ in 0..MOST_CYCLES {
            let start = self.memory.clone();
            let next = self.next()?;
            if next.change <= REPEATED {
                return Ok(next);
            }
            self.memory.repeat(&start, 1.0 / self.motion.frequency);
        }
        Err(FiniteElementError::NotSteady)
    }
}
