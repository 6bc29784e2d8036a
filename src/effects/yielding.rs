//! A yielding dashpot behind a spring: a Maxwell branch whose force grows ever more slowly with its rate.
//!
//! Examples are oil through a valve that opens, a pad that slips under enough force, and rubber that flows. They are stiff for
//! small motions, and have a nearly constant force for large ones.

use super::description::{Dependence, Description, Energy, Growth};
use super::numbers::COEFFICIENTS;
use super::stretch::Stretch;
use super::{ClampedMotion, Equations, LawForce, below_0};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, compare, in_range};

/// Range of v₀, mm/s.
const RATE: [f64; 2] = [1e-9, limits::VELOCITY];
/// Longest relaxation time, s: that of [`Relaxation`](super::Relaxation).
const TIME: f64 = 1e6;
/// Range of the tick, s.
const TICK: [f64; 2] = [1e-7, 1e3];
/// γ = 1 − 1/√2 of the step.
const PART: f64 = 1.0 - core::f64::consts::FRAC_1_SQRT_2;
/// Halley steps per stage. From the start value used, two steps leave a relative error of the stretch within 3e-10, and in f32
/// within two units of the last digit (`the_root_is_found_in_two_steps`).
const STEPS: usize = 2;

/// F = k·e, de/dt = v − w, x·tanh(w/v₀) + τ·w = e.
///
/// The spring k has the stretch e. The dashpot behind it moves at the rate w with the force k·x·tanh(w/v₀) + k·τ·w. At a steady
/// velocity v the force is thus k·x·tanh(v/v₀) + k·τ·v. With x = 0 it is a branch of [`Relaxation`](super::Relaxation) with the
/// time τ; for small forces it is one with the time x/v₀ + τ. With τ = 0 and a small v₀ it is a Jenkins element of
/// [`StickSlip`](super::StickSlip) with the slip limit x.
///
/// It is passive for k ≥ 0: the stored energy is k·e²/2, and the power of the dashpot, k·e·w, is never below 0.
///
/// # Step
/// The displacement is linear within a tick. The step is implicit, with two stages (SDIRK2 of Alexander 1977 with γ = 1 − 1/√2). It
/// is of second order, and stiff components decay within a tick, so that no parameter is too fast for a tick. Each stage is one
/// equation x·tanh u + C·u = b, whose left side is concave above 0. The lines that bound its root from below give the start of
/// Halley's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yielding<R> {
    stiffness: R,
    yield_stretch: R,
    /// τ·v₀, mm.
    drag: R,
    /// γ·Δt·v₀, mm.
    slip: R,
    /// x/tanh u at the root u for b = x, mm, which is a little more than x + C. It gives the start of a search.
    reach: R,
}

numbers! {
    Yielding { stiffness, yield_stretch, drag, slip, reach } of {
        stiffness: "kN/mm" in COEFFICIENTS,
        yield_stretch: "mm" in [0.0, limits::DISPLACEMENT],
        rate: "mm/s" in RATE,
        time: "s" in [0.0, TIME],
    }
}

