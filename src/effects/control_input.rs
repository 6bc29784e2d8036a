//! A yielding branch and a dashpot whose strength follows a control input: the coil current of a magneto-rheological damper, the
//! pressure on a friction pad, the tension of a band.

use super::description::{Absent, Dependence, Description, Energy, Growth};
use super::motion::CONTROLS;
use super::numbers::COEFFICIENTS;
use super::relaxation::LEAST_PART;
use super::{ClampedMotion, Equations, LawForce, Packed, Yielding, below_0};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, divisor, in_range};

/// Longest lag, s: that of a branch of [`Relaxation`](super::Relaxation).
const LAG: f64 = 1e6;
/// Range of the saturation, in the unit of the input. At the upper end the strength of the largest input differs from a line by
/// less than 1e-6.
const SATURATION: [f64; 2] = [1e-9, 1e12];

/// F = f·(k·e + c·v), f = w/(1 + w/s), T·dw/dt = |u| − w, with the stretch e of a [`Yielding`] branch of stiffness 1.
///
/// u is the control input, w the part of it that has reached the specimen with the lag T, and f the strength: close to w far below
/// the saturation s, and never more than s. At a steady strength and velocity the force is f·(k·x·tanh(v/v₀) + c·v). The sign of
/// the input has no influence.
///
/// Under a steady input it is passive for k ≥ 0 and c ≥ 0. An input that rises while the branch is stretched stiffens its spring;
/// the input does the work for the additional energy of the spring.
///
/// # Step
/// The input is held from one tick to the next, so that the lag is exact: w ← w + (1 − e^(−Δt/T))·(|u| − w). Before the first tick
/// the input is assumed to have had its first value. A branch that yields at the end of the range of the displacement is a spring, which
/// is at rest at a displacement of 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlInput<R> {
    /// The branch at a strength of 1.
    branch: Yielding<R>,
    /// c.
    viscosity: R,
    /// 1 − e^(−Δt/T), above 0.
    arriving: R,
    /// 1/s.
    bend: R,
    /// Index of the input among the controls.
    input: usize,
}

/// State of a [`ControlInput`].
// Not an `Option` of the whole: it would use a niche of the stretch, and `None` would not be all zeros.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ControlInputState<R: Real> {
    /// Whether there was a tick yet.
    has_begun: bool,
    /// w.
    arrived: R,
    /// Rounding error of `arrived`: with a long lag the change in a tick is smaller than an f32 can add.
    carry: R,
    stretch: <Yielding<R> as Equations<R>>::State,
}

numbers! {
    ControlInput of {
        stiffness: "kN/mm" in COEFFICIENTS,
        yield_stretch: "mm" in [0.0, limits::DISPLACEMENT],
        rate: "mm/s" in [1e-9, limits::VELOCITY],
        viscosity: "kN*s/mm" in COEFFICIENTS => Absent::Is(0.0),
        lag: "s" in [0.0, LAG] => Absent::Is(0.0),
        saturation: "1" in SATURATION => Absent::Is(SATURATION[1]),
        input: "1" in [0.0, (CONTROLS - 1) as f64] => Absent::Is(0.0),
    }
}

impl<R: Real> ControlInput<R> {
    /// An input without lag, whose force is proportional to the input.
    ///
    /// * `input`: index among [`Motion::controls`](super::Motion::controls), 0…3
    /// * `branch`: the branch at an input of 1, without a time τ
    /// * `viscosity`: c, the dashpot at an input of 1, kN·s/mm, −1e9…1e9
    ///
    /// # Errors
    /// The field that is not finite or out of range; for a `branch` with a time τ, its product with the rate v₀.
    pub fn new(input: usize, branch: Yielding<R>, viscosity: R) -> Result<Self, ConfigError> {
        in_range("time * rate of the branch", branch.drag(), 0.0, 0.0)?;
        let new = Self {
            branch,
            viscosity,
            arriving: R::ONE,
            bend: R::from_f64(1.0 / SATURATION[1]),
            input,
        };
        new.check()?;
        Ok(new)
    }

    /// The same with a lag.
    ///
    /// * `lag`: T, s, 0…1e6
    /// * `tick`: Δt, s, 1e-7…1e3
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn with_lag(self, lag: R, tick: R) -> Result<Self, ConfigError> {
        let lag = divisor("lag", lag, LAG)?.to_f64();
        let tick = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        // 1 without a lag.
        let arriving = R::from_f64(-libm::expm1(-tick / lag));
        let new = Self { arriving, ..self };
        new.check()?;
        Ok(new)
    }

