//! Whether a law is passive: whether it gives out no more energy in a closed cycle than it absorbs. Every specimen is passive, and
//! a rig driven by an active law does not stay where it should.
//!
//! A [`Passivity`] moves the law through sines over the operating range, and sums ∮F dy by trapezoids:
//!
//! Σ (Fₙ + Fₙ₊₁)/2·(yₙ₊₁ − yₙ) over the second of two cycles. The first cycle brings the law to a loop that closes.
//!
//! Effects whose description allows them to supply energy
//! ([`Description::supplies_energy`](crate::effects::description::Description)) are left out: a tone, a delay, a force channel's
//! low-pass. A spring in series is left out too, because it returns the energy that it absorbs.
//!
//! Effects with a memory of time run with longer ticks, 2ⁿ times those that they were made for, so that a cycle has 16 to 30 ticks.
//! Inputs other than the motion are held constant: the temperature, the cycles, and the control inputs. A law that depends on
//! cycles or control inputs is checked twice: at cycle 0 with inputs of 1, and at the largest number of cycles with inputs of 0. A
//! law that depends on the temperature is checked at 20 °C, and at the coldest and the hottest temperature that a
//! [`rig`](crate::rig::RigSettings::temperature_range) accepts by default. Between these temperatures a law that is linear in the
//! temperature is no worse.
//!
//! The check is only as fine as its grid: it does not find a negative energy that exists only between the amplitudes and
//! frequencies of the grid.
//!
//! ```
//! use mesh_damper::effects::{AugmentedLaw, Effect, Viscous};
//! use mesh_damper::fast_law::FastLaw;
//! use mesh_damper::law::Law;
//! use mesh_damper::passivity::Passivity;
//!
//! // A dashpot below 0 parallel to friction: passive where the motion is slow.
//! let law = AugmentedLaw::<f32, 1>::new(Law::new(1.6, 0.0, 0.1, 0.3)?);
//! let law = FastLaw::new(law.with(Effect::Viscous(Viscous::new(-0.5)?))?);
//! let active = Passivity::new(None, 1e4).check(&law).unwrap_err();
//! assert_eq!(active.amplitude, 0.3);
//! assert!((active.frequency - 20.0).abs() < 1.0);
//! # Ok::<(), mesh_damper::error::ConfigError>(())
//! ```

use core::fmt;

use crate::effects::{AugmentedLaw, AugmentedState, CONTROLS, Motion};
use crate::fast_law::FastLaw;
use crate::law::Law;
use crate::limits;
use crate::operating_range::OperatingRange;
use crate::real::Real;
use crate::rig;
use crate::sine::FREQUENCY_MIN;

/// Upper end of the range assumed if none is known: amplitude in mm and frequency in Hz. The paper's specimens were tested at 0.02
/// to 0.3 mm and 0.5 to 20 Hz.
const PAPER: [f32; 2] = [0.3, 20.0];
/// Parts of the largest amplitude: down to the paper's least.
const AMPLITUDES: [f32; 3] = [1.0, 0.25, 0.0625];
/// Parts of the highest frequency: down to about the paper's lowest.
const FREQUENCIES: [f32; 3] = [1.0, 0.158, 0.025];
/// Loops per state of cycles, control inputs and temperature.
const OF_STATE: usize = AMPLITUDES.len() * FREQUENCIES.len();
/// Least points of a cycle, and the number from which the ticks are doubled instead. The number of points is even, so that an
/// elastic force returns over the same points.
const POINTS: [u32; 2] = [16, 32];
/// A loop whose energy is below 0 is computed again with four times the points, up to this number. With it the trapezoids of a loop
/// without area are exact within [`TOLERANCE`].
const FINEST: u32 = 2000;
/// Accepted tick rates, Hz.
const TICK_RATES: [f32; 2] = [1e-3, 1e7];
/// The usual, the coldest and the hottest temperature, °C.
const TEMPERATURES: [f32; 3] = [
    20.0,
    rig::TEMPERATURES[0] as f32,
    rig::TEMPERATURES[1] as f32,
];
/// Negative energy that counts as rounding, as a part of Σ|F dy|, in which the law's own forces are counted in addition. Derived:
/// 2⁻²⁴ for each rounding of a term, times the number that tests of all laws that are passive by construction require
/// (`tests/laws/passivity.rs`).
const TOLERANCE: f32 = 1e-4;