impl<R: Real> Yielding<R> {
    /// * `stiffness`: k, kN/mm, −1e9…1e9
    /// * `yield_stretch`: x, mm, 0…1e4: the dashpot yields at k·x
    /// * `rate`: v₀, mm/s, 1e-9…1e6
    /// * `time`: τ, s, 0…1e6
    /// * `tick`: Δt, s, 1e-7…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(
        stiffness: R,
        yield_stretch: R,
        rate: R,
        time: R,
        tick: R,
    ) -> Result<Self, ConfigError> {
        let rate = in_range("rate", rate, RATE[0], RATE[1])?.to_f64();
        let time = in_range("time", time, 0.0, TIME)?.to_f64();
        let tick = in_range("tick", tick, TICK[0], TICK[1])?.to_f64();
        let mut new = Self {
            stiffness,
            yield_stretch,
            drag: R::from_f64(time * rate),
            slip: R::from_f64(PART * tick * rate),
            reach: R::ZERO,
        };
        new.reach = new.reached();
        new.check()?;
        Ok(new)
    }

    /// τ·v₀, mm.
    pub(super) fn drag(&self) -> R {
        self.drag
    }

    /// The stretch at the first tick: 0, or the displacement if no motion makes the dashpot yield.
    pub(super) fn first_stretch(&self, motion: &ClampedMotion<R>) -> Option<Stretch<R>> {
        let never_yields = self.yield_stretch >= R::from_f64(limits::DISPLACEMENT);
        never_yields.then(|| Stretch::of_spring(motion.displacement()))
    }

    /// x + C, mm: what the reach is at least.
    fn least(&self) -> R {
        self.yield_stretch + self.drag + self.slip
    }

    /// x/tanh u at the root u for b = x.
    fn reached(&self) -> R {
        let x = self.yield_stretch;
        let mut root = x / self.least();
        // A step adds about 1 where C is a small part of x, and at 20 tanh is 1 in f64 too.
        for _ in 0..24 {
            let next = self.step(root, x);
            // A step back is a rounding error: for a C smaller than a digit of x it would lead back to the start.
            if next > root {
                root = next;
            } else {
                break;
            }
        }
        self.reach_of(root)
    }

    /// Checks that the reach is that of the root for b = x, in the steps of one search: a search that starts from it finds a root
    /// that solves the equation, and leads back to it. A start above the root would stay where it is, and one too far below would
    /// not arrive; the reach is then too small or too large.
    #[inline(never)]
    fn check_reach(&self) -> Result<(), ConfigError> {
        // Far above the rounding of both in f32, 1e-6, and too little to matter to a search.
        let close = R::from_f64(1e-5);
        let [x, reach, least] = [self.yield_stretch, self.reach, self.least()];
        let about = |right: R| [right - close * right, right + close * right];
        let [low, high] = if x < R::from_f64(1e-3) * least {
            // The root has too few digits where it is practically 0. The reach is within u²/3 of its lower bound.
            about(least)
        } else if self.drag + self.slip < R::from_f64(1e-7) * x {
            // C is less than a digit of x in f32, and all of u·C is nothing. Here an earlier version went back to the start of its search
            // and rose again, so that its packs have a reach of up to a thousandth more.
            [about(least)[0], R::from_f64(1.0011) * least]
        } else {
            let root = self.root(x);
            let missing = x - x * tanh(root) - (self.drag + self.slip) * root;
            if missing.abs() <= close * x {
                about(self.reach_of(root))
            } else if missing < R::ZERO {
                // Its bounds, because u/tanh u is from 1 to 1 + u.
                let [low, _] = about(least);
                let above = reach + close * reach;
                [if above > low { above } else { low }, least + x]
            } else {
                [least, reach - close * reach]
            }
        };
        compare("reach", reach, low, high).map(|_| ())
    }

    /// x/tanh u at the root u for b = x.
    fn reach_of(&self, root: R) -> R {
        let least = self.least();
        // For a root that is practically 0 the reach is its lower bound: it differs by u²/3, less than a digit of f64, and a smaller root
        // has too few digits in f32.
        let reach = self.yield_stretch / tanh(root);
        if root > R::from_f64(1e-10) && reach > least {
            reach
        } else {
            least
        }
    }

    /// The `root` for `force` = b ≥ 0 after one more step of Halley's method, from a value that is not above it.
    #[inline(always)]
    fn step(&self, root: R, force: R) -> R {
        let tanh = tanh(root);
        let missing = force - self.yield_stretch * tanh - (self.drag + self.slip) * root;
        let curved = self.yield_stretch * (R::ONE - tanh * tanh);
        let slope = curved + self.drag + self.slip;
        // The divisor is above 0, because the remaining error is at most x·(1 − tanh u).
        root + missing * slope / (slope * slope - missing * tanh * curved)
    }

    /// u of x·tanh u + C·u = `force`, C = (τ + γ·Δt)·v₀, for a `force` of at least 0. Not inlined, because it is called twice.
    #[inline(never)]
    fn root(&self, force: R) -> R {
        let x = self.yield_stretch;
        let (bent, beyond) = if force < x {
            (force, R::ZERO)
        } else {
            (x, force - x)
        };
        // Up to x, u is convex in b, and tanh u is at least the proportional part of its value at x.
        let part = (bent / self.reach).clipped(R::from_f64(1.0 - 6e-8));
        let artanh = artanh(part);
        // Beyond it, u is above its tangent at x, and above its asymptote.
        let drag = self.drag + self.slip;
        let tangent = artanh + beyond / (drag + x * (R::ONE - part * part));
        let line = beyond / drag;
        let start = if tangent > line { tangent } else { line };
        let mut root = start;
        for _ in 0..STEPS {
            let next = self.step(root, force);
            // A value below the start is a rounding error, for a C smaller than a digit of x.
            root = if next > start { next } else { start };
        }
        root
    }

    /// γ·Δt·w of the stage with `force` = b.
    #[inline(always)]
    fn slipped(&self, force: R) -> R {
        let slipped = self.slip * self.root(force.abs());
        if force < R::ZERO { -slipped } else { slipped }
    }

    /// e at the end of the stage with `force` = b.
    #[inline(always)]
    fn stretched(&self, force: R) -> R {
        let size = force.abs();
        let root = self.root(size);
        let slipped = self.slip * root;
        // Of two equal forms the one with less cancellation: the dashpot slips little, or by the whole displacement.
        let stretch = if slipped + slipped < size {
            size - slipped
        } else {
            self.yield_stretch * tanh(root) + self.drag * root
        };
        if force < R::ZERO { -stretch } else { stretch }
    }
}

