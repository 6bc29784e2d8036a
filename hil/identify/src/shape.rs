//! The ranges within which shapes are searched, and the starts of a search, spread over the range that the data can show.

use mesh_damper::effects::CONTROLS;
use mesh_damper_recording::trajectory::Trajectory;

mesh_damper_recording::numbers! {
    /// The ranges in which the parameters of effects are searched for, and the starting values.
    ShapePolicy {
        /// A parameter within this factor of an end of its range is at the end: the effect cannot be told from a simpler one.
        at_end: f64 = 1.02, Convention("a fit ends slightly inside the range");
        /// The shortest length that is searched for is at least this many times the noise of the displacement: a shorter one cannot be told
        /// from an error of the velocity at a reversal.
        noises: f64 = 5.0, Tuned("the blind trial");
        /// The shortest length that is searched for is at least this fraction of the amplitude, however small the noise.
        shortest: f64 = 1e-3, Tuned("the blind trial");
        /// The shortest length that is searched for is at most this fraction of the amplitude, however large the noise.
        longest_shortest: f64 = 0.4, Derived("less than half of the longest length (`longest`), so that a range remains for the search");
        /// A slip limit, the yield stretch of a dashpot, and half a gap are at most this fraction of the amplitude.
        longest: f64 = 0.9, Convention("at the whole amplitude nothing slips or moves");
        /// Number of starting values of the slip limit of a single stick-slip element.
        slip_starts: usize = 10, Tuned("the blind trial");
        /// The slip limit of a Bouc–Wen element is at most this multiple of the amplitude: the element rounds the corner before its limit.
        bouc_wen_longest: f64 = 2.0, Tuned("the blind trial");
        /// Number of starting values of the slip limit of a Bouc–Wen element.
        bouc_wen_starts: usize = 8, Tuned("the blind trial");
        /// Smallest and largest sharpness of a Bouc–Wen element.
        sharpness: [f64; 2] = [0.5, 8.0], Convention("from the corner of a parabola to a practically sharp one");
        /// Starting values of the sharpness of a Bouc–Wen element.
        sharpness_starts: [f64; 2] = [1.0, 2.5], Tuned("the blind trial");
        /// The stiffness of hardening friction at its stretch limit exceeds the stiffness at 0 by this many times the latter.
        hardening: f64 = 4.0, Convention("five times the stiffness at 0 is beyond what a test reaches");
        /// Smallest and largest stretch limit of hardening friction, in amplitudes.
        stretch_limit: [f64; 2] = [1.0, 80.0],
            Derived("at the first it hardens within the motion by all that is allowed, at the second by a twentieth of that");
        /// Number of starting values of the stretch limit of hardening friction.
        stretch_limit_starts: usize = 3, Tuned("the Bouc–Wen benchmark");
        /// Smallest and largest sharpness of hardening friction.
        hardening_sharpness: [f64; 2] = [0.5, 3.0], Convention("about 1, the straight line that Bouc–Wen models most often have");
        /// Smallest and largest loss of hardening friction, in the units of its hardening.
        hardening_loss: [f64; 2] = [0.4, 160.0], Convention("a tenth of the hardening is hardly a loss, and the crate accepts up to 200");
        /// Number of starting values of the loss of hardening friction.
        hardening_loss_starts: usize = 2, Tuned("the Bouc–Wen benchmark");
        /// The largest slip limit of several stick-slip elements (an Iwan model) is at least this many times the shortest length that is
        /// searched for.
        iwan_shortest: f64 = 6.0, Tuned("the blind trial");
        /// Number of starting values of the largest slip limit of several stick-slip elements (an Iwan model).
        iwan_starts: usize = 6, Tuned("the blind trial");
        /// Half a gap is at least this many times the shortest length that is searched for.
        gap_shortest: f64 = 2.0, Tuned("the blind trial");
        /// Number of starting values of half a gap.
        gap_starts: usize = 8, Tuned("the blind trial");
        /// Smallest and largest distance of a contact, as fractions of the largest displacement to its side.
        contact: [f64; 2] = [0.02, 0.98], Tuned("the blind trial");
        /// Number of starting values of the distance of a contact.
        contact_starts: usize = 16, Tuned("the blind trial");
        /// Smallest and largest stiffness of a spring in series, as multiples of the specimen's: a softer spring takes up more than the
        /// whole displacement.
        series: [f64; 2] = [1.3, 200.0], Tuned("the blind trial");
        /// Number of starting values of the stiffness of a spring in series.
        series_starts: usize = 6, Tuned("the blind trial");
        /// A delay is at least this fraction of a tick.
        shortest_delay: f64 = 0.02, Tuned("the blind trial");
        /// A delay is at most this fraction of the longest period.
        longest_delay: f64 = 0.2, Tuned("the blind trial");
        /// A delay is at most this many ticks.
        longest_delay_in_ticks: f64 = 250.0, Derived("the crate remembers no more");
        /// Number of starting values of a delay.
        delay_starts: usize = 9, Tuned("the blind trial");
        /// A drift settles within at least this many cycles.
        shortest_drift: f64 = 0.3, Tuned("the blind trial");
        /// A drift settles within at most this many times the recorded cycles.
        longest_drift: f64 = 10.0, Convention("a longer drift is a straight line");
        /// Number of starting values of the cycles of a drift.
        drift_starts: usize = 8, Tuned("the blind trial");
        /// The relaxation time of a Maxwell branch is at least this fraction of a tick.
        shortest_relaxation: f64 = 0.5, Derived("a faster branch has relaxed at the next tick");
        /// Number of starting values of the relaxation time of a Maxwell branch.
        relaxation_starts: usize = 12, Tuned("the blind trial");
        /// The stretch at which a dashpot yields is at least this fraction of the amplitude.
        shortest_yield: f64 = 1e-3, Convention("its spring is then practically rigid");
        /// Smallest and largest rate at which a dashpot yields, as fractions of the largest velocity.
        yield_rate: [f64; 2] = [0.01, 3.0],
            Derived("at the first it slips nearly at once, at the second tanh(1/3) is a straight line to within 1/25");
        /// Smallest and largest ratio of viscosity to stiffness of a yielding dashpot, as multiples of amplitude/largest velocity, about
        /// the time of a swing.
        yield_time: [f64; 2] = [1e-4, 3.0],
            Derived("at the first it adds less to the force than the shortest stretch, at the second the dashpot hardly moves");
        /// The lag of a control input is at least this fraction of a tick.
        shortest_lag: f64 = 0.5, Derived("after a shorter lag all of the input has arrived at the next tick");
        /// The lag of a control input is at most this fraction of the longest recording.
        longest_lag: f64 = 0.2, Convention("a fifth: a longer lag has hardly been seen twice");
        /// Smallest and largest saturation of a control input, as multiples of the largest input.
        saturation: [f64; 2] = [0.1, 10.0],
            Derived("at the first the largest input has 10/11 of its final strength, at the second a tenth less than on a straight line");
        /// Half of a free play is at least this fraction of the amplitude.
        shortest_slack: f64 = 0.02,
            Tuned("the blind trial: a shorter play rounds the corner of a slider just as a tick does that falls into the corner");
        /// A spring that degrades has lost half of its stiffness at a largest displacement between these two, in amplitudes.
        softening: [f64; 2] = [0.03, 10.0],
            Derived("at the first the force is practically the same at every largest displacement, at the second it loses an eleventh");
        /// Smallest and largest pinching of a spring that degrades: the fraction by which it is softer near 0.
        pinching: [f64; 2] = [0.02, 1.0], Convention("less is practically no pinching, and 1 is all of the stiffness");
        /// Smallest and largest fraction of its strength that a weakening slider finally loses.
        strength_loss: [f64; 2] = [0.05, 1.0], Convention("less is practically no weakening, and 1 is all of the strength");
        /// A weakening slider has lost half of its final loss after an energy between the first number times that of one cycle and the
        /// second number times that of all cycles.
        loss_energy: [f64; 2] = [0.1, 3.0], Convention("from within one cycle to later than all that are recorded");
        /// A Maxwell branch cannot be told from a dashpot if ω·(relaxation time) is below this at the highest frequency.
        dashpot: f64 = 0.2, Tuned("the blind trial; such a branch differs from its dashpot by ωτ/√(1 + ω²τ²), a fifth");
        /// A Maxwell branch cannot be told from a spring if ω·(relaxation time) is above this at the lowest frequency.
        spring: f64 = 10.0, Tuned("the blind trial; such a branch differs from its spring by 1/√(1 + ω²τ²), a tenth");
        /// The tests `dashpot` and `spring` apply only if the highest frequency is at least this many times the lowest.
        several: f64 = 1.2, Tuned("the blind trial");
        /// A tone has at least this many periods in the longest recording.
        fewest_periods: f64 = 4.0, Convention("a tone with fewer is a drift");
        /// A tone has at most this many cycles per sample.
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
            simple_below: ShapePolicy::in_use().at_end * low,
            simple_above: high / ShapePolicy::in_use().at_end,
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
        let policy = ShapePolicy::in_use();
        (policy.noises * self.noise)
            .max(policy.shortest * self.amplitude)
            .min(policy.longest_shortest * self.amplitude)
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::MIN_POSITIVE, f64::max)
}
