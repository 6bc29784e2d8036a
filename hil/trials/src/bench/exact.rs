//! The counted motion in f64, without code from the crate.

use std::f64::consts::TAU;

use mesh_damper_reference::dynamic_test;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::turn::sin_cos_of_turn;

use mesh_damper_firmware::bench::suite::tick::{FREQUENCY, TICK_RATE};

/// Cycles of a tick as a fraction of whole numbers.
const STEP: u64 = (10.0 * FREQUENCY) as u64;
const TURN: u64 = (10.0 * TICK_RATE) as u64;

/// A steady sine from phase 0 at tick 0, and the force of eq 13 over it.
#[derive(Clone, Copy, Debug)]
pub struct Exact {
    /// Eq 13.
    pub law: Coefficients,
    /// mm
    pub amplitude: f64,
}

/// The results of a cycle.
#[derive(Clone, Copy, Debug)]
pub struct ExactCycle {
    /// K, kN/mm.
    pub stiffness: f64,
    /// ΔW = ∮F dy, J.
    pub energy: f64,
    /// η.
    pub loss_factor: f64,
}

impl ExactCycle {
    /// K, ΔW and η.
    pub fn parts(&self) -> [f64; 3] {
        [self.stiffness, self.energy, self.loss_factor]
    }
}

impl Exact {
    /// Displacement in mm and force in kN at tick `n`.
    pub fn sample(&self, n: u64) -> (f64, f64) {
        let (sin, cos) = sin_cos_of_turn(n * STEP, TURN);
        let y = self.amplitude * sin;
        let speed = self.amplitude * TAU * FREQUENCY;
        (y, self.law.force(y, speed * cos))
    }

    /// Cycle `index`, from 0, by the crate's definition: trapezoids from sample to sample, and linear interpolation of both
    /// channels where the cycle begins and ends within a tick.
    pub fn cycle(&self, index: u64) -> ExactCycle {
        let first = |cycle: u64| (cycle * TURN).div_ceil(STEP);
        let (begin, end) = (first(index), first(index + 1));
        let points: Vec<(f64, f64)> = [self.boundary(index)]
            .into_iter()
            .chain((begin..end).map(|n| self.sample(n)))
            .chain([self.boundary(index + 1)])
            .collect();
        let (displacement, force): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        let [y_range, f_range] = [&displacement, &force].map(|values| {
            let most = values.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v));
            let least = values.iter().fold(f64::INFINITY, |m, v| m.min(*v));
            (most, least)
        });
        let amplitude = 0.5 * (y_range.0 - y_range.1);
        let stiffness = dynamic_test::stiffness(f_range.0, f_range.1, amplitude);
        let energy = dynamic_test::loop_area(&displacement, &force);
        let elastic = dynamic_test::elastic_potential(stiffness, amplitude);
        ExactCycle {
            stiffness,
            energy,
            loss_factor: dynamic_test::loss_factor(energy, elastic),
        }
    }

    /// Cycle `index` as defined by [`mesh_damper::simulation`]: the largest force of its ticks, and the energy of the sine itself,
    /// not of its chords.
    pub fn demanded_cycle(&self, index: u64) -> ExactCycle {
        const NODES: u64 = 50_000;
        let first = |cycle: u64| (cycle * TURN).div_ceil(STEP);
        let largest = (first(index)..first(index + 1))
            .map(|n| self.sample(n).1)
            .fold(0.0, f64::max);
        let speed = self.amplitude * TAU * FREQUENCY;
        let sum: f64 = (0..NODES)
            .map(|n| {
                let (sin, cos) = sin_cos_of_turn(n, NODES);
                self.law.force(self.amplitude * sin, speed * cos) * cos
            })
            .sum();
        let energy = self.amplitude * TAU / NODES as f64 * sum;
        let stiffness = largest / self.amplitude;
        let elastic = dynamic_test::elastic_potential(stiffness, self.amplitude);
        ExactCycle {
            stiffness,
            energy,
            loss_factor: dynamic_test::loss_factor(energy, elastic),
        }
    }

    /// Start of cycle `index`.
    fn boundary(&self, index: u64) -> (f64, f64) {
        let after = (index * TURN).div_ceil(STEP);
        let beyond = (after * STEP - index * TURN) as f64 / STEP as f64;
        if after == 0 {
            return self.sample(0);
        }
        let ((y0, f0), (y1, f1)) = (self.sample(after - 1), self.sample(after));
        (y1 + beyond * (y0 - y1), f1 + beyond * (f0 - f1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without friction a loop has no area, and with a dashpot π·c·ω·X0² and η = c·ω/k.
    #[test]
    fn a_cycle_has_its_closed_form() {
        let mut exact = Exact {
            law: Coefficients::new(2.0, 0.0, 0.0, 1.0),
            amplitude: 0.1,
        };
        assert!(exact.cycle(3).energy.abs() < 1e-8);
        assert!((exact.cycle(3).stiffness / 2.0 - 1.0).abs() < 1e-5);
        exact.law = Coefficients::new(0.0, 0.0, 0.01, 1.0);
        let omega = TAU * FREQUENCY;
        let area = std::f64::consts::PI * 0.01 * omega * 0.01;
        // Trapezoids, 1031 to the cycle.
        assert!((exact.cycle(2).energy / area - 1.0).abs() < 1e-5);
    }
}
