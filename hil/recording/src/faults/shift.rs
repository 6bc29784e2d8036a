//! A time shift between force and displacement.

use nalgebra::{SMatrix, SVector};

use super::super::cycles::same_amplitude;
use super::super::trajectory::Trajectory;
use mesh_damper_tables::channel::Channel;

use super::kind::{ChannelFault, ChannelFaultKind};
use crate::cycles::CyclesPolicy;

crate::numbers! {
    /// When force and displacement are shifted in time. A shift is found by fitting a general damper, a sum of functions of the motion, to
    /// the force.
    ShiftPolicy {
        /// Time shifts are searched for up to this fraction of the shortest period.
        reach: f64 = 0.3, Tuned("the injected channel faults: the force of a slow specimen with memory may look earlier than that");
        /// Time shifts are searched for up to this many ticks: filters and loggers are late by no more.
        most_ticks: usize = 64, Convention("a filter of 64 samples is a long one");
        /// The smallest time shift that is reported and removed, ticks.
        least: f64 = 0.7, Tuned("the injected channel faults");
        /// A time shift is accepted only if it reduces the RMS residual of a general damper below this fraction of the residual without it.
        better: f64 = 0.6, Tuned("the injected channel faults and the blind trial");
        /// A time shift is accepted only if the RMS residual of a general damper is then below this fraction of the RMS force: a force that
        /// such a damper cannot describe says nothing about its time.
        described: f64 = 0.12, Tuned("the injected channel faults and the blind trial");
        /// The limit of `described` for a recording with a single frequency, where a phase may be a loss as well as a time shift.
        well_described: f64 = 0.05, Tuned("the injected channel faults and the blind trial");
        /// A force supplies energy if its work is negative by more than this many standard deviations of the work of its noise.
        energy_deviations: f64 = 3.0, Convention("one in a thousand by chance");
        /// A block has a frequency if it has at least this many cycles.
        steady: usize = 3, Convention("one cycle more than a start and an end");
        /// A recording has several frequencies if the highest is more than this many times the lowest.
        several: f64 = 1.4, Tuned("the blind trial");
        /// Samples up to this many to either side of a kink of the motion (a jump of the velocity) are not used to find a time shift.
        about_kinks: usize = 3, Tuned("the injected channel faults");
        /// The samples of an amplitude are used to find a time shift only if there are at least this many.
        fewest_samples: usize = 60, Derived("five for each of the twelve functions of a general damper");
    }
}

/// A time shift is judged on at most this many samples. Convention: bounds the time of the search.
const MOST_ROWS: usize = 3000;

/// Exponents of friction; friction with any other exponent is nearly a sum of these two. Convention: a dry one and a wet one.
const DRY_AND_WET: [f64; 2] = [0.15, 0.5];
/// Number of functions of the motion whose sum is a general damper's force.
const FUNCTIONS: usize = 12;

/// Delay of the force relative to the displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Ticks; negative when the force is early.
    pub late: f64,
}

impl Shift {
    /// The shift of `trajectory` if no passive damper has it: a force that is early, or late by more than its loss angle, so that
    /// it supplies energy. A smaller lag is the effect `delay` of a trace.
    ///
    /// At a single frequency an early force means a larger loss: the force of a dashpot leads by a quarter of a cycle, with
    /// harmonics from its orifices and valves. Only several frequencies distinguish a time from a phase.
    ///
    /// The force is regressed at every shift on the motion, its powers, the direction of the motion, its velocity and its
    /// acceleration. The shift with the smallest residual is that of the channels.
    pub(in super::super) fn find(trajectory: &Trajectory) -> Option<Self> {
        let [lowest, highest] = frequencies(trajectory);
        let several = highest > ShiftPolicy::in_use().several * lowest;
        let shortest = 1.0 / (highest * trajectory.tick);
        let reach = ((ShiftPolicy::in_use().reach * shortest) as usize)
            .min(ShiftPolicy::in_use().most_ticks);
        if highest == 0.0 || reach < 2 || trajectory.len() < 8 * reach {
            return None;
        }
        let rows = ShiftRows::of_each_amplitude(trajectory, reach);
        let left: Vec<f64> = (0..=2 * reach)
            .map(|step| {
                let shift = step as isize - reach as isize;
                let each = rows.iter().map(|rows| rows.left(trajectory, shift));
                let (left, all) = each.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
                left / all
            })
            .collect();
        let (best, &least) = left.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
        if best == 0 || best == 2 * reach {
            return None;
        }
        // The vertex of the parabola through the least and its neighbours.
        let (before, after) = (left[best - 1], left[best + 1]);
        let vertex = 0.5 * (before - after) / (before - 2.0 * least + after);
        let late = best as f64 - reach as f64 + vertex;
        let described = if several {
            ShiftPolicy::in_use().described
        } else {
            ShiftPolicy::in_use().well_described
        };
        let better = least
            < ShiftPolicy::in_use().better * ShiftPolicy::in_use().better * left[reach]
            && least < described * described;
        let impossible = several && late < 0.0 || gives_energy(trajectory, 0);
        (better && impossible && late.abs() >= ShiftPolicy::in_use().least).then_some(Self { late })
    }