/// A motion in which a law gives out more energy than it absorbs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Active {
    /// mm
    pub amplitude: f32,
    /// Hz
    pub frequency: f32,
}

impl fmt::Display for Active {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "it gives more energy than it takes in a cycle of {} mm at {} Hz",
            self.amplitude, self.frequency
        )
    }
}

impl core::error::Error for Active {}

/// A check of a [`FastLaw`] that can run in slices.
#[derive(Clone, Debug)]
pub struct Passivity<const N: usize> {
    /// The law's effects, for the ticks of this loop.
    law: AugmentedLaw<f32, N>,
    state: AugmentedState<f32>,
    /// Middle of the range, and its largest amplitude, mm.
    middle: f32,
    largest: f32,
    /// Highest frequency, Hz, which belongs to the largest amplitude.
    fastest: f32,
    tick_rate: f32,
    /// Index of the loop in the grid.
    place: usize,
    cycle: Option<Cycle>,
    /// Whether the check has ended, and separately the motion that was not passive. In a single `Option` not all bits would be 0 at
    /// the start.
    ended: bool,
    active: Option<Active>,
}

/// A loop in progress.
#[derive(Clone, Copy, Debug)]
struct Cycle {
    amplitude: f32,
    /// Hz
    frequency: f32,
    points: u32,
    /// Number of doublings of the tick's length.
    doublings: u32,
    /// Slices before the first point: one puts the effects to rest, and each of the others doubles the ticks.
    left: u32,
    /// The next point, of two cycles plus one point.
    point: u32,
    /// The last displacement and force.
    before: [f32; 2],
    /// ΣF dy, and Σ|F dy| with that of the law's own forces added, J.
    energy: f32,
    moved: f32,
}

impl<const N: usize> Passivity<N> {
    /// * `range`: the motion on which the law was fitted. `None`, or a range without motion: up to 0.3 mm and 20 Hz, those of the
    ///   paper's tests
    /// * `tick_rate`: that for which the law's effects are made, Hz, 1e-3…1e7; clamped to this range
    ///
    /// The lowest amplitude is a 16th of the largest, the lowest frequency a 40th of the highest.
    pub fn new(range: Option<&OperatingRange<f32>>, tick_rate: f32) -> Self {
        let mut new = Self::EMPTY;
        new.begin(range, tick_rate);
        new
    }

    /// A check whose range [`Passivity::begin`] sets; without that it is the paper's range at 10 kHz. All bits are 0, so that it
    /// takes no flash in a static.
    pub const EMPTY: Self = Self {
        law: AugmentedLaw::new(Law::from_valid(0.0, 0.0, 0.0, 0.0)),
        state: AugmentedState::AT_REST,
        middle: 0.0,
        largest: 0.0,
        fastest: 0.0,
        tick_rate: 0.0,
        place: 0,
        cycle: None,
        ended: false,
        active: None,
    };

    /// [`Passivity::new`] in place.
    pub fn begin(&mut self, range: Option<&OperatingRange<f32>>, tick_rate: f32) {
        let [slowest, fastest] = TICK_RATES;
        self.tick_rate = if tick_rate > slowest {
            if tick_rate < fastest {
                tick_rate
            } else {
                fastest
            }
        } else {
            slowest
        };
        [self.middle, self.largest, self.fastest] = range
            .and_then(of_range)
            .unwrap_or([0.0, PAPER[0], PAPER[1]]);
        self.place = 0;
        self.cycle = None;
        self.ended = false;
        self.active = None;
    }

