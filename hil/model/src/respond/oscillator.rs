//! The time steps of a mass on a damper.
//!
//! M·a = f − F(y, w): y is the displacement of the mass from the base, w its rate, and a the mass's own acceleration. The backward
//! differences of second order (BDF2) give y, b and a from the rate at the end of the step:
//!
//! y = Y + g·w, b = B + g·ḃ, a = (w + ḃ − V)/g, with g = 2Δt/3 and Y = (4y₋₁ − y₋₂)/3; V and B are the same for v = w + ḃ and for
//! b.
//!
//! So w is the only unknown. Its equation rises at least by M/g as long as no spring gives way, and this gives a bracket. The first
//! step is a backward Euler step.
//!
//! A trapezoidal step would keep the energy of a spring exactly, but with the steep |v|^α the velocity would change its sign at
//! every step where friction holds. BDF2 damps motions that are faster than its step. It takes the fraction (ωΔt)⁴/4 of a spring's
//! motion per step: a millionth per cycle with 400 steps in a cycle.
//!
//! # Rest
//! At w = 0 friction takes any value between its values in the two directions. If the balance lies between them, w is 0 and the
//! friction balances the other forces.

use mesh_damper::effects::{AugmentedLaw, AugmentedState, CONTROLS, Motion};
use mesh_damper::limits;

use super::root::root;
use super::running::Running;
use super::specimen::{PER_KILOGRAM, Specimen};
use super::{Moment, RespondError};
use crate::MAX_EFFECTS;

/// A speed that is practically 0, mm/s: the friction on either side of rest is evaluated here.
const CREEP: f64 = 1e-12;
/// A balance has to close to this fraction of the largest force so far.
const NEAR: f64 = 1e-12;
/// How often a bracket without a root is doubled.
const WIDENINGS: usize = 60;

/// The excitation at one time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Input {
    /// Force on the mass, kN.
    pub force: f64,
    /// Displacement of the base, mm.
    pub base: f64,
    /// Temperature, °C.
    pub temperature: f64,
    /// Control inputs.
    pub controls: [f64; CONTROLS],
}

/// Where the mass is at the end of a step.
#[derive(Clone, Copy, Debug)]
struct Place {
    relative: f64,
    rate: f64,
    velocity: f64,
    base: f64,
}

/// A mass on a damper as it moves.
pub(super) struct Oscillator<'s> {
    specimen: &'s Specimen,
    /// kN·s²/mm
    mass: f64,
    step: f64,
    law: AugmentedLaw<f64, MAX_EFFECTS>,
    state: AugmentedState<f64>,
    running: Running,
    /// Amplitude in mm of the law's current coefficients, and the amplitude for the time after the middle of the swing.
    amplitude: f64,
    next_amplitude: Option<f64>,
    steps: usize,
    now: Place,
    before: Place,
    /// The largest force so far, kN.
    scale: f64,
}

impl<'s> Oscillator<'s> {
    /// Starts at `displacement` mm from the base with `velocity` mm/s, under `input`, on a base that moves with `base_velocity`
    /// mm/s. Its steps take `step` s.
    ///
    /// # Errors
    /// A model that the crate refuses.
    pub fn new(
        specimen: &'s Specimen,
        step: f64,
        [displacement, velocity]: [f64; 2],
        (input, base_velocity): (&Input, f64),
    ) -> Result<(Self, Moment), RespondError> {
        let amplitude = specimen
            .model
            .law
            .first()
            .map_or(0.0, |node| node.amplitude);
        let law = specimen.model.augmented::<f64>(amplitude, step)?;
        let now = Place {
            relative: displacement,
            rate: velocity - base_velocity,
            velocity,
            base: input.base,
        };
        let mut new = Self {
            specimen,
            mass: PER_KILOGRAM * specimen.moving_mass(),
            step,
            state: law.at_rest(),
            law,
            running: Running::default(),
            amplitude,
            next_amplitude: None,
            steps: 0,
            now,
            before: now,
            scale: f64::MIN_POSITIVE,
        };
        new.running.update(displacement, step);
        let mut force = new.tried(displacement, now.rate, input);
        if now.rate == 0.0 {
            // Friction holds as far as it can.
            let [back, forth] = [-CREEP, CREEP].map(|rate| new.tried(displacement, rate, input));
            if back < forth {
                force = input.force.clamp(back, forth);
            }
        }
        let motion = new.motion(displacement, now.rate, input);
        new.law.force(&mut new.state, &motion);
        new.scale = new.scale.max(force.abs()).max(input.force.abs());
        let moment = new.moment((input.force - force) / new.mass, force, input);
        Ok((new, moment))
    }

