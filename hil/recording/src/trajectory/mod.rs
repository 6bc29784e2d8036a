//! A recording prepared for identification: uniform time base, estimated motion, cycles and blocks.

mod centre;
pub(crate) mod settled;
pub mod strides;
mod uncertainty;

use std::ops::Range;
use std::sync::Arc;

use mesh_damper_output::error::InputError;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::control::ControlChannel;

use super::Recording;
use super::averaging::MovingAverage;
use super::cycles::{Cycles, FoundBlock};
use super::faults::kind::{ChannelFault, ChannelFaultKind, listed};
use super::faults::{self, Shift};
use super::motion::MotionEstimate;
use super::motion_error::MotionError;
use super::noise::{noise_beside_tones, noise_deviation, noise_of_runs, rms};
use super::noise_floor::NoiseFloor;
use super::resample::Uniform;
use super::smoother::Band;
use crate::extremes::least_and_largest;
use crate::rig::RigFacts;
pub use centre::Zero;
use centre::middle;

crate::numbers! {
    /// How a recording is made ready for identification.
    TrajectoryPolicy {
        /// A recording with fewer usable samples than this is refused.
        fewest_samples: usize = 32, Convention("no motion can be estimated from fewer");
        /// A moving average of the channels is taken into account only if it is shorter than this fraction of the shortest period.
        longest_average: f64 = 0.2,
            Tuned("the recordings of others: between the harmonics of a motion with corners the spectrum looks like an average over half a \
                period or more");
        /// A recording is refused if the noise of its displacement exceeds this fraction of the displacement's range.
        largest_noise: f64 = 0.05, Convention("a twentieth");
        /// The zero of the displacement is wrong if the middle of the motion is farther from it than this fraction of the largest
        /// amplitude, and the specimen does not feel it (see `felt`).
        off: f64 = 0.05, Tuned("the blind trial and the recordings of others");
        /// The zero of the displacement is wrong, whatever the force, if the middle of the motion is farther from it than this fraction of
        /// the largest amplitude.
        far: f64 = 0.5, Tuned("the recordings of others");
        /// The test `off` applies only if the mean displacement differs from the middle of the motion by less than this fraction of the
        /// distance between middle and zero.
        about: f64 = 0.25, Tuned("the recordings of others");
        /// A specimen feels that the middle of its motion is off zero if the force there exceeds this fraction of that of a spring with its
        /// stiffness.
        felt: f64 = 0.4, Tuned("the recordings of others");
        /// A velocity of more than this many of its standard deviations is certain enough for the law's |v|^α, which is steep near 0;
        /// errors are computed only from such samples and from rests.
        certain: f64 = 3.0, Tuned("the blind trial");
        /// A crossing of the mid level counts if the displacement then leaves a band around it, of ± this many standard deviations of the
        /// noise. The wider of this band and that of `crossing` is used.
        crossing_noises: f64 = 6.0, Derived("white noise does so about twice in 10⁹ samples");
        /// A crossing of the mid level counts if the displacement then leaves a band around it, of ± this fraction of its range. The wider
        /// of this band and that of `crossing_noises` is used.
        crossing: f64 = 0.01, Convention("a hundredth of the largest motion is the smallest that counts");
        /// The temperature of a recording without a temperature channel, °C.
        room: f64 = 20.0, Convention("that of a laboratory");
    }
}