    /// Whether a force `late` ticks later may belong to such a damper as well: the unshifted force has no clearly smaller residual,
    /// and the shifted one still absorbs energy. At a single frequency both may be true.
    pub(in super::super) fn may_be(trajectory: &Trajectory, late: isize) -> bool {
        let reach = late.unsigned_abs();
        if late == 0 || trajectory.len() <= 2 * reach || gives_energy(trajectory, late) {
            return false;
        }
        let rows = ShiftRows::of_each_amplitude(trajectory, reach);
        let left = |shift| -> f64 { rows.iter().map(|rows| rows.left(trajectory, shift).0).sum() };
        left(0) >= ShiftPolicy::in_use().better * ShiftPolicy::in_use().better * left(late)
    }

    /// `force` moved back by this shift, with a cubic between ticks; ends are held.
    pub fn undone(self, force: &[f64]) -> Vec<f64> {
        let last = force.len() - 1;
        let at = |index: isize| force[index.clamp(0, last as isize) as usize];
        (0..force.len())
            .map(|index| {
                let place = index as f64 + self.late;
                let (whole, u) = (place.floor() as isize, place - place.floor());
                let [a, b, c, d] = [-1, 0, 1, 2].map(|offset| at(whole + offset));
                // Catmull–Rom.
                b + 0.5
                    * u
                    * (c - a + u * (2.0 * a - 5.0 * b + 4.0 * c - d + u * (3.0 * (b - c) + d - a)))
            })
            .collect()
    }

