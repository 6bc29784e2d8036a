//! Rate-independent friction with elastic pre-sliding: Jenkins elements in parallel (an Iwan model).
//!
//! Each element is a spring in series with a Coulomb slider. It sticks until its spring is stretched by the slip limit, then slides
//! at constant force. Several elements with spread slip limits describe a bundle of wires whose contacts slip one after another.

use super::description::{Cost, Dependence, Description, EffectKind, Energy, Growth, Parameter};
use super::{ClampedMotion, Equations, LawForce, Packed, below_0, some};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, coefficient, in_range};

/// Most elements in one [`StickSlip`].
pub const MAX_ELEMENTS: usize = 6;

/// F = Σ kᵢ·zᵢ, zᵢ ← zᵢ + Δy clamped to ±xᵢ.
///
/// Under a steady sine of amplitude X each element dissipates 4·k·x·(X − x) J per cycle if X > x, and nothing otherwise (Iwan 1966;
/// Jenkins 1962).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickSlip<R> {
    elements: [Element<R>; MAX_ELEMENTS],
    used: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Element<R> {
    stiffness: R,
    slip_limit: R,
}

impl<R: Real> Element<R> {
    // Not inlined, because the loop that calls it is unrolled.
    #[inline(never)]
    fn check(&self) -> Result<(), ConfigError> {
        coefficient("stiffness", self.stiffness)?;
        in_range("slip_limit", self.slip_limit, 1e-9, limits::DISPLACEMENT)?;
        Ok(())
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
        let mut new = Self {
            used: elements.len(),
            ..Self::NONE
        };
        for (slot, &(stiffness, slip_limit)) in new.elements.iter_mut().zip(elements) {
            *slot = Element {
                stiffness,
                slip_limit,
            };
        }
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for StickSlip<R> {
    const DESCRIPTION: Description = Description {
        name: "stick_slip",
        family: "stick_slip",
        number: 7,
        kind: EffectKind::Force,
        cost: Cost::Common,
        parameters: &[
            Parameter::new(
                "stiffness",
                "kN/mm",
                -limits::COEFFICIENT,
                limits::COEFFICIENT,
            ),
            Parameter::new("slip_limit", "mm", 1e-9, limits::DISPLACEMENT),
        ],
        most: MAX_ELEMENTS,
        typical: &[
            0.9, 0.01, 0.8, 0.02, 0.7, 0.03, 0.6, 0.045, 0.5, 0.06, 0.4, 0.09,
        ],
        depends_on: &[Dependence::Displacement, Dependence::History],
        outside: Growth::Saturates,
        energy: Energy::Below0(&["stiffness"]),
        scales_law: false,
        sentence: "Rate-independent friction with elastic pre-sliding: springs behind Coulomb sliders.",
    };
    const NONE: Self = Self {
        elements: [Element {
            stiffness: R::ZERO,
            slip_limit: R::ZERO,
        }; MAX_ELEMENTS],
        used: 0,
    };

    type State = Option<StickSlipState<R>>;
    const AT_REST: Self::State = None;

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let elements = super::elements::<2, MAX_ELEMENTS, _>(
            "elements",
            parameters,
            |[stiffness, slip_limit]| (R::from_f64(stiffness), R::from_f64(slip_limit)),
        )?;
        Self::new(&elements)
    }

    fn check(&self) -> Result<(), ConfigError> {
        let used = some("elements", &self.elements, self.used)?;
        used.iter().try_for_each(Element::check)
    }

    fn supplies(&self) -> Option<(&'static str, R)> {
        let mut elements = self.elements.iter().take(self.used);
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
        for (element, stretch) in self.elements.iter().zip(&mut state.stretch).take(self.used) {
            *stretch = (*stretch + step).clipped(element.slip_limit);
            total += element.stiffness * *stretch;
        }
        total
    }
}

impl Packed for StickSlip<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        for element in self.elements.iter().take(self.used) {
            put(element.stiffness);
            put(element.slip_limit);
        }
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let (pairs, []) = words.as_chunks() else {
            return None;
        };
        let mut elements = [Element::default(); MAX_ELEMENTS];
        for (element, &[stiffness, slip_limit]) in elements.iter_mut().zip(pairs) {
            *element = Element {
                stiffness,
                slip_limit,
            };
        }
        Some(Self {
            elements,
            used: pairs.len(),
        })
    }
}