/// Motion and force on a uniform time base, with derived quantities.
#[derive(Clone, Debug)]
pub struct Trajectory {
    /// The recording's name.
    pub name: String,
    /// Time between samples, s.
    pub tick: f64,
    /// Displacement, velocity and acceleration.
    pub motion: MotionEstimate,
    /// Offset subtracted from the recorded displacement, mm: the stated zero, or the middle of the motion if it is a sensor's zero
    /// rather than the position of the specimen; 0 otherwise.
    pub centre: f64,
    /// The middle of the recorded displacement, mm.
    pub middle: f64,
    /// Measured force, kN.
    pub force: Vec<f64>,
    /// Measured temperature, °C.
    pub temperature: Option<Vec<f64>>,
    /// Control inputs. Shared like the cycles.
    pub controls: Arc<Vec<ControlChannel>>,
    /// Blocks of equal cycles; they cover the recording.
    pub blocks: Vec<FoundBlock>,
    /// Cycles since the first sample, fraction included. Shared by all copies that a fit [moves](Self::motion_alone), like the next
    /// field.
    pub cycles: Arc<Vec<f64>>,
    /// Amplitude of the block that contains the sample, mm.
    pub amplitude: Arc<Vec<f64>>,
    /// Standard deviation of the force's noise, kN.
    pub force_noise: f64,
    /// Whether the samples show that noise; otherwise it is an upper bound.
    pub noise_is_known: bool,
    /// Whether an upper bound of it is one of noise: not of the force itself, whose changes no stride tells from noise.
    pub noise_is_bounded: bool,
    /// RMS of the force, kN.
    pub force_rms: f64,
    /// A possible error of the motion.
    pub motion_error: MotionError,
    /// Variance of the force due to the error of the motion, kN²; empty until [`Trajectory::carry_motion_error`] sets it.
    pub carried: Vec<f64>,
    /// Variance of the force that the best law so far [leaves](Trajectory::left_beyond_tolerance), kN²; 0 before there is one.
    pub unexplained: f64,
    /// Whether the force was measured about this tick; false inside a gap of the recording, and where a channel fault was found.
    pub measured: Vec<bool>,
    /// Samples before which the specimen may have been moved in another way than the recording shows, so that what it remembers is not
    /// known; in order.
    pub unsettled: Vec<Range<usize>>,
    /// The average that smoothed the channels before they were written.
    pub average: Option<MovingAverage>,
    /// Ratio of the force's noise to the noise in fast changes; 1 if they are equal.
    pub noise_beside: f64,
    /// Delay of the force in s by which it was moved back, below 0 if it was early; 0 if it was not moved.
    pub late: f64,
    /// Faults of the recording's channels.
    pub faults: Vec<ChannelFault>,
    /// The force in kN before it was moved back, which has the noise that was measured, and the factor by which moving it changed that.
    pub recorded: Option<(Arc<Vec<f64>>, f64)>,
}

impl Recording {
    /// Refuses a recording whose force never changes: it says nothing about a law.
    ///
    /// # Errors
    /// The recording's name.
    pub fn check_force(&self) -> Result<(), InputError> {
        if self.force.iter().any(|force| *force != self.force[0]) {
            return Ok(());
        }
        let remedy = "check the load cell's channel";
        Err(InputError::new(
            &self.name,
            "has a force that never changes",
            remedy,
        ))
    }

    /// Refuses what a trace would refuse before it fits, in time proportional to the samples. A displacement that would be mostly noise
    /// only after smoothing is not refused here.
    ///
    /// # Errors
    /// As [`Recording::check_force`] and [`Trajectory::of`].
    pub fn check_traceable(&self) -> Result<(), InputError> {
        self.check_force()?;
        let (uniform, _) = self.usable()?;
        let noise = noise_deviation(&uniform.displacement);
        self.check_noise(&uniform.displacement, noise)
    }

    /// The samples on a uniform time base without those of channel faults, and all faults found.
    fn usable(&self) -> Result<(Uniform, Vec<ChannelFault>), InputError> {
        self.require_samples(TrajectoryPolicy::in_use().fewest_samples)?;
        let recording = self.repaired();
        let mut uniform = recording.uniform()?;
        let mut found = recording.faults().to_vec();
        found.extend(uniform.faults());
        found.extend(faults::examine(&mut uniform));
        let measured = uniform.measured.iter().filter(|&&measured| measured);
        if measured.count() < TrajectoryPolicy::in_use().fewest_samples {
            return Err(InputError::new(
                &self.name,
                format!("almost none of its samples can be used: {}", listed(&found)),
                "correct the channels, or leave the recording out",
            ));
        }
        Ok((uniform, found))
    }