    /// The factor by which [`Shift::undone`] changes white noise: that of its weights.
    pub(crate) fn noise_factor(self) -> f64 {
        let part = Self {
            late: self.late - self.late.round(),
        };
        let weights = part.undone(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        weights
            .iter()
            .map(|weight| weight * weight)
            .sum::<f64>()
            .sqrt()
    }

    /// The channel fault, for `tick` in s.
    pub fn fault(self, tick: f64) -> ChannelFault {
        ChannelFault {
            channel: Channel::Force,
            kind: ChannelFaultKind::Shifted {
                late: self.late * tick,
            },
        }
    }
}

/// The lowest and the highest frequency of its steady blocks, Hz; ∞ and 0 without steady blocks.
fn frequencies(trajectory: &Trajectory) -> [f64; 2] {
    let blocks = trajectory.blocks.iter();
    let steady = blocks.filter(|block| block.cycles.len() >= ShiftPolicy::in_use().steady);
    steady.fold([f64::INFINITY, 0.0], |[lowest, highest], block| {
        [lowest.min(block.frequency), highest.max(block.frequency)]
    })
}

/// Whether the specimen supplies energy in the block of highest frequency with the force `late` ticks later: more than its noise
/// and the incomplete sample of a cycle explain.
fn gives_energy(trajectory: &Trajectory, late: isize) -> bool {
    let fastest = trajectory
        .blocks
        .iter()
        .max_by(|a, b| a.frequency.total_cmp(&b.frequency));
    fastest.is_some_and(|block| {
        let whole = block.cycles.first().map_or(0, |cycle| cycle.start)
            ..block.cycles.last().map_or(0, |cycle| cycle.end);
        let last = trajectory.len() - 1;
        let (mut power, mut variance, mut largest) = (0.0, 0.0, 0.0_f64);
        for index in whole {
            let force = trajectory.force[index.saturating_add_signed(late).min(last)];
            let velocity = trajectory.motion.velocity[index];
            power += force * velocity;
            variance += (trajectory.force_noise * velocity).powi(2);
            largest = largest.max((force * velocity).abs());
        }
        power < -largest - ShiftPolicy::in_use().energy_deviations * variance.sqrt()
    })
}

/// Samples of the motion at one amplitude, evenly chosen, with the functions of the motion and the inverse of their Gram matrix.
struct ShiftRows {
    samples: Vec<usize>,
    functions: Vec<SVector<f64, FUNCTIONS>>,
    gram_inverse: SMatrix<f64, FUNCTIONS, FUNCTIONS>,
}

impl ShiftRows {
    /// A damper may differ at every amplitude, as in the published tables.
    fn of_each_amplitude(trajectory: &Trajectory, reach: usize) -> Vec<Self> {
        let inner = reach..trajectory.len() - reach;
        let kinks = &trajectory.motion.kinks;
        let every = inner.len().div_ceil(MOST_ROWS).max(1);
        let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
        for sample in inner.step_by(every) {
            // Friction jumps there with the velocity, between two samples, which says nothing about parts of a tick.
            let about = ShiftPolicy::in_use().about_kinks;
            let before = kinks.partition_point(|kink| kink + about < sample);
            if kinks
                .get(before)
                .is_some_and(|kink| *kink <= sample + about)
            {
                continue;
            }
            let amplitude = trajectory.amplitude[sample];
            let alike = |group: &&mut (f64, Vec<usize>)| same_amplitude(group.0, amplitude);
            match groups.iter_mut().find(alike) {
                Some((_, samples)) => samples.push(sample),
                None => groups.push((amplitude, vec![sample])),
            }
        }
        // With as many functions as samples anything can be described.
        groups.retain(|(_, samples)| samples.len() >= ShiftPolicy::in_use().fewest_samples);
        if groups.len() > CyclesPolicy::in_use().most_amplitudes {
            let all = groups.into_iter().flat_map(|(_, samples)| samples);
            return vec![Self::of(trajectory, all.collect())];
        }
        let each = groups.into_iter();
        each.map(|(_, samples)| Self::of(trajectory, samples))
            .collect()
    }

    fn of(trajectory: &Trajectory, samples: Vec<usize>) -> Self {
        let motion = &trajectory.motion;
        let largest = |values: &[f64]| {
            values
                .iter()
                .fold(f64::MIN_POSITIVE, |a: f64, v| a.max(v.abs()))
        };
        let (y_max, v_max, a_max) = (
            largest(&motion.displacement),
            largest(&motion.velocity),
            largest(&motion.acceleration),
        );
        let functions: Vec<SVector<f64, FUNCTIONS>> = samples
            .iter()
            .map(|&index| {
                let y = motion.displacement[index] / y_max;
                let v = motion.velocity[index] / v_max;
                let a = motion.acceleration[index] / a_max;
                // A single wrong exponent looks like a shift.
                let [dry, wet] = DRY_AND_WET.map(|alpha| v.signum() * v.abs().powf(alpha));
                SVector::from([
                    1.0,
                    y,
                    y * y,
                    y.powi(3),
                    y.powi(5),
                    dry,
                    wet,
                    v,
                    y.abs() * dry,
                    a,
                    // An orifice, and a dashpot that depends on the stroke.
                    v * v.abs(),
                    y * v,
                ])
            })
            .collect();
        let mut gram =
            SMatrix::<f64, FUNCTIONS, FUNCTIONS>::identity() * (1e-9 * samples.len() as f64);
        for row in &functions {
            gram += row * row.transpose();
        }
        Self {
            samples,
            functions,
            gram_inverse: gram.try_inverse().unwrap_or_else(SMatrix::zeros),
        }
    }

