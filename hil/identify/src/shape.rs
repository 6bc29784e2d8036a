//! The ranges within which shapes are searched, and the starts of a search, spread over the range that the data can show.

use crate::policy::policy;
use mesh_damper::effects::CONTROLS;
use mesh_damper_recording::trajectory::Trajectory;
mesh_damper_recording::numbers! {
    /// Within what ranges the parameters of effects are sought, and from how many starts.
    ShapePolicy {
        /// A value within this factor of an end of its range stands at it.
        at_end: f64 = 1.02, Convention("a fit ends a little inside");
        /// The shortest length is this many times the noise of the displacement: a smaller one cannot be told from an error of the
        /// velocity at a reversal.
        noises: f64 = 5.0, Tuned("the blind trial");
        /// The shortest length is this part of the amplitude where there is less noise.
        shortest: f64 = 1e-3, Tuned("the blind trial");
        /// The shortest length is at most this part of the amplitude.
        longest_shortest: f64 = 0.4, Derived("less than half of what is longest, so that a range is left to search in");
        /// A slip limit, the stretch at which a dashpot yields, and half a gap are at most this part of the amplitude.
        longest: f64 = 0.9, Convention("at the whole amplitude nothing slips or moves");
        /// Starts of the slip limit of one element.
        slip_starts: usize = 10, Tuned("the blind trial");
        /// The slip limit of Bouc and Wen is at most this part of the amplitude: it rounds the corner before.
        bouc_wen_longest: f64 = 2.0, Tuned("the blind trial");
        /// Starts of the slip limit of Bouc and Wen.
        bouc_wen_starts: usize = 8, Tuned("the blind trial");
        /// The range of the sharpness of Bouc and Wen.
        sharpness: [f64; 2] = [0.5, 8.0], Convention("from a parabola's corner to one that is as good as sharp");
        /// Starts of the sharpness of Bouc and Wen.
        sharpness_starts: [f64; 2] = [1.0, 2.5], Tuned("the blind trial");
        /// Friction that hardens has become stiffer by this many times its stiffness at 0 where its stretch ends.
        hardening: f64 = 4.0, Convention("five times as stiff as at 0 is beyond what a test reaches");
        /// It ends at this many amplitudes, at least and at most.
        stretch_limit: [f64; 2] = [1.0, 80.0], Derived("at the first it hardens as much as is allowed within the motion, at the second by a twentieth");
        /// Starts of that limit.
        stretch_limit_starts: usize = 3, Tuned("the Bouc–Wen benchmark");
        /// Range of its sharpness.
        hardening_sharpness: [f64; 2] = [0.5, 3.0], Convention("about the line that Bouc and Wen's has most often");
        /// Range of its loss.
        hardening_loss: [f64; 2] = [0.4, 160.0], Convention("a tenth of its hardening is hardly a loss, and the crate takes 200");
        /// Starts of its loss.
        hardening_loss_starts: usize = 2, Tuned("the Bouc–Wen benchmark");
        /// The largest slip limit of several elements is at least this many times the shortest length.
        iwan_shortest: f64 = 6.0, Tuned("the blind trial");
        /// Starts of the largest slip limit of several elements.
        iwan_starts: usize = 6, Tuned("the blind trial");
        /// Half a gap is at least this many times the shortest length.
        gap_shortest: f64 = 2.0, Tuned("the blind trial");
        /// Starts of half a gap.
        gap_starts: usize = 8, Tuned("the blind trial");
        /// A contact is beyond this part of the largest displacement to its side, and short of the rest of the second.
        contact: [f64; 2] = [0.02, 0.98], Tuned("the blind trial");
        /// Starts of a contact.
        contact_starts: usize = 16, Tuned("the blind trial");
        /// A spring in series is at least and at most this many times as stiff as the specimen: a softer one takes up more than the whole
        /// displacement.
        series: [f64; 2] = [1.3, 200.0], Tuned("the blind trial");
        /// Starts of a spring in series.
        series_starts: usize = 6, Tuned("the blind trial");
        /// A delay is at least this part of a tick.
        shortest_delay: f64 = 0.02, Tuned("the blind trial");
        /// A delay is at most this part of the longest period.
        longest_delay: f64 = 0.2, Tuned("the blind trial");
        /// A delay is at most this many ticks.
        longest_delay_in_ticks: f64 = 250.0, Derived("what the crate remembers");
        /// Starts of a delay.
        delay_starts: usize = 9, Tuned("the blind trial");
        /// A drift settles within at least this many cycles.
        shortest_drift: f64 = 0.3, Tuned("the blind trial");
        /// A drift settles within at most this many times the cycles recorded.
        longest_drift: f64 = 10.0, Convention("longer, and it is a straight line");
        /// Starts of a drift.
        drift_starts: usize = 8, Tuned("the blind trial");
        /// A Maxwell branch relaxes in at least this part of a tick.
        shortest_relaxation: f64 = 0.5, Derived("faster, and it has relaxed at the next");
        /// Starts of a branch's time.
        relaxation_starts: usize = 12, Tuned("the blind trial");
        /// A dashpot yields at a stretch of at least this part of the amplitude.
        shortest_yield: f64 = 1e-3, Convention("the spring is then as good as rigid");
        /// Starts of that stretch.
        yield_starts: usize = 4, Convention("four times the one before: a fit goes on from there");
        /// A dashpot yields at a rate of at least and at most this part of the largest velocity.
        yield_rate: [f64; 2] = [0.01, 3.0], Derived("at the first it slips nearly at once, at the second tanh of a third is a line within a twenty-fifth");
        /// Starts of that rate.
        yield_rate_starts: usize = 3, Convention("four times the one before: a fit goes on from there");
        /// The viscosity over the stiffness is at least and at most this many times the amplitude over the largest velocity, about the time of a
        /// swing.
        yield_time: [f64; 2] = [1e-4, 3.0], Derived("at the first it adds less to the force than the shortest stretch, at the second the dashpot hardly moves");
        /// Starts of that time.
        yield_time_starts: usize = 1, Convention("the stretch and the rate say where the dashpot yields");
        /// The lag of a control input is at least this part of a tick.
        shortest_lag: f64 = 0.5, Derived("shorter, and it is all there at the next");
        /// That lag is at most this part of a recording.
        longest_lag: f64 = 0.2, Convention("a fifth: what is later has hardly been seen twice");
        /// Starts of that lag.
        lag_starts: usize = 4, Convention("some seven times the one before: a fit goes on from there");
        /// The strength of a control input saturates at least and at most at this many times the largest input.
        saturation: [f64; 2] = [0.1, 10.0], Derived("at the first the largest does 10/11 of all that there is, at the last a tenth less than a line");
        /// Starts of that saturation.
        saturation_starts: usize = 2, Convention("below and above the largest input");
        /// Starts of the slip limit behind a play.
        backlash_starts: usize = 4, Convention("three times the one before: a fit goes on from there");
        /// Half a play is at least this part of the amplitude.
        shortest_slack: f64 = 0.02, Tuned("the blind trial: a shorter one rounds the corner of a slider as a tick does that falls into it");
        /// Starts of the play.
        slack_starts: usize = 3, Convention("four times the one before: a fit goes on from there");
        /// A spring that degrades has lost half of its stiffness after at least and at most this many amplitudes.
        softening: [f64; 2] = [0.03, 10.0], Derived("at the first it has as good as the same force at every largest displacement, at the second it loses an eleventh");
        /// Starts of that displacement.
        softening_starts: usize = 4, Convention("three times the one before: a fit goes on from there");
        /// Range of its pinching.
        pinching: [f64; 2] = [0.02, 1.0], Convention("less is a spring that does not pinch, and there is no more than all of it");
        /// Starts of its pinching.
        pinching_starts: usize = 2, Convention("the softening is known by then");
        /// Starts of the slip limit of a slider that weakens.
        weakening_starts: usize = 6, Convention("two to three times the one before: a fit goes on from there");
        /// Range of the part of its strength that it loses.
        strength_loss: [f64; 2] = [0.05, 1.0], Convention("less is a slider that does not weaken, and there is no more than all of it");
        /// Starts of that part.
        strength_loss_starts: [f64; 2] = [0.3, 0.7], Convention("a third and two thirds");
        /// It has lost half of that after at least this energy of the first cycles, and at most this many times that of all.
        loss_energy: [f64; 2] = [0.1, 3.0], Convention("within a cycle, and later than any that is recorded");
        /// Starts of that energy.
        loss_energy_starts: usize = 3, Convention("as few as tell soon from late");
        /// With ω·time below this at the highest frequency a branch is a dashpot.
        dashpot: f64 = 0.2, Tuned("the blind trial; a branch then differs from its dashpot by ωτ/√(1 + ω²τ²), a fifth");
        /// With ω·time above this at the lowest frequency a branch is a spring.
        spring: f64 = 10.0, Tuned("the blind trial; a branch then differs from its spring by 1/√(1 + ω²τ²), a tenth");
        /// The highest frequency is more than this many times the lowest where there are several.
        several: f64 = 1.2, Tuned("the blind trial");
        /// A tone has at least this many periods in a recording.
        fewest_periods: f64 = 4.0, Convention("fewer are a drift");
        /// A tone has at most this many cycles a sample.
        highest_tone: f64 = 0.499, Derived("half of the sampling rate");
    }
}