    /// Runs the whole check: several hundred forces of `law`, too many for one tick.
    ///
    /// # Errors
    /// The motion in which the law is active.
    pub fn check(&mut self, law: &FastLaw<N>) -> Result<(), Active> {
        loop {
            if let Some(verdict) = self.step(law) {
                return verdict;
            }
        }
    }

    /// Runs the next slice: one force of `law`, a copy of its effects, or a doubling of their ticks. `law` must be the same from
    /// the first slice to the last. Returns the verdict once there is one, and the same again from then on.
    // Not inlined, so that its stack adds to no other slice of a load.
    #[inline(never)]
    pub fn step(&mut self, law: &FastLaw<N>) -> Option<Result<(), Active>> {
        if self.ended {
            return self.verdict();
        }
        if self.tick_rate == 0.0 {
            self.begin(None, 1e4);
        }
        match self.cycle.take() {
            None => self.begin_cycle(law.augmented()),
            Some(cycle) if cycle.left > 0 => {
                if cycle.left > cycle.doublings {
                    self.state = AugmentedState::AT_REST;
                } else {
                    self.law.halve_rate();
                }
                self.cycle = Some(Cycle {
                    left: cycle.left - 1,
                    ..cycle
                });
            }
            Some(cycle) if cycle.point <= 2 * cycle.points => {
                self.cycle = Some(self.moved(cycle, law));
            }
            Some(cycle) => self.judge(law.augmented(), cycle),
        }
        self.verdict()
    }

    fn verdict(&self) -> Option<Result<(), Active>> {
        self.ended.then(|| self.active.map_or(Ok(()), Err))
    }

    /// Begins the first or the next loop, or ends the check.
    fn begin_cycle(&mut self, law: &AugmentedLaw<f32, N>) {
        let temperatures = match law.depends_on_temperature() {
            true => TEMPERATURES.len(),
            false => 1,
        };
        // The second state is skipped where nothing depends on it.
        if !law.has_parameters_of_state() && self.state() == 1 {
            self.place += OF_STATE;
        }
        if self.place >= 2 * OF_STATE * temperatures {
            self.ended = true;
            return;
        }
        let place = self.place % OF_STATE;
        let part = |of: &[f32; 3], place: usize| of.get(place).copied().unwrap_or(1.0);
        let amplitude = part(&AMPLITUDES, place % AMPLITUDES.len()) * self.largest;
        let frequency = part(&FREQUENCIES, place / AMPLITUDES.len()) * self.fastest;
        // The number of ticks in a cycle, with ticks doubled until it fits.
        let mut ticks = self.tick_rate / frequency;
        let mut doublings = 0;
        let [least, most] = POINTS.map(|points| points as f32);
        while ticks >= most {
            ticks *= 0.5;
            doublings += 1;
        }
        let ticks = if ticks > least { ticks } else { least };
        self.start(
            law,
            amplitude,
            frequency,
            2 * (0.5 * ticks + 0.5) as u32,
            doublings,
        );
    }

    /// Index of the state of cycles and control inputs: 0 or 1.
    fn state(&self) -> usize {
        self.place / OF_STATE % 2
    }

    /// Starts at rest in the middle, where the motion is fastest, which is close to the closed loop.
    fn start(
        &mut self,
        law: &AugmentedLaw<f32, N>,
        amplitude: f32,
        frequency: f32,
        points: u32,
        doublings: u32,
    ) {
        law.write_judged(&mut self.law);
        self.cycle = Some(Cycle {
            amplitude,
            frequency,
            points,
            doublings,
            left: doublings + 1,
            point: 0,
            before: [0.0; 2],
            energy: 0.0,
            moved: 0.0,
        });
    }

