//! Recordings of one rig share what is wrong with its channels, which each of them shows only about: a force that is early, and
//! the zero of the displacement.

use crate::error::InputError;
use crate::model::{Family, Model};
use crate::recording::Recording;
use crate::recording::trajectory::{Known, Trajectory};

/// Zeros that differ by less than this part of the amplitude are one.
const SAME_ZERO: f64 = 0.02;

/// Ticks that forces are first moved too far.
const TOO_FAR: f64 = 0.5;

/// Recordings made ready, those that are fitted and those held out.
pub(super) struct Aligned<'r> {
    recordings: [&'r [Recording]; 2],
    /// In the same order.
    pub trajectories: [Vec<Trajectory>; 2],
    /// By how much the force is late as far as the channels show, s, until a model has shown more.
    estimate: Option<f64>,
}

impl<'r> Aligned<'r> {
    /// What the longest of the `fitted` shows, or else of those that are held out, holds for all that may share it.
    ///
    /// # Errors
    /// As [`Trajectory::of`].
    pub fn of(fitted: &'r [Recording], held: &'r [Recording]) -> Result<Self, InputError> {
        let each = |recordings: &[Recording]| -> Result<Vec<Trajectory>, InputError> {
            recordings.iter().map(Trajectory::of).collect()
        };
        let mut aligned = Self {
            recordings: [fitted, held],
            trajectories: [each(fitted)?, each(held)?],
            estimate: None,
        };
        aligned.share_zero()?;
        if let Some(late) = aligned.early() {
            aligned.estimate = Some(late);
            aligned.move_by(late - TOO_FAR * aligned.trajectories[0][0].tick)?;
        }
        Ok(aligned)
    }

    /// What was moved back too far is left late, which a model finds better than anything finds when a force is early: whether
    /// all are moved anew, less by what `model` found, or, where it first found nothing, as far as was found at first.
    ///
    /// # Errors
    /// As [`Trajectory::of`].
    pub fn follow(&mut self, model: &Model) -> Result<bool, InputError> {
        let Some(late) = self.early() else {
            return Ok(false);
        };
        let mut effects = model.effects.iter();
        let delay = effects.find(|effect| effect.family == Family::Delay);
        let less = delay.and_then(|delay| Some(late + delay.parameters.get("time")?));
        let estimate = self.estimate.take();
        let Some(late) = less.filter(|less| *less < 0.0).or(estimate) else {
            return Ok(false);
        };
        self.move_by(late)?;
        Ok(true)
    }

    /// By how much the force is late where it is early, s.
    fn early(&self) -> Option<f64> {
        let longest = |trajectories: &[Trajectory]| {
            let early = trajectories.iter().filter(|t| t.late < 0.0);
            early.max_by_key(|t| t.len()).map(|t| t.late)
        };
        let [fitted, held] = &self.trajectories;
        longest(fitted).or_else(|| longest(held))
    }

    /// Moves every force that is early, or may be, by `late` s.
    fn move_by(&mut self, late: f64) -> Result<(), InputError> {
        for (recordings, trajectories) in self.recordings.iter().zip(&mut self.trajectories) {
            for (recording, trajectory) in recordings.iter().zip(trajectories) {
                if trajectory.late < 0.0 || trajectory.may_be_late_by(late) {
                    let known = Known {
                        late: Some(late),
                        is_off: Some(trajectory.centre != 0.0),
                    };
                    *trajectory = Trajectory::knowing(recording, known)?;
                }
            }
        }
        Ok(())
    }

    /// Takes the zero of all whose motion has the same middle as that of the longest fitted for what it is there.
    fn share_zero(&mut self) -> Result<(), InputError> {
        let longest = self.trajectories[0].iter().max_by_key(|t| t.len());
        let Some(longest) = longest else {
            return Ok(());
        };
        let (middle, is_off) = (longest.middle, longest.centre != 0.0);
        let same = SAME_ZERO * longest.amplitude.iter().copied().fold(0.0, f64::max);
        for (recordings, trajectories) in self.recordings.iter().zip(&mut self.trajectories) {
            for (recording, trajectory) in recordings.iter().zip(trajectories) {
                let differs = (trajectory.centre != 0.0) != is_off;
                if differs && (trajectory.middle - middle).abs() < same {
                    let known = Known {
                        is_off: Some(is_off),
                        ..Known::default()
                    };
                    *trajectory = Trajectory::knowing(recording, known)?;
                }
            }
        }
        Ok(())
    }
}
