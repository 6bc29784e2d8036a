//! Rate-independent friction with elastic pre-sliding: Jenkins elements in parallel (an Iwan model).
//!
//! Each element is a spring in series with a Coulomb slider. It sticks until its spring is stretched by the slip limit, then slides
//! at constant force. Several elements with spread slip limits describe a bundle of wires whose contacts slip one after another.

use super::description::{Cost, Dependence, Description, Energy, Growth};
use super::numbers::{COEFFICIENTS, Elements, SLIP_LIMITS};
use super::{ClampedMotion, Equations, LawForce, Packed, below_0};
use crate::error::ConfigError;
use crate::real::Real;

/// Most elements in one [`StickSlip`].
pub const MAX_ELEMENTS: usize = 6;

/// F = Σ kᵢ·zᵢ, zᵢ ← zᵢ + Δy clamped to ±xᵢ.
///
/// Under a steady sine of amplitude X each element dissipates 4·k·x·(X − x) J per cycle if X > x, and nothing otherwise (Iwan 1966;
/// Jenkins 1962).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickSlip<R> {
    elements: Elements<Element<R>, MAX_ELEMENTS>,
}

numbers! {
    element struct Element {
        stiffness: "kN/mm" in COEFFICIENTS,
        slip_limit: "mm" in SLIP_LIMITS,
    }
}

/// State of a [`StickSlip`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StickSlipState<R> {
    stretch: [R; MAX_ELEMENTS],
    /// Displacement of the tick before, mm.
    previous: R,
}

impl<R: Real> StickSlip<R> {
    /// * `elements`: 1…6 pairs of stiffness, kN/mm, −1e9…1e9, and slip limit, mm, 1e-9…1e4
    ///
    /// # Errors
    /// No elements, too many, or the field that is not finite or out of range.
    pub fn new(elements: &[(R, R)]) -> Result<Self, ConfigError> {
        let element = |&(stiffness, slip_limit): &(R, R)| {
            Ok(Element {
                stiffness,
                slip_limit,
            })
        };
        let new = Self {
            elements: Elements::of(elements, Element::ABSENT, element)?,
        };
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for StickSlip<R> {
    const DESCRIPTION: Description = Description {
        name: "stick_slip",
        family: "stick_slip",
        number: 7,
        cost: Cost::Common,
        parameters: Element::<R>::PARAMETERS,
        most: MAX_ELEMENTS,
        typical: &[
            0.9, 0.01, 0.8, 0.02, 0.7, 0.03, 0.6, 0.045, 0.5, 0.06, 0.4, 0.09,
        ],
        depends_on: &[Dependence::Displacement, Dependence::History],
        outside: Growth::Saturates,
        energy: Energy::Below0(&["stiffness"]),
        sentence: "Rate-independent friction with elastic pre-sliding: springs behind Coulomb sliders.",
        ..Description::PLAIN
    };
    const NONE: Self = Self {
        elements: Elements::absent(Element::ABSENT),
    };

    type State = Option<StickSlipState<R>>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let elements = super::numbers::elements::<2, MAX_ELEMENTS, _>(
            "elements",
            parameters,
            |[stiffness, slip_limit]| (R::from_f64(stiffness), R::from_f64(slip_limit)),
        )?;
        Self::new(&elements)
    }

    fn check(&self) -> Result<(), ConfigError> {
        self.elements.check("elements", Element::check_numbers)
    }

    fn supplies(&self) -> Option<(&'static str, R)> {
        let mut elements = self.elements.used();
        elements.find_map(|element| below_0("stiffness", element.stiffness))
    }

    // Not inlined on a target, so that ticks without this effect do not load its registers and constants.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn force(&self, state: &mut Self::State, motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let state = state.get_or_insert(StickSlipState {
            stretch: [R::ZERO; MAX_ELEMENTS],
            previous: y,
        });
        let step = y - state.previous;
        state.previous = y;
        let mut total = R::ZERO;
        for (element, stretch) in self.elements.used().zip(&mut state.stretch) {
            *stretch = (*stretch + step).clipped(element.slip_limit);
            total += element.stiffness * *stretch;
        }
        total
    }
}

impl Packed for StickSlip<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        self.elements.pack(put);
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let elements = Elements::unpack::<2>(words, Element::ABSENT)?;
        Some(Self { elements })
    }
}