    /// Makes one step, to the time of `input`.
    ///
    /// # Errors
    /// No velocity within the limits balances the forces, or the crate refuses the model.
    pub fn step(&mut self, input: &Input) -> Result<Moment, RespondError> {
        let (now, before) = (self.now, self.before);
        let gain = if self.steps == 0 {
            self.step
        } else {
            2.0 / 3.0 * self.step
        };
        let behind = |of: fn(&Place) -> f64| match self.steps {
            0 => of(&now),
            _ => (4.0 * of(&now) - of(&before)) / 3.0,
        };
        let displacement = behind(|place| place.relative);
        let velocity = behind(|place| place.velocity);
        // By the same differences as the rate: otherwise their error would move a mass that hardly moves.
        let base_velocity = (input.base - behind(|place| place.base)) / gain;
        let inertia = self.mass / gain;
        let excess = |rate: f64| {
            let force = self.tried(displacement + gain * rate, rate, input);
            inertia * (rate + base_velocity - velocity) + force - input.force
        };
        let guess = if self.steps == 0 {
            now.rate
        } else {
            2.0 * now.rate - before.rate
        };
        let rate = self.balanced(excess, guess, inertia)?;
        let relative = displacement + gain * rate;
        let motion = self.motion(relative, rate, input);
        self.law.force(&mut self.state, &motion);
        self.steps += 1;
        self.before = now;
        self.now = Place {
            relative,
            rate,
            velocity: rate + base_velocity,
            base: input.base,
        };
        let acceleration = (self.now.velocity - velocity) / gain;
        // At rest the law's own friction is 0, so the balance gives the holding force.
        let force = input.force - self.mass * acceleration;
        self.scale = self.scale.max(force.abs()).max(input.force.abs());
        self.follow()?;
        Ok(self.moment(acceleration, force, input))
    }

    /// Amplitude in mm of the law's current coefficients.
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// The rate at which `excess` is 0, searched from `guess`. The function rises at least by `inertia` as long as no spring gives
    /// way.
    fn balanced(
        &self,
        excess: impl Fn(f64) -> f64,
        guess: f64,
        inertia: f64,
    ) -> Result<f64, RespondError> {
        let near = NEAR * self.scale;
        let first = (guess, excess(guess));
        if first.1.abs() <= near {
            return Ok(guess);
        }
        // A little further, so that rounding does not leave the root outside.
        let mut way = -1.000_001 * first.1 / inertia;
        let mut second = (guess + way, 0.0);
        second.1 = excess(second.0);
        for _ in 0..WIDENINGS {
            if (first.1 > 0.0) != (second.1 > 0.0) {
                break;
            }
            way *= 2.0;
            second.0 = guess + way;
            second.1 = excess(second.0);
        }
        let is_bracket = (first.1 > 0.0) != (second.1 > 0.0) && second.0.abs() < limits::VELOCITY;
        if !is_bracket {
            return Err(RespondError::NoBalance {
                time: self.step * (self.steps + 1) as f64,
            });
        }
        let [mut low, mut high] = if way > 0.0 {
            [first, second]
        } else {
            [second, first]
        };
        if low.0 <= 0.0 && high.0 >= 0.0 {
            let [back, forth] = [-CREEP, CREEP].map(|rate| (rate, excess(rate)));
            if back.1 <= 0.0 && forth.1 >= 0.0 {
                return Ok(0.0);
            }
            if back.1 > 0.0 && low.0 < back.0 {
                high = back;
            } else if forth.1 < 0.0 && high.0 > forth.0 {
                low = forth;
            }
        }
        Ok(root(excess, low, high, near))
    }

    /// The damper's force in kN at a trial motion for the next step.
    fn tried(&self, relative: f64, rate: f64, input: &Input) -> f64 {
        let motion = self.motion(relative, rate, input);
        self.law.force(&mut self.state.clone(), &motion)
    }

    /// None of the remaining effects sees the acceleration.
    fn motion(&self, relative: f64, rate: f64, input: &Input) -> Motion<f64> {
        Motion {
            displacement: relative,
            velocity: rate,
            acceleration: 0.0,
            cycles: self.running.cycles(),
            temperature: input.temperature,
            controls: input.controls,
        }
    }

    /// Uses the amplitude of the half cycle that ended for the next one. Coefficients change when the displacement passes the
    /// middle of the swing: a change of stiffness there adds or removes the least energy.
    fn follow(&mut self) -> Result<(), RespondError> {
        if let Some(amplitude) = self.running.update(self.now.relative, self.step) {
            self.next_amplitude = Some(amplitude).filter(|_| self.specimen.model.law.len() > 1);
        }
        let passes = (self.now.relative > 0.0) != (self.before.relative > 0.0);
        if let Some(amplitude) = self.next_amplitude.filter(|_| passes) {
            self.next_amplitude = None;
            self.amplitude = amplitude;
            self.law.set_law(self.specimen.model.law_at(amplitude)?);
        }
        Ok(())
    }

    fn moment(&self, acceleration: f64, damper: f64, input: &Input) -> Moment {
        Moment {
            displacement: self.now.relative + input.base,
            velocity: self.now.velocity,
            acceleration,
            relative_displacement: self.now.relative,
            relative_velocity: self.now.rate,
            damper,
            // The damper's force channel includes the model's own mass.
            force: damper + PER_KILOGRAM * self.specimen.model_mass * acceleration,
            input_power: input.force * self.now.velocity
                - damper * (self.now.velocity - self.now.rate),
            damper_power: damper * self.now.rate,
        }
    }
}