/// artanh of a `part` of 0 to less than 1. The result is not above the exact value, because its logarithm is linear between powers
/// of two, from below.
#[inline(always)]
fn artanh<R: Real>(part: R) -> R {
    let octaves = ((R::ONE + part) / (R::ONE - part)).half_octaves();
    R::from_i32(octaves) * R::from_f64(0.5 * core::f64::consts::LN_2 / 8192.0)
}

/// tanh of a `u` of at least 0. Below ½ it is a continued fraction, with a relative error within 1e-10, because the difference of
/// exponentials has few digits there.
#[inline(always)]
fn tanh<R: Real>(u: R) -> R {
    let (above, below) = if u < R::from_f64(0.5) {
        let square = u * u;
        (
            u * (R::from_f64(945.0) + square * (R::from_f64(105.0) + square)),
            R::from_f64(945.0) + square * (R::from_f64(420.0) + square * R::from_f64(15.0)),
        )
    } else {
        let fallen = (u * R::from_f64(-2.0 * core::f64::consts::LOG2_E)).exp2_of_negative();
        (R::ONE - fallen, R::ONE + fallen)
    };
    above / below
}

impl<R: Real> Equations<R> for Yielding<R> {
    const DESCRIPTION: Description = Description {
        name: "yielding",
        family: "yielding",
        number: 18,
        parameters: Self::PARAMETERS,
        typical: &[2.0, 0.04, 0.3, 0.02],
        depends_on: &[
            Dependence::Displacement,
            Dependence::History,
            Dependence::Frequency,
        ],
        outside: Growth::AtMostLinear,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "A spring and a dashpot that yields, in series: a force that fades when the motion stops, and rises ever more slowly with its speed.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = Option<Stretch<R>>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError> {
        let [stiffness, yield_stretch, rate, time] =
            super::numbers::exactly(parameters)?.map(R::from_f64);
        Self::new(stiffness, yield_stretch, rate, time, R::from_f64(tick))
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("stiffness", self.stiffness)?;
        in_range(
            "yield_stretch",
            self.yield_stretch,
            0.0,
            limits::DISPLACEMENT,
        )?;
        in_range("drag", self.drag, 0.0, 1.001 * TIME * RATE[1])?;
        let slip = [TICK[0] * RATE[0], TICK[1] * RATE[1]].map(|slip| PART * slip);
        in_range("slip", self.slip, 0.999 * slip[0], 1.001 * slip[1])?;
        self.check_reach()
    }