    /// The same with a strength that approaches `saturation`.
    ///
    /// * `saturation`: s, in the unit of the input, 1e-9…1e12
    ///
    /// # Errors
    /// `saturation` is not finite or out of range.
    pub fn with_saturation(self, saturation: R) -> Result<Self, ConfigError> {
        let saturation = in_range("saturation", saturation, SATURATION[0], SATURATION[1])?;
        let new = Self {
            bend: R::ONE / saturation,
            ..self
        };
        new.check()?;
        Ok(new)
    }

    /// f, after a tick with this input.
    #[inline(always)]
    fn strength(&self, state: &mut ControlInputState<R>, motion: &ClampedMotion<R>) -> R {
        let input = motion.control(self.input).abs();
        if !state.has_begun {
            state.has_begun = true;
            state.arrived = input;
            state.stretch = self.branch.first_stretch(motion);
        }
        let change = self.arriving * (input - state.arrived) + state.carry;
        let arrived = state.arrived + change;
        state.carry = change - (arrived - state.arrived);
        state.arrived = arrived;
        arrived / (R::ONE + arrived * self.bend)
    }
}

impl<R: Real> Equations<R> for ControlInput<R> {
    const DESCRIPTION: Description = Description {
        name: "control_input",
        family: "control_input",
        number: 19,
        parameters: Self::PARAMETERS,
        typical: &[2.0, 0.04, 0.3, 0.01, 0.02, 1.5, 0.0],
        depends_on: &[
            Dependence::Control,
            Dependence::Displacement,
            Dependence::Velocity,
            Dependence::History,
        ],
        outside: Growth::AtMostLinear,
        energy: Energy::Below0(&["stiffness", "viscosity"]),
        sentence: "A yielding branch and a dashpot, whose strength follows a control input, optionally with a lag.",
        ..Description::PLAIN
    };
    const NONE: Self = Self {
        branch: Yielding::<R>::NONE,
        viscosity: R::ZERO,
        arriving: R::ZERO,
        bend: R::ZERO,
        input: 0,
    };

    type State = ControlInputState<R>;
    const AT_REST: Self::State = ControlInputState {
        has_begun: false,
        arrived: R::ZERO,
        carry: R::ZERO,
        stretch: Yielding::<R>::AT_REST,
    };

    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError> {
        let given = super::numbers::exactly::<7>(parameters)?;
        let [
            stiffness,
            yield_stretch,
            rate,
            viscosity,
            lag,
            saturation,
            _,
        ] = given.map(R::from_f64);
        let [.., input] = given;
        let tick = R::from_f64(tick);
        let branch = Yielding::new(stiffness, yield_stretch, rate, R::ZERO, tick)?;
        Self::new(place("input", input)?, branch, viscosity)?
            .with_lag(lag, tick)?
            .with_saturation(saturation)
    }

    fn check(&self) -> Result<(), ConfigError> {
        in_range("drag", self.branch.drag(), 0.0, 0.0)?;
        self.branch.check()?;
        coefficient("viscosity", self.viscosity)?;
        in_range("arriving", self.arriving, LEAST_PART, 1.0)?;
        let bend = [0.999 / SATURATION[1], 1.001 / SATURATION[0]];
        in_range("bend", self.bend, bend[0], bend[1])?;
        place("input", self.input as f64).map(|_| ())
    }

    fn supplies(&self) -> Option<(&'static str, R)> {
        let branch = self.branch.supplies();
        branch.or_else(|| below_0("viscosity", self.viscosity))
    }

    // Not inlined on a target, so that a tick without this effect does not save its registers.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, law: LawForce<R>) -> R {
        let strength = self.strength(state, motion);
        let branch = self.branch.force(&mut state.stretch, motion, law);
        strength * (branch + self.viscosity * motion.velocity())
    }
}

/// Checks that `value` is an index of a control.
///
/// # Errors
/// It is not an index.
fn place(field: &'static str, value: f64) -> Result<usize, ConfigError> {
    let known = (0..CONTROLS).find(|&place| place as f64 == value);
    known.ok_or(ConfigError::OutOfRange {
        field,
        value,
        low: 0.0,
        high: (CONTROLS - 1) as f64,
    })
}

impl Packed for ControlInput<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        self.branch.pack(put);
        [
            self.viscosity,
            self.arriving,
            self.bend,
            // Below four.
            self.input as f32,
        ]
        .into_iter()
        .for_each(put);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let (branch, rest) = words.split_at_checked(5)?;
        let &[viscosity, arriving, bend, input] = rest else {
            return None;
        };
        Some(Self {
            branch: Yielding::unpack(branch)?,
            viscosity,
            arriving,
            bend,
            input: place("input", input.into()).ok()?,
        })
    }
}
