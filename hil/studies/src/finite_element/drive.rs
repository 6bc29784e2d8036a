//! A body that is driven by a part of its surface: compressed once, or moved as a sine until the loop repeats itself.

use std::f64::consts::TAU;

use mesh_damper_reference::turn::sin_cos_of_turn;
use serde::Serialize;

use super::FiniteElementError;
use super::body::{Body, Memory};
use super::relaxation::{Prony, Step};

/// The most cycles until a loop has to repeat itself.
const MOST_CYCLES: usize = 8;

/// A loop repeats itself when no force differs from that of the cycle before by more than this share of the largest. What
/// still changes then takes less than that again: it falls to a half and less from cycle to cycle.
const REPEATED: f64 = 5e-3;

/// A body and what drives it.
pub(super) struct Drive {
    pub body: Body,
    /// The degrees of freedom that are moved together. All others that the body has prescribed stay where they are.
    pub moved: Vec<usize>,
    /// The force that is given, of 1 N on the degrees of freedom that are moved.
    pub force_scale: f64,
}

/// Force over displacement of a compression that goes on rising.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StaticCurve {
    /// mm, from 0.
    pub displacement: Vec<f64>,
    /// kN
    pub force: Vec<f64>,
}

/// One cycle of a sine that begins at y = 0, in equal steps of time; the last sample is at the cycle's end.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForceLoop {
    /// mm
    pub displacement: Vec<f64>,
    /// mm/s
    pub velocity: Vec<f64>,
    /// kN
    pub force: Vec<f64>,
    /// Which cycle from rest it is, from 1.
    pub cycle: usize,
    /// By how much the force differs from that of the cycle before at most, as a share of the largest; 1 of the first cycle.
    pub change: f64,
}

/// Where a body is, and where it was a step before; mm, of each degree of freedom.
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

/// A sine as a body is driven by it.
#[derive(Clone, Copy, Debug)]
pub(super) struct DrivenSine {
    /// mm
    pub amplitude: f64,
    /// Hz
    pub frequency: f64,
    /// In a cycle.
    pub steps: usize,
}

/// A drive on its way through the cycles of a sine.
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

    /// Compresses the body to `largest` mm in `points` equal steps. It does not relax.
    ///
    /// # Errors
    /// An equilibrium that is not found.
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

    /// The loops of cycle after cycle of `motion`, of a body whose shear relaxes as `prony` says and that was at rest before.
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

    /// Moves what is moved to `displacement` mm, and the rest on as it went before, near to where it will come to rest.
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
    /// An equilibrium that is not found.
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

    /// The loop once it repeats itself. After each cycle the histories go to where infinitely many like it would take them.
    ///
    /// # Errors
    /// An equilibrium that is not found, or a loop that still changes after the most cycles.
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