    fn supplies(&self) -> Option<(&'static str, R)> {
        below_0("stiffness", self.stiffness)
    }

    // Not inlined on a target, so that a tick without this effect does not save its registers.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let stretch = Stretch::after(state, motion, |stretch, way| {
            let slipped = self.slipped(stretch + R::from_f64(PART) * way);
            let rest = R::from_f64((1.0 - PART) / PART) * slipped;
            self.stretched(stretch + way - rest)
        });
        self.stiffness * stretch
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of C·u, as a part of b, for x = 1 and every C and b of a grid, knee and ends included. The reference root is
    /// by bisection.
    fn error<R: Real>() -> f64 {
        let mut worst = 0.0_f64;
        let grid = |low: f64, high: f64, count: i32| {
            (0..=count).map(move |n| low * libm::pow(high / low, f64::from(n) / f64::from(count)))
        };
        for c in grid(1e-9, 1e6, 120) {
            let mut branch = Yielding {
                stiffness: R::ONE,
                yield_stretch: R::ONE,
                drag: R::ZERO,
                slip: R::from_f64(c),
                reach: R::from_f64(1.0 + c),
            };
            branch.reach = branch.reached();
            let c = branch.slip.to_f64();
            let about_the_knee = (-40..40).map(|n| 1.0 + c * 0.2 * f64::from(n));
            for b in grid(1e-9, 1e9, 200)
                .chain(about_the_knee)
                .filter(|b| *b > 0.0)
            {
                let b = R::from_f64(b);
                let (mut low, mut high) = (0.0, b.to_f64() / c);
                for _ in 0..120 {
                    let middle = 0.5 * (low + high);
                    if libm::tanh(middle) + c * middle < b.to_f64() {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                let error = c * (branch.root(b).to_f64() - low) / b.to_f64();
                worst = worst.max(error.abs());
            }
        }
        worst
    }

    #[test]
    fn the_root_is_found_in_two_steps() {
        let (single, double) = (error::<f32>(), error::<f64>());
        assert!(double < 3e-10, "{double}");
        assert!(single < 2.4e-7, "{single}");
    }

    /// Whatever its parameters are, an honest branch passes its own check, and one with another reach does not.
    fn only_the_right_reach_passes<R: Real>() {
        let mut checked = 0;
        for stretch in [0.0, 1e-38, 1e-20, 1e-9, 1e-4, 0.04, 1.0, 77.0, 1e4] {
            for rate in [RATE[0], 1e-5, 0.3, 40.0, RATE[1]] {
                for time in [0.0, 1e-12, 1e-3, 0.02, 3.0, TIME] {
                    for tick in [TICK[0], 1e-4, 0.01, TICK[1]] {
                        let [k, x, v, t, dt] = [1.0, stretch, rate, time, tick].map(R::from_f64);
                        let honest = Yielding::new(k, x, v, t, dt).unwrap();
                        let of = |part: f64| Yielding {
                            reach: honest.reach * R::from_f64(part),
                            ..honest
                        };
                        // Where C is nothing beside x, packs of an earlier version have up to a thousandth more.
                        let is_old = honest.drag + honest.slip < R::from_f64(1e-7) * x;
                        assert_eq!(of(1.001).check().is_ok(), is_old, "{honest:?}");
                        let above = if is_old { 1.002 } else { 1.0001 };
                        for part in [-1.0, 0.0, 0.5, 0.99, 0.9999, above, 1.01, 2.0, 1e9] {
                            assert!(of(part).check().is_err(), "{part} of {honest:?}");
                        }
                        checked += 1;
                    }
                }
            }
        }
        assert_eq!(checked, 1080);
    }

    #[test]
    fn an_honest_reach_passes_and_no_other() {
        only_the_right_reach_passes::<f32>();
        only_the_right_reach_passes::<f64>();
    }
}
