//! The campaign of injected changes: which faults of specimen, sensors and actuator the rig's monitor finds, and how it names them;
//! how the rig responds to attacks, which are defined without regard to what its monitor knows; and how often it raises a false
//! alarm.

mod action;
mod adversary;
mod change;
mod coverage;
mod damage;
mod facts;
mod hazard;
mod healthy;
mod known;
mod lost;
mod names;
mod outcome;
mod pairs;
mod requirement;
mod rig;
mod run;
mod settings;
mod slow;
mod summary;
mod trial;

use rayon::iter::{IndexedParallelIterator as _, IntoParallelIterator as _, ParallelIterator as _};

pub use adversary::adversary;
pub use change::Change;
pub use coverage::Coverage;
pub use damage::{Condition, Damaged};
pub use facts::Element;
pub use hazard::{Allowed, Behind, Hazard, HazardMeter, Quantity};
pub use healthy::{Healthy, Surroundings, run_healthy};
pub use outcome::{Loss, Naming, Outcome, Said, Stopping};
pub use requirement::{missed, requirements};
pub use run::{run_trial, run_trial_with};
pub use settings::{Forgery, forgeries};
pub use slow::{CHANGING, Changing, FOLLOW, Left, SlowChange, SlowOutcome};
pub use summary::{
    AttackSummary, Counts, Hazards, KindSummary, LossSummary, Outcomes, Summary, WorstHazard,
};
pub use trial::{BLOCKS, Close, Headroom, Injected, Set, TRACKING, Trial};

use trial::{FREQUENCY, Place};

use crate::SetupError;

/// Contents of a campaign.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// Changes that the monitor knows.
    pub known: Vec<Change>,
    /// Density in g/cm³, amplitude in mm, frequency in Hz.
    pub specimens: Vec<(f64, f64, f64)>,
    /// RMS of the force channel's noise divided by that of the force.
    pub noises: Vec<f64>,
    /// Parts of the cycle at which faults begin, each at another position within an eighth of a cycle, because the actuator is
    /// watched by eighths.
    pub moments: Vec<f64>,
    /// Number of healthy cycles, spread over the specimens.
    pub healthy_cycles: u32,
    /// Attacks.
    pub attacks: Attacks,
}

/// Number of attacks in a campaign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attacks {
    /// One in this many of the single attacks and of the pairs that are known to be hard; 0 for none.
    pub one_in: usize,
    /// Number of drawn pairs.
    pub pairs: u32,
    /// Number of trials that the adversary draws, and the number of the first.
    pub adversary: u32,
    /// Number of the first.
    pub first: u64,
}

impl Campaign {
    /// The whole campaign: every kind in every size on four specimens at three levels of noise, every attack in the same way, 1000
    /// pairs of attacks in addition to those that are known to be hard, and 1e5 healthy cycles.
    pub fn whole() -> Self {
        Self {
            known: Change::known(),
            specimens: vec![
                (2.0, 0.05, 5.0),
                (2.5, 0.2, 2.0),
                (3.0, 0.1, 10.0),
                (4.0, 0.25, 5.0),
            ],
            noises: vec![0.002, 0.005, 0.01],
            moments: vec![0.075, 0.356, 0.6375, 0.919],
            healthy_cycles: 100_000,
            attacks: Attacks {
                one_in: 1,
                pairs: 1000,
                ..Attacks::default()
            },
        }
    }

    /// A part of it, at the largest noise.
    pub fn part() -> Self {
        Self {
            specimens: vec![(2.0, 0.05, 10.0), (3.0, 0.1, 10.0), (4.0, 0.25, 10.0)],
            noises: vec![0.01],
            moments: vec![0.356, 0.919],
            healthy_cycles: 18_000,
            // Of six trials per kind and size, a different one each time.
            attacks: Attacks {
                one_in: 5,
                pairs: 12,
                adversary: 12,
                first: 0,
            },
            ..Self::whole()
        }
    }

    /// `count` trials that the adversary draws, from number `first` on, and nothing else.
    pub fn adversary(count: u32, first: u64) -> Self {
        Self {
            known: Vec::new(),
            specimens: Vec::new(),
            noises: Vec::new(),
            moments: Vec::new(),
            healthy_cycles: 0,
            attacks: Attacks {
                adversary: count,
                first,
                ..Attacks::default()
            },
        }
    }

    /// The campaign for an image: every kind in every size at two moments, at the second with adaptation, on one specimen at the
    /// largest noise, and a third of such attacks.
    pub fn on_image() -> Self {
        Self {
            specimens: vec![(3.0, 0.1, 10.0)],
            noises: vec![0.01],
            moments: vec![0.356, 0.919],
            healthy_cycles: 0,
            attacks: Attacks {
                one_in: 3,
                ..Attacks::default()
            },
            ..Self::whole()
        }
    }

