//! Springs and dashpots in series (Maxwell branches), parallel to the law: a force that decays when the motion stops.
//!
//! Several branches with spread times are a Prony series, which the paper uses for its material (Table 5). They also approximate
//! materials that relax on all time scales.

use super::description::{Cost, Dependence, Description, Energy, Growth};
use super::numbers::{COEFFICIENTS, Elements};
use super::{ClampedMotion, Equations, LawForce, Packed, below_0};
use crate::error::ConfigError;
use crate::real::{Real, coefficient, in_range};

/// Most branches in one [`Relaxation`].
pub const MAX_BRANCHES: usize = 3;

/// Range of the time, s.
const TIMES: [f64; 2] = [1e-6, 1e6];

/// Smallest part of a difference that decays in a tick: that of the shortest tick and the longest time, with a margin for rounding.
pub(super) const LEAST_PART: f64 = 0.999 * 1e-7 / 1e6;

/// dzᵢ/dt = kᵢ·v − zᵢ/τᵢ, F = Σ zᵢ.
///
/// For a displacement that is linear within a tick of Δt the step is exact: z ← z − loss·z + gain·Δy, loss = 1 − e^(−Δt/τ), gain =
/// k·loss·τ/Δt. The storage modulus is Σ k·(ωτ)²/(1 + (ωτ)²), the loss modulus Σ k·ωτ/(1 + (ωτ)²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation<R> {
    branches: Elements<Branch<R>, MAX_BRANCHES>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Branch<R> {
    gain: R,
    /// Stored in place of 1 − loss, because near 1 an f32 would round the time constant.
    loss: R,
}

numbers! {
    Branch { gain, loss } of {
        stiffness: "kN/mm" in COEFFICIENTS,
        time: "s" in TIMES,
    }
}

impl<R: Real> Branch<R> {
    #[inline(always)]
    fn force(&self, state: &mut BranchState<R>, step: R) -> R {
        let change = state.carry + self.gain * step - self.loss * state.force;
        let force = state.force + change;
        state.carry = change - (force - state.force);
        state.force = force;
        force
    }

    /// Sum of the forces of `branches`; an absent branch has none.
    // Not inlined, so that a single branch does not load its registers.
    #[inline(never)]
    fn force_of(branches: &[Self], states: &mut [BranchState<R>], step: R) -> R {
        let pairs = branches.iter().zip(states);
        pairs.fold(R::ZERO, |sum, (branch, state)| {
            sum + branch.force(state, step)
        })
    }

    fn check(&self) -> Result<(), ConfigError> {
        coefficient("gain", self.gain)?;
        in_range("loss", self.loss, LEAST_PART, 1.0).map(|_| ())
    }
}

/// State of a [`Relaxation`].
#[derive(Clone, Copy, Debug)]
// The fields of every tick come first, within the offset of a load from one address.
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RelaxationState<R> {
    /// Displacement of the tick before, mm.
    previous: R,
    branches: [BranchState<R>; MAX_BRANCHES],
}

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct BranchState<R> {
    force: R,
    /// Rounding error of the force: with a long τ the change in a tick is far smaller than an f32 can add.
    carry: R,
}

impl<R: Real> Relaxation<R> {
    /// * `branches`: 1…3 pairs of stiffness k, kN/mm, −1e9…1e9, and time τ, s, 1e-6…1e6
    /// * `tick`: Δt, s, 1e-7…1e3
    ///
    /// # Errors
    /// No branches, too many, or the field that is not finite or out of range.
    pub fn new(branches: &[(R, R)], tick: R) -> Result<Self, ConfigError> {
        let tick = in_range("tick", tick, 1e-7, 1e3)?.to_f64();
        let branch = |&(stiffness, time): &(R, R)| {
            let stiffness = coefficient("stiffness", stiffness)?.to_f64();
            let time = in_range("time", time, TIMES[0], TIMES[1])?.to_f64();
            let loss = -libm::expm1(-tick / time);
            Ok(Branch {
                gain: R::from_f64(stiffness * loss * time / tick),
                loss: R::from_f64(loss),
            })
        };
        let new = Self {
            branches: Elements::of(branches, Branch::ABSENT, branch)?,
        };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Relaxation<R> {
    const DESCRIPTION: Description = Description {
        name: "relaxation",
        family: "relaxation",
        number: 8,
        cost: Cost::Common,
        parameters: Branch::<R>::PARAMETERS,
        most: MAX_BRANCHES,
        typical: &[0.8, 0.05],
        depends_on: &[
            Dependence::Displacement,
            Dependence::History,
            Dependence::Frequency,
        ],
        outside: Growth::Linear,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "Springs and dashpots in series: a force that fades when the motion stops.",
        ..Description::PLAIN
    };
    const NONE: Self = Self {
        branches: Elements::absent(Branch::ABSENT),
    };

    type State = Option<RelaxationState<R>>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], tick: f64) -> Result<Self, ConfigError> {
        let branches = super::numbers::elements::<2, MAX_BRANCHES, _>(
            "branches",
            parameters,
            |[stiffness, time]| (R::from_f64(stiffness), R::from_f64(time)),
        )?;
        Self::new(&branches, R::from_f64(tick))
    }

    fn check(&self) -> Result<(), ConfigError> {
        self.branches.check("branches", Branch::check)
    }

    /// The gain has the sign of the stiffness.
    fn supplies(&self) -> Option<(&'static str, R)> {
        let mut branches = self.branches.used();
        branches.find_map(|branch| below_0("stiffness", branch.gain))
    }

    #[inline(always)]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let state = state.get_or_insert(RelaxationState {
            previous: y,
            branches: [BranchState {
                force: R::ZERO,
                carry: R::ZERO,
            }; MAX_BRANCHES],
        });
        let step = y - state.previous;
        state.previous = y;
        let ([branch, branches @ ..], [first, others @ ..]) =
            (&self.branches.all, &mut state.branches);
        let force = branch.force(first, step);
        if self.branches.count > 1 {
            return force + Branch::force_of(branches, others, step);
        }
        force
    }
}

impl Packed for Relaxation<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        self.branches.pack(put);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let branches = Elements::unpack::<2>(words, Branch::ABSENT)?;
        Some(Self { branches })
    }
}
