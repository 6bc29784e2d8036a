//! The fault campaign: what the rig's monitor finds of faults that are put into specimen, sensors and actuator at a moment
//! that it does not know, what it calls them, and how often it cries wolf.

mod damage;
mod healthy;
mod kind;
mod requirement;
mod summary;
mod trial;

use rayon::iter::{IndexedParallelIterator as _, IntoParallelIterator as _, ParallelIterator as _};

pub use damage::{Condition, Damaged};
pub use healthy::{Healthy, run_healthy};
pub use kind::{Group, Kind};
pub use requirement::missed;
pub use summary::{KindSummary, Summary};
pub use trial::{Outcome, Trial, run_trial};

use crate::link::SetupError;

/// What a campaign is made of.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Kinds of faults.
    pub kinds: Vec<Kind>,
    /// Density in g/cm³, amplitude in mm, frequency in Hz.
    pub specimens: Vec<(f64, f64, f64)>,
    /// RMS of the force channel's noise over that of the force.
    pub noises: Vec<f64>,
    /// Parts of the cycle at which faults begin.
    pub moments: Vec<f64>,
    /// Healthy cycles, spread over the specimens.
    pub healthy_cycles: u32,
}

impl Campaign {
    /// All of it: every kind in every size on four specimens at three levels of noise, and 1e5 healthy cycles.
    pub fn whole() -> Self {
        Self {
            kinds: Kind::ALL.into(),
            specimens: vec![
                (2.0, 0.05, 5.0),
                (2.5, 0.2, 2.0),
                (3.0, 0.1, 10.0),
                (4.0, 0.25, 5.0),
            ],
            noises: vec![0.002, 0.005, 0.01],
            moments: vec![0.05, 0.3, 0.55, 0.8],
            healthy_cycles: 100_000,
        }
    }

    /// A part of it, at the largest noise.
    pub fn part() -> Self {
        Self {
            specimens: vec![(2.0, 0.05, 10.0), (3.0, 0.1, 10.0), (4.0, 0.25, 10.0)],
            noises: vec![0.01],
            moments: vec![0.3, 0.8],
            healthy_cycles: 6_000,
            ..Self::whole()
        }
    }

    /// Every trial of it, numbered by its seed.
    pub fn trials(&self) -> Vec<Trial> {
        let mut all = Vec::new();
        for &kind in &self.kinds {
            for &size in kind.sizes() {
                for &(density, amplitude, frequency) in &self.specimens {
                    for &noise in &self.noises {
                        for &moment in &self.moments {
                            all.push(Trial {
                                kind,
                                size,
                                density,
                                amplitude,
                                frequency,
                                noise,
                                moment,
                                seed: all.len() as u64,
                            });
                        }
                    }
                }
            }
        }
        all
    }

    /// Runs it; `done` is called after each trial and after the healthy cycles of each specimen.
    ///
    /// # Errors
    /// A setup that one of its parts refuses.
    pub fn run(&self, done: &(dyn Fn() + Sync)) -> Result<Summary, SetupError> {
        let outcomes: Vec<Outcome> = self
            .trials()
            .into_par_iter()
            .map(|trial| {
                let outcome = run_trial(&trial);
                done();
                outcome
            })
            .collect::<Result<_, _>>()?;
        let loudest = self.noises.iter().copied().fold(0.0, f64::max);
        let cycles = self
            .healthy_cycles
            .div_ceil(self.specimens.len().max(1) as u32);
        let healthy: Vec<Healthy> = self
            .specimens
            .clone()
            .into_par_iter()
            .enumerate()
            .map(|(seed, (density, amplitude, _))| {
                let healthy = run_healthy(density, amplitude, loudest, cycles, seed as u64);
                done();
                healthy
            })
            .collect::<Result<_, _>>()?;
        Ok(Summary::of(outcomes, healthy))
    }

    /// How often [`Campaign::run`] calls `done`.
    pub fn steps(&self) -> u64 {
        (self.trials().len() + self.specimens.len()) as u64
    }
}