    /// Refuses a `displacement` with too much noise.
    fn check_noise(&self, displacement: &[f64], noise: f64) -> Result<(), InputError> {
        let (low, high) = least_and_largest(displacement);
        if noise > TrajectoryPolicy::in_use().largest_noise * (high - low) {
            return Err(InputError::new(
                &self.name,
                format!(
                    "its displacement moves by {:.2e} mm only, with noise of {noise:.2e} mm",
                    high - low
                ),
                "check the displacement's channel and unit",
            ));
        }
        Ok(())
    }
}

impl Trajectory {
    /// Prepares a recording, on a uniform time base.
    ///
    /// # Errors
    /// Too few samples, a recording that is mostly gaps, or a displacement that is mostly noise.
    pub fn of(recording: &Recording) -> Result<Self, InputError> {
        Self::knowing(recording, Known::default())
    }

    /// The same if some properties of its channels are known already.
    ///
    /// # Errors
    /// As [`Trajectory::of`].
    pub fn knowing(recording: &Recording, known: Known) -> Result<Self, InputError> {
        let (mut trajectory, average) = Self::prepared(recording, known.zero())?;
        if let Some(average) = average {
            trajectory.see_through(average);
            trajectory.faults.push(ChannelFault {
                channel: Channel::Force,
                kind: ChannelFaultKind::Averaged {
                    time: average.window * trajectory.tick,
                },
            });
        }
        if known.rig.force_delay.is_some() {
            trajectory.move_as_stated(&known.rig)?;
            return Ok(trajectory);
        }
        let shift = match known.late {
            None => Shift::find(&trajectory),
            Some(0.0) => None,
            Some(late) => Some(Shift {
                late: late / trajectory.tick,
            }),
        };
        if let Some(shift) = shift {
            trajectory.faults.push(shift.fault(trajectory.tick));
            trajectory.late = shift.late * trajectory.tick;
            trajectory.undo(shift);
        }
        Ok(trajectory)
    }

    /// Moves the force back by the stated delay.
    fn move_as_stated(&mut self, rig: &RigFacts) -> Result<(), InputError> {
        let Some(delay) = rig.force_delay.filter(|&delay| delay != 0.0) else {
            return Ok(());
        };
        self.undo(Shift {
            late: delay / self.tick,
        });
        let left = self.measured.iter().filter(|&&measured| measured).count();
        if left < TrajectoryPolicy::in_use().fewest_samples {
            return Err(InputError::new(
                &self.name,
                format!("a force that is late by {delay} s leaves {left} samples of it"),
                "give the delay of the force in seconds, such as --force-delay 0.002",
            ));
        }
        Ok(())
    }

    /// Whether the force, which was not moved, may be late by `late` s, like that of another recording of the rig.
    pub fn may_be_late_by(&self, late: f64) -> bool {
        self.late == 0.0 && Shift::may_be(self, (late / self.tick).round() as isize)
    }

    /// The same with both channels as recorded, for measuring losses rather than a law: an average affects force and displacement
    /// equally, and the force of a purely viscous specimen looks like that of a spring that is early. Only a force that is stated
    /// to be late is moved back.
    ///
    /// # Errors
    /// As [`Trajectory::of`].
    pub fn as_recorded(recording: &Recording, rig: &RigFacts) -> Result<Self, InputError> {
        let (mut trajectory, _) = Self::prepared(recording, None)?;
        trajectory.move_as_stated(rig)?;
        Ok(trajectory)
    }