/// Range and starts of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Starts of a search.
    pub starts: Vec<f64>,
    /// Below this, the data cannot distinguish the effect from a simpler one.
    pub simple_below: f64,
    /// Above this, the same.
    pub simple_above: f64,
}

impl Shape {
    /// `count` starts spread evenly over the logarithm of the range; the outermost ones lie one step inside.
    pub(crate) fn spread(low: f64, high: f64, count: usize) -> Self {
        let step = (high / low).powf(1.0 / (count + 1) as f64);
        Self {
            low,
            high,
            starts: (1..=count).map(|i| low * step.powi(i as i32)).collect(),
            simple_below: policy().shape.at_end * low,
            simple_above: high / policy().shape.at_end,
        }
    }

    /// Whether the effect with this value cannot be distinguished from a simpler one.
    pub fn is_limit(&self, value: f64) -> bool {
        value < self.simple_below || value > self.simple_above
    }
}

/// The ranges of the recordings of a fit: they limit the effects that can be found.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// Largest displacement either way, mm.
    pub(crate) above: f64,
    pub(crate) below: f64,
    pub(crate) amplitude: f64,
    /// s
    pub(crate) duration: f64,
    /// Longest, s.
    pub(crate) tick: f64,
    /// Noise of the displacement, mm.
    pub(crate) noise: f64,
    pub(crate) cycles: f64,
    /// Hz
    pub(crate) lowest_frequency: f64,
    pub(crate) highest_frequency: f64,
    /// Largest, mm/s.
    pub(crate) velocity: f64,
    /// Largest force over largest displacement, kN/mm.
    pub(crate) stiffness: f64,
    /// Largest control input either way, by places, in its own unit.
    pub(crate) inputs: [f64; CONTROLS],
    /// Tones that stand out in the residual of eq 13, Hz.
    pub(crate) tones: Vec<f64>,
}

