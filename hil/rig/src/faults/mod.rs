//! The fault campaign: what the rig's monitor finds of faults that are put into specimen, sensors and actuator at a moment
//! that it does not know, what it calls them, and how often it cries wolf.

mod damage;
mod healthy;
mod kind;
mod requirement;
mod slow;
mod summary;
mod trial;

use rayon::iter::{IndexedParallelIterator as _, IntoParallelIterator as _, ParallelIterator as _};

pub use damage::{Condition, Damaged};
pub use healthy::{Healthy, run_healthy};
pub use kind::{Group, InjectedFault};
pub use requirement::missed;
pub use slow::{CHANGING, Changing, FOLLOW, Left, SlowChange, SlowOutcome};
pub use summary::{KindSummary, Summary};
pub use trial::{Outcome, Trial, run_trial, run_trial_with};

use crate::SetupError;

/// What a campaign is made of.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Kinds of faults.
    pub kinds: Vec<InjectedFault>,
    /// Density in g/cm³, amplitude in mm, frequency in Hz.
    pub specimens: Vec<(f64, f64, f64)>,
    /// RMS of the force channel's noise over that of the force.
    pub noises: Vec<f64>,
    /// Parts of the cycle at which faults begin: at other places in an eighth of it each, by which the actuator is watched.
    pub moments: Vec<f64>,
    /// Healthy cycles, spread over the specimens.
    pub healthy_cycles: u32,
}

impl Campaign {
    /// All of it: every kind in every size on four specimens at three levels of noise, and 1e5 healthy cycles.
    pub fn whole() -> Self {
        Self {
            kinds: InjectedFault::ALL.into(),
            specimens: vec![
                (2.0, 0.05, 5.0),
                (2.5, 0.2, 2.0),
                (3.0, 0.1, 10.0),
                (4.0, 0.25, 5.0),
            ],
            noises: vec![0.002, 0.005, 0.01],
            moments: vec![0.075, 0.356, 0.6375, 0.919],
            healthy_cycles: 100_000,
        }
    }

    /// A part of it, at the largest noise.
    pub fn part() -> Self {
        Self {
            specimens: vec![(2.0, 0.05, 10.0), (3.0, 0.1, 10.0), (4.0, 0.25, 10.0)],
            noises: vec![0.01],
            moments: vec![0.356, 0.919],
            healthy_cycles: 12_000,
            ..Self::whole()
        }
    }

    /// What is tried on an image: every kind in every size at two moments, in the second with a law that follows, on
    /// one specimen at the largest noise.
    pub fn on_image() -> Self {
        Self {
            specimens: vec![(3.0, 0.1, 10.0)],
            noises: vec![0.01],
            moments: vec![0.356, 0.919],
            healthy_cycles: 0,
            ..Self::whole()
        }
    }

    /// Every trial of it, numbered by its seed.
    pub fn trials(&self) -> Vec<Trial> {
        let mut all = Vec::new();
        for &kind in &self.kinds {
            for &size in kind.sizes() {
                for (specimen, &(density, amplitude, frequency)) in
                    self.specimens.iter().enumerate()
                {
                    for (loudness, &noise) in self.noises.iter().enumerate() {
                        for (part, &moment) in self.moments.iter().enumerate() {
                            // Every second one, at every moment, noise and specimen.
                            let follows = (specimen + loudness + part) % 2 == 1;
                            all.push(Trial {
                                kind,
                                size,
                                density,
                                amplitude,
                                frequency,
                                noise,
                                moment,
                                follow: if follows { FOLLOW } else { 0.0 },
                                seed: all.len() as u64,
                            });
                        }
                    }
                }
            }
        }
        all
    }

    /// Every slow change of it, at the largest noise.
    pub fn slow_changes(&self) -> Vec<SlowChange> {
        let mut all = Vec::new();
        for (changing, size) in SlowChange::SIZES {
            for &(density, amplitude, _) in &self.specimens {
                all.push(SlowChange {
                    changing,
                    size,
                    density,
                    amplitude,
                    noise: self.loudest(),
                    seed: all.len() as u64,
                });
            }
        }
        all
    }

    fn loudest(&self) -> f64 {
        self.noises.iter().copied().fold(0.0, f64::max)
    }

    /// Runs it; `done` is called after each trial, each slow change, and the healthy cycles of each specimen, with a law that
    /// stays and with one that follows.
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
        let slow = self
            .slow_changes()
            .into_par_iter()
            .map(|change| {
                let followed = change.run();
                done();
                followed
            })
            .collect::<Result<_, _>>()?;
        let runs = self.healthy_runs();
        let cycles = self.healthy_cycles.div_ceil(runs.len().max(1) as u32);
        let healthy: Vec<Healthy> = runs
            .into_par_iter()
            .enumerate()
            .map(|(seed, (specimen, follow))| {
                let (noise, seed) = (self.loudest(), seed as u64);
                let healthy = run_healthy(specimen, (noise, follow), cycles, seed);
                done();
                healthy
            })
            .collect::<Result<_, _>>()?;
        Ok(Summary::of(outcomes, slow, healthy))
    }

    /// Density and amplitude, and by how much the law follows.
    fn healthy_runs(&self) -> Vec<((f64, f64), f64)> {
        let specimens = self.specimens.iter();
        specimens
            .flat_map(|&(density, amplitude, _)| {
                [0.0, FOLLOW].map(|follow| ((density, amplitude), follow))
            })
            .collect()
    }

    /// How often [`Campaign::run`] calls `done`.
    pub fn steps(&self) -> u64 {
        let all = self.trials().len() + self.slow_changes().len() + self.healthy_runs().len();
        all as u64
    }
}