    /// With the average found in its channels, which is not taken into account yet.
    fn prepared(
        recording: &Recording,
        known_zero: Option<Zero>,
    ) -> Result<(Self, Option<MovingAverage>), InputError> {
        let (mut uniform, found) = recording.usable()?;
        let average = MovingAverage::find(&uniform.displacement, &uniform.force);
        // It is unknown whether a measured velocity was averaged too.
        if average.is_some() {
            uniform.velocity = None;
        }
        let zero =
            known_zero.unwrap_or_else(|| Zero::seen_in(&uniform.displacement, &uniform.force));
        let mut trajectory = Self::about(
            zero,
            recording.name.clone(),
            uniform.period,
            &uniform.displacement,
            uniform.force,
            uniform.velocity,
            uniform.temperature,
        );
        trajectory.measured = uniform.measured;
        trajectory.unsettled = trajectory.unsettled();
        if average.is_none() {
            let all = 0..trajectory.len();
            trajectory.take_noise(&[all]);
        }
        trajectory.controls = Arc::new(uniform.controls);
        trajectory.faults = found;
        let motion = &trajectory.motion;
        recording.check_noise(&motion.displacement, motion.noise)?;
        // The gaps between the harmonics of a motion with corners look like the notches of an average over half a period or more.
        let fastest = trajectory.blocks.iter().map(|block| block.frequency);
        let shortest = 1.0 / fastest.fold(0.0, f64::max);
        let average = average.filter(|a| {
            a.window * trajectory.tick < TrajectoryPolicy::in_use().longest_average * shortest
        });
        Ok((trajectory, average))
    }

    /// Conditions the channels of a recording: `displacement` mm, `force` kN, `velocity` mm/s and `temperature` °C where
    /// measured, sampled every `tick` s.
    ///
    /// # Panics
    /// When the channels differ in length or have fewer than 8 samples.
    pub fn new(
        name: impl Into<String>,
        tick: f64,
        displacement: &[f64],
        force: Vec<f64>,
        velocity: Option<Vec<f64>>,
        temperature: Option<Vec<f64>>,
    ) -> Self {
        assert_eq!(force.len(), displacement.len());
        let zero = Zero::seen_in(displacement, &force);
        Self::about(
            zero,
            name.into(),
            tick,
            displacement,
            force,
            velocity,
            temperature,
        )
    }

    /// As [`Trajectory::new`]; the displacement is counted from `zero`.
    fn about(
        zero: Zero,
        name: String,
        tick: f64,
        displacement: &[f64],
        force: Vec<f64>,
        velocity: Option<Vec<f64>>,
        temperature: Option<Vec<f64>>,
    ) -> Self {
        let count = displacement.len();
        let middle = middle(displacement);
        let centre = zero.of(displacement);
        let displacement: Vec<f64> = displacement.iter().map(|y| y - centre).collect();
        let displacement = displacement.as_slice();
        let hysteresis = hysteresis(displacement);
        let rough = Cycles::find(displacement, tick, hysteresis);
        let period = rough.period_per_sample(count, tick);
        let mut motion = MotionEstimate::estimate(displacement, tick, &period);
        let mut cycles = Cycles::find(&motion.displacement, tick, hysteresis);
        cycles.snap_to(&motion.kinks);
        let sines = motion.refine_sines(displacement, tick, &cycles);
        let locally = |displacement: &[f64]| {
            let mut again = MotionEstimate::estimate(displacement, tick, &period);
            again.refine_sines(displacement, tick, &cycles);
            again
        };
        let band = Band::find(displacement, tick, &motion, &sines, locally);
        let band = band.map(|(band, smoothed)| {
            band.take(&smoothed, &mut motion, tick);
            band
        });
        let is_banded = |index: usize| band.as_ref().is_some_and(|band| band.holds_at(index));
        let mut motion_error = MotionError::of(&motion, displacement, is_banded, |displacement| {
            let mut again = locally(displacement);
            if let Some(band) = &band {
                band.refine(&mut again, displacement, tick);
            }
            again
        });
        if let Some(band) = &band {
            band.complete(&mut motion_error);
        }
        if let Some(velocity) = velocity {
            assert_eq!(velocity.len(), count);
            motion.weigh_in(&velocity, &mut motion_error);
        }
        motion.rest_at_reversals();
        Self {
            name,
            tick,
            motion,
            middle,
            centre,
            force_noise: noise_beside_tones(&force),
            noise_is_known: true,
            noise_is_bounded: true,
            force_rms: rms(force.iter().copied()),
            motion_error,
            carried: Vec::new(),
            unexplained: 0.0,
            force,
            temperature,
            controls: Arc::default(),
            measured: vec![true; count],
            unsettled: Vec::new(),
            average: None,
            noise_beside: 1.0,
            late: 0.0,
            faults: Vec::new(),
            recorded: None,
            cycles: Arc::new(cycles.elapsed(count, tick)),
            amplitude: Arc::new(cycles.amplitude_per_sample(count)),
            blocks: cycles.blocks,
        }
    }

