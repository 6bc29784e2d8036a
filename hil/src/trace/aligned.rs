//! Recordings of one rig share what is wrong with its channels, which each of them shows only about: a force that is early, and
//! the zero of the displacement.

use crate::error::InputError;
use crate::model::{Family, Model};
use crate::recording::Recording;
use crate::recording::trajectory::{Known, Trajectory};

/// Zeros that differ by less than this part of the smaller amplitude are one.
const SAME_ZERO: f64 = 0.05;
/// Shifts that differ by so many ticks may be one.
const SAME_SHIFT: f64 = 1.5;
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
        if let Some(early) = aligned.early() {
            let (late, tick) = (early.late, early.tick);
            aligned.estimate = Some(late);
            aligned.move_by(late - TOO_FAR * tick)?;
        }
        Ok(aligned)
    }

    /// What was moved back too far is left late, which a model finds better than anything finds when a force is early: whether
    /// all are moved anew, less by what `model` found, or, where the first found nothing, as far as the channels show.
    ///
    /// # Errors
    /// As [`Trajectory::of`].
    pub fn follow(&mut self, model: &Model) -> Result<bool, InputError> {
        let Some(late) = self.early().map(|early| early.late) else {
            return Ok(false);
        };
        let mut effects = model.effects.iter();
        let delay = effects.find(|effect| effect.family == Family::Delay);
        let less = delay.and_then(|delay| Some(late + delay.parameters.get("time")?));
        let estimate = self.estimate.take();
        let Some(late) = less.map(|less| less.min(0.0)).or(estimate) else {
            return Ok(false);
        };
        self.move_by(late)?;
        Ok(true)
    }

    /// The longest of those that are fitted whose force is early, or else of those held out.
    fn early(&self) -> Option<&Trajectory> {
        self.longest(|trajectory| trajectory.late < 0.0)
    }

    fn longest(&self, of: fn(&Trajectory) -> bool) -> Option<&Trajectory> {
        let duration = |trajectory: &Trajectory| trajectory.len() as f64 * trajectory.tick;
        let longest = |trajectories: &'_ [Trajectory]| {
            let some = trajectories.iter().enumerate().filter(|(_, t)| of(t));
            some.max_by(|(_, a), (_, b)| duration(a).total_cmp(&duration(b)))
                .map(|(which, _)| which)
        };
        let mut each = self.trajectories.iter();
        each.find_map(|some| Some(&some[longest(some)?]))
    }

    /// Moves every force that is early by about as much, or may be, by `late` s.
    fn move_by(&mut self, late: f64) -> Result<(), InputError> {
        self.anew(|trajectory| {
            let differs = (trajectory.late - late).abs() / trajectory.tick;
            let shares = trajectory.late < 0.0 && differs < SAME_SHIFT;
            (shares || trajectory.may_be_late_by(late)).then_some(Known {
                late: Some(late),
                is_off: Some(trajectory.centre != 0.0),
            })
        })
    }

    /// A zero that was left in is left in where the motion has the same middle, though it is small beside that motion.
    fn share_zero(&mut self) -> Result<(), InputError> {
        let Some(off) = self.longest(|trajectory| trajectory.centre != 0.0) else {
            return Ok(());
        };
        let (middle, largest) = (off.middle, largest_amplitude(off));
        self.anew(|trajectory| {
            let same = SAME_ZERO * largest.min(largest_amplitude(trajectory));
            let shares = trajectory.centre == 0.0 && (trajectory.middle - middle).abs() < same;
            shares.then_some(Known {
                is_off: Some(true),
                ..Known::default()
            })
        })
    }

    /// Makes those ready anew of which more is known.
    fn anew(&mut self, known: impl Fn(&Trajectory) -> Option<Known>) -> Result<(), InputError> {
        for (recordings, trajectories) in self.recordings.iter().zip(&mut self.trajectories) {
            for (recording, trajectory) in recordings.iter().zip(trajectories) {
                if let Some(known) = known(trajectory) {
                    *trajectory = Trajectory::knowing(recording, known)?;
                }
            }
        }
        Ok(())
    }
}

fn largest_amplitude(trajectory: &Trajectory) -> f64 {
    trajectory.amplitude.iter().copied().fold(0.0, f64::max)
}