    /// Sum of squares of the residual for the force `shift` ticks later, and of the force itself.
    fn left(&self, trajectory: &Trajectory, shift: isize) -> (f64, f64) {
        let mut right = SVector::<f64, FUNCTIONS>::zeros();
        let mut power = 0.0;
        for (&sample, row) in self.samples.iter().zip(&self.functions) {
            let force = trajectory.force[sample.saturating_add_signed(shift)];
            right += row * force;
            power += force * force;
        }
        (power - right.dot(&(self.gram_inverse * right)), power)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const TICK: f64 = 1.0 / 256.0;
    /// mm
    const AMPLITUDE: f64 = 10.0;

    /// A test of a damper of displacement mm and velocity mm/s, twelve cycles at each of the `frequencies`, with the force late by
    /// `late` s.
    fn test(damper: fn(f64, f64) -> f64, frequencies: &[f64], late: f64) -> Trajectory {
        let (mut displacement, mut force) = (Vec::new(), Vec::new());
        for frequency in frequencies {
            let samples = (12.0 / frequency / TICK) as usize;
            for index in 0..samples {
                let time = index as f64 * TICK;
                let at = |time: f64| (TAU * frequency * time).sin_cos();
                let noise = f64::from((index * 7_919 % 1_000) as u32) / 1_000.0 - 0.5;
                displacement.push(AMPLITUDE * at(time).0 + 1e-3 * noise);
                let (sin, cos) = at(time - late);
                let speed = AMPLITUDE * TAU * frequency * cos;
                force.push(damper(AMPLITUDE * sin, speed) + 5e-3 * noise);
            }
        }
        Trajectory::new("test", TICK, &displacement, force, None, None)
    }

    /// Its orifice gives a force proportional to the square of the speed, 80° ahead of the displacement.
    fn hydraulic(y: f64, v: f64) -> f64 {
        0.015 * y + 0.01 * v * v.abs() / TAU
    }

    /// Its dashpot is stronger on one side of the stroke.
    fn one_sided(y: f64, v: f64) -> f64 {
        0.003 * y + 0.02 * v * (1.0 + 0.05 * y)
    }

    fn spring_with_friction(y: f64, v: f64) -> f64 {
        0.15 * y + 0.3 * v.abs().powf(0.2) * v.signum()
    }

    #[test]
    fn the_force_of_a_dashpot_is_not_early() {
        for damper in [hydraulic, one_sided] {
            for frequencies in [
                &[0.1][..],
                &[0.25],
                &[0.5],
                &[1.0],
                &[0.25, 0.5],
                &[0.5, 0.8],
                &[1.0, 0.5, 0.1],
            ] {
                let found = Shift::find(&test(damper, frequencies, 0.0));
                assert_eq!(found, None, "{frequencies:?} Hz");
            }
        }
    }

    /// Its energy is then only rounding, noise, and the incomplete sample of a cycle.
    #[test]
    fn a_spring_without_losses_is_in_time() {
        let spring = |y: f64, _: f64| 0.5 + 0.2 * y;
        for frequency in [0.7, 2.0, 3.3, 5.0] {
            for noiseless in [false, true] {
                let mut test = test(spring, &[frequency], 0.0);
                if noiseless {
                    let exact = |y: &f64| spring(*y, 0.0);
                    let force = test.motion.displacement.iter().map(exact).collect();
                    let displacement = test.motion.displacement.clone();
                    test = Trajectory::new("test", TICK, &displacement, force, None, None);
                }
                assert_eq!(Shift::find(&test), None, "{frequency} Hz");
            }
        }
    }

    /// Early at several frequencies, or so late that it supplies energy at any.
    #[test]
    fn what_no_damper_does_is_a_shift() {
        for (frequencies, ticks) in [(&[1.0, 5.0][..], -4.0), (&[1.0, 5.0], 12.0), (&[5.0], 12.0)] {
            let found =
                Shift::find(&test(spring_with_friction, frequencies, ticks * TICK)).unwrap();
            assert!(
                (found.late - ticks).abs() < 0.5,
                "{} of {ticks}",
                found.late
            );
        }
    }
}