    fn moved(&mut self, cycle: Cycle, law: &FastLaw<N>) -> Cycle {
        let motion = self.motion(&cycle);
        let force = self.force(law, &motion);
        let y = motion.displacement;
        let [y_before, force_before] = cycle.before;
        let mut next = Cycle {
            point: cycle.point + 1,
            before: [y, force],
            ..cycle
        };
        if cycle.point > cycle.points {
            let work = 0.5 * (force + force_before) * (y - y_before);
            next.energy += work;
            // The forces that may cancel: effects subtract from the law's own forces.
            let own = self.law.law().elastic_force(y).abs()
                + law
                    .damping()
                    .damping_force(motion.velocity.clamped(limits::VELOCITY as f32))
                    .abs();
            next.moved += work.abs() + own * (y - y_before).abs();
        }
        next
    }

    /// y = A·sin θ about the middle, at this point of the cycle.
    fn motion(&self, cycle: &Cycle) -> Motion<f32> {
        // The number of points is not 0, but a plain division would link code for a panic.
        let point = u64::from(cycle.point.checked_rem(cycle.points).unwrap_or_default());
        let each = u64::MAX.checked_div(cycle.points.into());
        let phase = each.unwrap_or_default().wrapping_mul(point);
        let sine = f32::sine(phase);
        let cosine = f32::sine(phase.wrapping_add(1 << 62));
        let omega = core::f32::consts::TAU * cycle.frequency;
        let (control, held) = match self.state() {
            0 => (1.0, 0.0),
            _ => (0.0, limits::CYCLES as f32),
        };
        let temperature = TEMPERATURES.get(self.place / (2 * OF_STATE));
        // Cycles advance only for a law that takes the frequency from them.
        let cycles = if self.law.is_over_frequency() {
            point as f32 / cycle.points as f32
        } else {
            held
        };
        Motion {
            displacement: self.middle + cycle.amplitude * sine,
            velocity: cycle.amplitude * omega * cosine,
            acceleration: -cycle.amplitude * omega * omega * sine,
            cycles,
            temperature: temperature.copied().unwrap_or_default(),
            controls: [control; CONTROLS],
        }
    }

    /// Not inlined, so that other slices do not save its registers.
    #[inline(never)]
    fn force(&mut self, law: &FastLaw<N>, motion: &Motion<f32>) -> f32 {
        let motion = motion.clamped();
        let damping = |v| law.damping().damping_force(v);
        self.law
            .force_through_stages(&mut self.state, &motion, self.law.law(), damping)
    }

    fn judge(&mut self, law: &AugmentedLaw<f32, N>, cycle: Cycle) {
        let Cycle {
            amplitude,
            frequency,
            points,
            doublings,
            ..
        } = cycle;
        // NaN is not passive.
        if cycle.energy >= -TOLERANCE * cycle.moved {
            self.place += 1;
        } else if doublings >= 2 && points < FINEST / 4 {
            self.start(law, amplitude, frequency, 4 * points, doublings - 2);
        } else {
            self.ended = true;
            self.active = Some(Active {
                amplitude,
                frequency,
            });
        }
    }
}

/// Middle and amplitude in mm of `range`, and the frequency in Hz at which that amplitude reaches the range's velocity; `None`
/// without a motion.
fn of_range(range: &OperatingRange<f32>) -> Option<[f32; 3]> {
    let most = limits::DISPLACEMENT as f32;
    let [low, high] = range.displacement().map(|end| end.clamped(most));
    let [slowest, fastest] = range.velocity().map(|end| end.abs());
    let amplitude = 0.5 * (high - low);
    let speed = if fastest > slowest { fastest } else { slowest };
    let frequency = speed.clamped(limits::VELOCITY as f32) / (core::f32::consts::TAU * amplitude);
    (amplitude > 0.0 && frequency >= FREQUENCY_MIN as f32 && frequency.is_finite()).then_some([
        0.5 * (low + high),
        amplitude,
        frequency,
    ])
}