    /// All trials: of the changes that the monitor knows, of single attacks, of pairs, and those of the adversary. Each set is numbered
    /// by its seeds.
    pub fn trials(&self) -> Vec<Trial> {
        let mut all = self.alone(&self.known, |kind, size, moment, place| {
            Trial::known(kind, size, moment, place)
        });
        let some = |trials: Vec<Trial>| match self.attacks.one_in {
            0 => Vec::new(),
            one_in => trials.into_iter().step_by(one_in).collect(),
        };
        let singles = self.alone(&Change::singles(), |kind, size, moment, place| {
            let (density, amplitude, _) = place.specimen;
            let specimen = (density, amplitude, FREQUENCY);
            let place = Place { specimen, ..place };
            Trial::attacked(Set::Single, vec![kind.attack(size, moment, 0.0)], place)
        });
        all.extend(some(singles));
        all.extend(some(pairs::scenarios(self)));
        all.extend(pairs::drawn_pairs(self, self.attacks.pairs));
        let numbers = 0..u64::from(self.attacks.adversary);
        all.extend(numbers.map(|number| adversary(self.attacks.first + number)));
        all
    }

    /// The trials that `of` makes of each kind in every size, at each moment, specimen and noise, every second one with adaptation.
    fn alone(&self, kinds: &[Change], of: fn(Change, f64, f64, Place) -> Trial) -> Vec<Trial> {
        let mut all = Vec::new();
        for &kind in kinds {
            for &size in kind.sizes() {
                for (place, &specimen) in self.specimens.iter().enumerate() {
                    for (loudness, &noise) in self.noises.iter().enumerate() {
                        for (part, &moment) in self.moments.iter().enumerate() {
                            let follows = (place + loudness + part) % 2 == 1;
                            let place = Place {
                                specimen,
                                noise,
                                follow: if follows { FOLLOW } else { 0.0 },
                                seed: all.len() as u64,
                            };
                            all.push(of(kind, size, moment, place));
                        }
                    }
                }
            }
        }
        all
    }

    /// All slow changes, at the largest noise.
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

    /// Runs it. `done` is called after each trial, each slow change, and the healthy cycles of each specimen, without adaptation
    /// and with it.
    ///
    /// # Errors
    /// A setup that one of its parts rejects.
    pub fn run(&self, done: &(dyn Fn() + Sync)) -> Result<Summary, SetupError> {
        let outcomes = self
            .trials()
            .into_par_iter()
            .map(|trial| {
                let outcome = run_trial(&trial);
                done();
                outcome
            })
            .collect::<Result<_, _>>()?;
        let forgeries = match self.attacks.one_in {
            0 => Vec::new(),
            _ => forgeries()?,
        };
        let slow = self
            .slow_changes()
            .into_par_iter()
            .map(|change| {
                let followed = change.run();
                done();
                followed
            })
            .collect::<Result<_, _>>()?;
        let healthy: Vec<Healthy> = self
            .healthy_runs()
            .into_par_iter()
            .enumerate()
            .map(|(seed, run)| {
                let settings = (self.loudest(), run.follow);
                let cycles = run.cycles;
                let healthy = run_healthy(
                    run.specimen,
                    settings,
                    run.surroundings,
                    cycles,
                    seed as u64,
                );
                done();
                healthy
            })
            .collect::<Result<_, _>>()?;
        Ok(Summary::of(outcomes, slow, healthy, forgeries))
    }

    /// Every specimen without and with adaptation, in all surroundings; two thirds of the cycles are in those of
    /// [`Surroundings::Settling`], which take longest.
    fn healthy_runs(&self) -> Vec<HealthyRun> {
        if self.healthy_cycles == 0 {
            return Vec::new();
        }
        let specimens = 2 * self.specimens.len().max(1) as u32;
        let others = Surroundings::ALL.len() as u32 - 1;
        let mut runs = Vec::new();
        for &(density, amplitude, _) in &self.specimens {
            for follow in [0.0, FOLLOW] {
                for surroundings in Surroundings::ALL {
                    let (share, shared_by) = match surroundings {
                        Surroundings::Settling => (2, 3 * specimens),
                        _ => (1, 3 * specimens * others),
                    };
                    runs.push(HealthyRun {
                        specimen: (density, amplitude),
                        follow,
                        surroundings,
                        cycles: (share * self.healthy_cycles).div_ceil(shared_by),
                    });
                }
            }
        }
        runs
    }

    /// Number of times that [`Campaign::run`] calls `done`.
    pub fn steps(&self) -> u64 {
        (self.trials().len() + self.slow_changes().len() + self.healthy_runs().len()) as u64
    }
}

/// A healthy run to do.
struct HealthyRun {
    specimen: (f64, f64),
    follow: f64,
    surroundings: Surroundings,
    cycles: u32,
}

#[cfg(test)]
mod tests;
