//! A force channel behind a low-pass filter, such as that of a load cell's amplifier. The displacement does not pass through it.

use core::f64::consts::{PI, SQRT_2};

use super::Equations;
use super::description::{Dependence, Description, EffectKind, Energy, Growth};
use crate::error::ConfigError;
use crate::real::{Real, compare, in_range};

/// Lowest and highest corner, cycles per tick. Below, f32 would lose the change within a tick; above, a tick has no lag.
const CORNER: [f64; 2] = [1e-4, 1e3];

/// F″ + √2·ω·F′ + ω²·F = ω²·F_all, ω = 2π·corner: the sum of the law's force and of every effect's, behind a second-order
/// Butterworth low-pass with damping 1/√2 (S. Butterworth, "On the theory of filter amplifiers", Wireless Engineer 7, 1930).
///
/// At r times the corner frequency its gain is 1/√(1 + r⁴) and its phase lag atan2(√2·r, 1 − r²): 1 and 0 at rest, 1/√2 and a
/// quarter turn at the corner. A slow force is late by √2/ω. Before the first tick the force is assumed to have had its first value
/// for ever.
///
/// For a force that is linear within a tick of Δt the step is exact. Let e be the output minus the input, and g = e + √2·F′/ω, with
/// a = ω·Δt/√2 and ΔF the change of the force:
///
/// - e ← e + im·g − lost·e + along·ΔF, along = −lost/a
/// - g ← g − im·e − lost·g + across·ΔF, across = −im/a
///
/// where 1 − lost = e^(−a)·cos a and im = e^(−a)·sin a. e and g shrink by e^(−a) per tick, so that nothing grows, however the
/// coefficients are rounded; at rest e is 0 to the last bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceFilter<R> {
    /// Stored in place of 1 − lost, because near 1 an f32 would round the corner.
    lost: R,
    im: R,
    along: R,
    across: R,
}

/// State of a [`ForceFilter`], all in kN.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForceFilterState<R> {
    /// The force of the tick before.
    previous: R,
    /// Output minus that force.
    e: R,
    g: R,
}

numbers! {
    ForceFilter { lost, im, along, across } of {
        // At the longest tick and at the shortest.
        corner: "Hz" in [1e-7, 1e10],
    }
}

impl<R: Real> ForceFilter<R> {
    /// * `corner`: frequency at which the gain is 1/√2, Hz, 1e-4…1e3 per tick
    /// * `tick`: s, 1e-7…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(corner: R, tick: R) -> Result<Self, ConfigError> {
        let tick = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        let [least, most] = CORNER.map(|corner| corner / tick);
        let corner = in_range("corner", corner, least, most)?.to_f64();
        let a = SQRT_2 * PI * corner * tick;
        let (sin, cos) = libm::sincos(a);
        let kept = libm::exp(-a);
        let (lost, im) = (1.0 - kept * cos, kept * sin);
        let new = Self {
            lost: R::from_f64(lost),
            im: R::from_f64(im),
            along: R::from_f64(-lost / a),
            across: R::from_f64(-im / a),
        };
        new.check()?;
        Ok(new)
    }
}

/// Checks that `value` is `expected`. Derived: exponential, sine and a round within 1e-6 of a whole, in f32.
///
/// # Errors
/// It is not.
fn is_about<R: Real>(field: &'static str, value: R, expected: R) -> Result<(), ConfigError> {
    let [low, high] = [-2e-6, 2e-6].map(|off| expected + R::from_f64(off));
    compare(field, value, low, high).map(|_| ())
}

impl<R: Real> Equations<R> for ForceFilter<R> {
    const DESCRIPTION: Description = Description {
        name: "force_filter",
        family: "delay",
        number: 17,
        kind: EffectKind::Stage,
        parameters: Self::PARAMETERS,
        typical: &[200.0],
        depends_on: &[Dependence::Velocity, Dependence::Frequency],
        outside: Growth::OfForceBehind,
        energy: Energy::Active,
        sentence: "A force channel behind a second-order low-pass.",
        ..Description::PLAIN
    };
    const NONE: Self = Self::ABSENT;

    type State = Option<ForceFilterState<R>>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError> {
        let [corner] = super::numbers::exactly(parameters)?;
        Self::new(R::from_f64(corner), R::from_f64(tick))
    }

    /// One number gives all four: a, which lost and along say. The state then shrinks by e^(−a) per tick.
    fn check(&self) -> Result<(), ConfigError> {
        in_range("lost", self.lost, 1e-4, 1.07)?;
        in_range("along", self.along, -1.0, -1e-4)?;
        let a = self.lost / -self.along;
        let [low, high] = CORNER.map(|corner| SQRT_2 * PI * corner);
        in_range("corner", a, 0.999 * low, 1.001 * high)?;
        let kept = (a * R::from_f64(-core::f64::consts::LOG2_E)).exp2_of_negative();
        let turns = a * R::from_f64(0.5 / PI);
        let part = turns - R::from_i32(turns.to_i32());
        let phase = u64::from((part * R::from_f64(f64::from(1 << 30))).to_i32() as u32) << 34;
        let [sin, cos] = [phase, phase.wrapping_add(1 << 62)].map(R::sine);
        is_about("lost", self.lost, R::ONE - kept * cos)?;
        is_about("im", self.im, kept * sin)?;
        is_about("across", self.across, -self.im / a)
    }

    #[inline(always)]
    fn shown(&self, state: &mut Self::State, force: R) -> R {
        let state = state.get_or_insert(ForceFilterState {
            previous: force,
            e: R::ZERO,
            g: R::ZERO,
        });
        let change = force - state.previous;
        let (e, g) = (state.e, state.g);
        state.previous = force;
        state.e = e + (self.im * g - self.lost * e + self.along * change);
        state.g = g + (self.across * change - self.im * e - self.lost * g);
        force + state.e
    }
}
