//! The samples at which a fit computes the forces of effects: fewer where the motion is slow.

use std::ops::Range;

use mesh_damper_recording::trajectory::Trajectory;

mesh_damper_recording::numbers! {
    /// The samples at which a fit computes the forces of effects.
    StridesPolicy {
        /// Between two of these samples, the displacement differs from a straight line by at most this fraction of its amplitude, or they
        /// are neighbours.
        bent: f64 = 1e-3, Derived("70 samples in the period of a sine, more than most recordings have at their fastest");
    }
}

/// A change of the distance between samples happens at multiples of this, which is also the largest distance. Convention: a power of two,
/// so that every smaller one divides it.
const LARGEST: usize = 64;

/// Samples at equal distances, each the end of a step from the one before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Stride {
    /// Where its first step begins, and where its last one ends.
    pub samples: Range<usize>,
    /// Samples in a step; divides the length of `samples`.
    pub step: usize,
}

impl Stride {
    /// Every sample of a recording.
    pub fn each(samples: usize) -> Vec<Self> {
        vec![Self {
            samples: 0..samples.saturating_sub(1),
            step: 1,
        }]
    }

    /// The samples at which its steps end.
    pub fn ends(&self) -> impl Iterator<Item = usize> + use<> {
        let Range { start, end } = self.samples;
        (start + self.step..=end).step_by(self.step)
    }
}

/// Strides over a trajectory, as long as its motion permits.
pub(crate) fn strides(trajectory: &Trajectory) -> Vec<Stride> {
    let last = trajectory.len().saturating_sub(1);
    let moving = trajectory.blocks.iter();
    let moving = moving.filter(|block| !block.cycles.is_empty());
    let least = moving.map(|block| block.amplitude).reduce(f64::min);
    let mut strides: Vec<Stride> = Vec::new();
    for start in (0..last).step_by(LARGEST) {
        let end = (start + LARGEST).min(last);
        let within = |values: &[f64]| {
            let sizes = values[start..=end].iter().map(|value| value.abs());
            sizes.fold(0.0, f64::max)
        };
        // At rest the amplitude is that of noise.
        let amplitude = trajectory.amplitude[start].max(least.unwrap_or_default());
        // A line misses a curve by its second derivative times an eighth of the squared distance.
        let bent = StridesPolicy::in_use().bent * amplitude;
        let longest = (8.0 * bent / within(&trajectory.motion.acceleration)).sqrt();
        let permitted = (longest / trajectory.tick) as usize;
        let powers = (0..=LARGEST.ilog2()).rev().map(|power| 1 << power);
        let mut fitting =
            powers.filter(|step| *step <= permitted && (end - start).is_multiple_of(*step));
        let step = fitting.next().unwrap_or(1);
        match strides.last_mut().filter(|stride| stride.step == step) {
            Some(stride) => stride.samples.end = end,
            None => strides.push(Stride {
                samples: start..end,
                step,
            }),
        }
    }
    strides
}

/// A motion, and the samples at which a force along it is computed.
pub(crate) struct Path<'a> {
    pub motion: &'a Trajectory,
    pub strides: &'a [Stride],
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::families::Form;

    /// A slow and a fast sine with a rest between them.
    fn slow_and_fast() -> Trajectory {
        const TICK: f64 = 5e-4;
        let sine = |frequency: f64, seconds: f64| {
            let samples = (seconds / TICK) as i32;
            (0..samples).map(move |n| 0.5 * (TAU * frequency * TICK * f64::from(n)).sin())
        };
        let rest = std::iter::repeat_n(0.0, 1000);
        let displacement: Vec<f64> = sine(0.5, 8.0).chain(rest).chain(sine(60.0, 0.5)).collect();
        let force = displacement.clone();
        Trajectory::new("sines", TICK, &displacement, force, None, None)
    }

    #[test]
    fn steps_are_long_where_the_motion_is_slow_and_cover_it() {
        let trajectory = slow_and_fast();
        let strides = strides(&trajectory);
        let mut at = 0;
        for stride in &strides {
            assert_eq!(stride.samples.start, at);
            at = stride.samples.end;
            assert_eq!(stride.ends().last(), Some(at));
        }
        assert_eq!(at + 1, trajectory.len());
        let step_at = |sample: usize| {
            let stride = strides.iter().find(|one| one.samples.contains(&sample));
            stride.unwrap().step
        };
        // A period of 4000 samples, and one of 33.
        assert_eq!(step_at(8000), 32);
        assert_eq!(step_at(17_500), 1);
        let visited: usize = strides.iter().map(|stride| stride.ends().count()).sum();
        assert!(visited < trajectory.len() / 8, "{visited}");
    }

    #[test]
    fn forces_with_a_memory_are_those_of_every_sample() {
        let trajectory = slow_and_fast();
        let few = strides(&trajectory);
        let each = Stride::each(trajectory.len());
        for (name, shapes) in [
            ("yielding", &[0.05, 0.4][..]),
            ("relaxation", &[0.02]),
            ("stick_slip", &[0.03]),
            ("bouc_wen", &[0.05, 2.0]),
            ("backlash", &[0.05, 0.1]),
        ] {
            let form = Form::named(name).unwrap();
            let [coarse, fine] = [&few, &each].map(|strides| {
                let motion = &trajectory;
                (form.unit_forces)(shapes, &Path { motion, strides }).unwrap()
            });
            let largest = fine[0].iter().fold(0.0, |most: f64, f| most.max(f.abs()));
            for sample in few.iter().flat_map(Stride::ends) {
                let off = (coarse[0][sample] - fine[0][sample]).abs();
                assert!(off < 0.02 * largest, "{name} at {sample}: {off} of {largest}");
            }
        }
    }
}
