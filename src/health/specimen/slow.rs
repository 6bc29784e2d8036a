//! The watch judges a slow change by how far the baselines have moved since the run-in.

use super::super::HealthConfig;
use super::super::cause::HealthCause;
use super::super::event::{Event, Statistic};
use super::super::pattern::{Course, Shift, cause};
use super::{SETTLING, SpecimenWatch, of_law};

/// Part of the size to be found that a slow change may have.
const SLOW: f32 = 0.8;

impl SpecimenWatch {
    /// The baselines' change since the run-in, or since they were learned if that came later.
    pub(super) fn look_back(&mut self, config: &HealthConfig) -> Option<Event> {
        let limit = SLOW * config.size;
        let settled = self.since_start > config.run_in_cycles;
        let ends = self.since_start == config.run_in_cycles;
        let first = self.cycles == SETTLING + config.learning_cycles + 1;
        let mut shift = self.mean_values();
        let mut all = Statistic::ALL.into_iter();
        for (moved, watch) in shift.iter_mut().zip(&mut self.watches) {
            // Neither a run-in nor the temperature moves a mean.
            let lasting = matches!(
                all.next(),
                Some(Statistic::MeanForce | Statistic::MeanCommand)
            );
            if !lasting {
                // The level of the line, because the noise of one or two cycles exceeds a slow change.
                *moved = watch.baseline.level();
            }
            *moved -= if settled && !lasting {
                watch.reference
            } else {
                watch.learned
            };
            if !settled || first {
                watch.reference = watch.baseline.level();
            }
        }
        if !settled || first {
            self.reference_temperature = self.numbers.temperature;
        }
        if first {
            self.learned_temperature = self.numbers.temperature;
            return None;
        }
        let [_, _, mean, ..] = shift;
        if mean.abs() > limit {
            return Some(self.event(&shift, Course::Slow, limit));
        }
        let watched = Statistic::ALL
            .into_iter()
            .zip(&shift)
            .take(Statistic::WATCHED);
        let (most, moved) = watched.fold((Statistic::Stiffness, 0.0f32), |most, (other, moved)| {
            if moved.abs() > most.1 {
                (other, moved.abs())
            } else {
                most
            }
        });
        if moved <= limit {
            None
        } else if ends {
            Some(self.evidence((HealthCause::RunIn, None, most), &shift, limit))
        } else if !settled {
            let warmth = self.warmth(config, self.learned_temperature);
            let allowed = config.run_in_size + self.of_specimen(most, warmth);
            (moved > allowed).then(|| self.slow(&shift, most, allowed))
        } else {
            let warmth = self.warmth(config, self.reference_temperature);
            let warmth = self.of_specimen(most, warmth);
            // A change that the adaptation may take up is no fault.
            let followed = if config.follow > limit {
                config.follow
            } else {
                limit
            };
            let allowed = followed + warmth;
            if moved > allowed {
                Some(self.slow(&shift, most, allowed))
            } else if moved > limit + warmth {
                None
            } else {
                Some(self.evidence((HealthCause::Temperature, None, most), &shift, limit))
            }
        }
    }

    /// Converts `warmth` of a specimen like the law to this specimen, for `statistic`.
    fn of_specimen(&self, statistic: Statistic, warmth: f32) -> f32 {
        let watch = self.watches.get(usize::from(statistic.place()));
        warmth * watch.map_or(1.0, |watch| of_law(watch.baseline.level()))
    }

    /// Event for a slow change beyond `allowed` of the statistic `most`, which is the evidence. The cause may follow from another
    /// statistic.
    fn slow(&self, shift: &Shift, most: Statistic, allowed: f32) -> Event {
        let (cause, or, _) = cause(shift, self.law_third(), Course::Slow);
        self.evidence((cause, or, most), shift, allowed)
    }
}