    /// Takes noise and size of the force from the samples of `runs` alone: nothing may be learned from the others.
    pub fn size_force_by(&mut self, runs: &[Range<usize>]) {
        let force = &self.force;
        let seen = runs.iter().flat_map(|run| &force[run.clone()]).copied();
        self.force_rms = rms(seen);
        match &self.average {
            Some(average) => self.force_noise = average.noise(noise_of_runs(&self.force, runs)),
            None => self.take_noise(runs),
        }
        self.force_noise *= self.noise_beside;
    }

    /// The noise of the measured samples of `runs`.
    fn take_noise(&mut self, runs: &[Range<usize>]) {
        let blocks = self.blocks.iter().map(|block| {
            let cycle = 1.0 / (block.frequency * self.tick);
            (block.samples.clone(), cycle)
        });
        let blocks: Vec<_> = blocks.collect();
        let (force, factor) = match &self.recorded {
            Some((recorded, factor)) => (recorded.as_slice(), *factor),
            None => (self.force.as_slice(), 1.0),
        };
        let floor = NoiseFloor::of(force, &self.motion, (runs, &self.measured), &blocks);
        self.force_noise = factor * floor.deviation;
        self.noise_is_known = floor.is_known;
        self.noise_is_bounded = floor.is_bounded;
    }

    /// Moves the force back by `shift`. Samples from beyond the recording's ends count as not measured.
    fn undo(&mut self, shift: Shift) {
        let moved = shift.undone(&self.force);
        let recorded = std::mem::replace(&mut self.force, moved);
        self.recorded = Some((Arc::new(recorded), shift.noise_factor()));
        let count = self.len();
        let beyond = (shift.late.abs().ceil() as usize)
            .saturating_add(1)
            .min(count);
        let lost = if shift.late > 0.0 {
            count - beyond..count
        } else {
            0..beyond
        };
        let moved: Vec<bool> = (0..count)
            .map(|index| {
                let from = (index as f64 + shift.late).round();
                let from = (from.max(0.0) as usize).min(count - 1);
                self.measured[from] && !lost.contains(&index)
            })
            .collect();
        self.measured = moved;
    }

    /// The motion before it was averaged, assuming a sine about its mean in every block.
    fn see_through(&mut self, average: MovingAverage) {
        self.average = Some(average);
        self.force_noise = average.noise(self.force_noise);
        for block in &mut self.blocks {
            let samples = block.samples.clone();
            let gain = 1.0 / average.gain(block.frequency * self.tick);
            block.amplitude *= gain;
            let displacement = &mut self.motion.displacement;
            let (mut sum, mut count) = (0.0, 0.0);
            for cycle in &block.cycles {
                sum += displacement[cycle.clone()].iter().sum::<f64>();
                count += cycle.len() as f64;
            }
            let mean = if count > 0.0 { sum / count } else { 0.0 };
            for y in &mut displacement[samples.clone()] {
                *y = mean + gain * (*y - mean);
            }
            let motion = &mut self.motion;
            let rates = [
                &mut self.motion_error.displacement,
                &mut self.motion_error.velocity,
                &mut self.motion_error.acceleration,
                &mut motion.velocity,
                &mut motion.acceleration,
                &mut motion.velocity_deviation,
                Arc::make_mut(&mut self.amplitude),
            ];
            for channel in rates {
                channel[samples.clone()]
                    .iter_mut()
                    .for_each(|value| *value *= gain);
            }
        }
    }