impl Extent {
    /// The extent of `trajectories`.
    pub fn of(trajectories: &[Trajectory]) -> Self {
        let displacement = || {
            trajectories
                .iter()
                .flat_map(|t| t.motion.displacement.iter().copied())
        };
        let force = largest(
            trajectories
                .iter()
                .flat_map(|t| t.force.iter().map(|force| force.abs())),
        );
        let frequencies = || {
            let blocks = trajectories.iter().flat_map(|t| &t.blocks);
            blocks.map(|block| block.frequency)
        };
        let (above, below) = (largest(displacement()), largest(displacement().map(|y| -y)));
        Self {
            above,
            below,
            amplitude: largest(
                trajectories
                    .iter()
                    .flat_map(|t| t.amplitude.iter().copied()),
            ),
            duration: largest(trajectories.iter().map(|t| t.len() as f64 * t.tick)),
            tick: largest(trajectories.iter().map(|t| t.tick)),
            noise: largest(trajectories.iter().map(|t| t.motion.noise)),
            cycles: largest(trajectories.iter().filter_map(|t| t.cycles.last().copied())),
            lowest_frequency: frequencies().fold(f64::INFINITY, f64::min),
            highest_frequency: largest(frequencies()),
            velocity: largest(
                trajectories
                    .iter()
                    .flat_map(|t| t.motion.velocity.iter().map(|velocity| velocity.abs())),
            ),
            stiffness: force / above.max(below),
            inputs: std::array::from_fn(|place| {
                let channels = trajectories.iter().filter_map(|t| t.controls.get(place));
                largest(channels.flat_map(|channel| channel.values.iter().map(|u| u.abs())))
            }),
            tones: Vec::new(),
        }
    }

    /// The same extent with the starting tones of a search, Hz.
    #[must_use]
    pub fn with_tones(&self, tones: Vec<f64>) -> Self {
        Self {
            tones,
            ..self.clone()
        }
    }

    /// The shortest length of the search, mm. A length below the noise cannot be distinguished from an error of the velocity at a
    /// reversal.
    pub(crate) fn shortest(&self) -> f64 {
        let policy = &policy().shape;
        (policy.noises * self.noise)
            .max(policy.shortest * self.amplitude)
            .min(policy.longest_shortest * self.amplitude)
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::MIN_POSITIVE, f64::max)
}