    /// The part that laws and effects see, without force, deviations and faults. A fit that moves the motion need not carry the
    /// rest.
    #[must_use]
    pub fn motion_alone(&self) -> Self {
        Self {
            name: self.name.clone(),
            motion: MotionEstimate {
                displacement: self.motion.displacement.clone(),
                velocity: self.motion.velocity.clone(),
                acceleration: self.motion.acceleration.clone(),
                velocity_deviation: Vec::new(),
                rests: Vec::new(),
                kinks: Vec::new(),
                ..self.motion
            },
            motion_error: MotionError::default(),
            carried: Vec::new(),
            unexplained: 0.0,
            force: Vec::new(),
            temperature: self.temperature.clone(),
            controls: self.controls.clone(),
            measured: Vec::new(),
            unsettled: Vec::new(),
            faults: Vec::new(),
            recorded: None,
            blocks: Vec::new(),
            cycles: self.cycles.clone(),
            amplitude: self.amplitude.clone(),
            ..*self
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.motion.displacement.len()
    }

    /// Never true for a trajectory that was constructed.
    pub fn is_empty(&self) -> bool {
        self.motion.displacement.is_empty()
    }

    /// Whether a sample tells laws apart: its force can be [compared](Self::is_comparable), it is not next to a kink, and its velocity
    /// is either certain enough for the law's steep |v|^α or certainly 0.
    pub fn is_telling(&self, index: usize) -> bool {
        let after = self.motion.kinks.partition_point(|&kink| kink + 1 < index);
        let at_kink = self
            .motion
            .kinks
            .get(after)
            .is_some_and(|kink| kink.abs_diff(index) <= 1);
        let certain = self.motion.velocity[index].abs()
            > TrajectoryPolicy::in_use().certain * self.motion.velocity_deviation[index];
        self.is_comparable(index) && (certain || self.motion.is_at_rest(index)) && !at_kink
    }

    /// The reading of the force channel for a true `force`, one value per sample.
    pub fn shown(&self, force: Vec<f64>) -> Vec<f64> {
        match &self.average {
            Some(average) => average.of(&force),
            None => force,
        }
    }

    /// Temperature at a sample, °C; 20 °C where none was measured.
    #[inline]
    pub fn temperature_at(&self, index: usize) -> f64 {
        self.temperature
            .as_ref()
            .map_or(TrajectoryPolicy::in_use().room, |temperature| {
                temperature[index]
            })
    }
}

/// Facts about a recording's channels that are known beforehand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known {
    /// Stated by the user.
    pub rig: RigFacts,
    /// Delay of the force in s, negative where it is early, as other recordings of the same rig show it.
    pub late: Option<f64>,
    /// The zero of the displacement, as other recordings of the same rig show it.
    pub zero: Option<Zero>,
}

impl Known {
    /// The zero of the displacement: what the user states goes before what other recordings show.
    fn zero(&self) -> Option<Zero> {
        self.rig.zero.map(Zero::from).or(self.zero)
    }
}

impl Cycles {
    /// [`Cycles::find`] with a band that suits the noise of `displacement`.
    pub fn of(displacement: &[f64], tick: f64) -> Self {
        Self::find(displacement, tick, hysteresis(displacement))
    }
}

/// Half width of the band around the mid level that a crossing has to leave, mm: above the noise, and below the smallest amplitude
/// that counts as motion.
fn hysteresis(displacement: &[f64]) -> f64 {
    let (low, high) = least_and_largest(displacement);
    let TrajectoryPolicy {
        crossing_noises,
        crossing,
        ..
    } = *TrajectoryPolicy::in_use();
    (crossing_noises * noise_deviation(displacement)).max(crossing * (high - low))
}
