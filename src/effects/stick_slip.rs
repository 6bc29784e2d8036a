//! Rate-independent friction with elastic pre-sliding: Jenkins elements in parallel (an Iwan model).
//!
//! Each element is a spring in series with a Coulomb slider. It sticks until its spring is stretched by the slip limit,
//! then slides at constant force. Many of them with spread slip limits are a bundle of wires whose contacts let go one
//! after another.

use super::{EffectForce, Motion};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// Most elements in one [`StickSlip`].
pub const MAX_ELEMENTS: usize = 6;

/// F = Σ kᵢ·zᵢ, zᵢ ← zᵢ + Δy confined to ±xᵢ.
///
/// Under a steady sine of amplitude X each element dissipates 4·k·x·(X − x) J a cycle when X > x, nothing otherwise
/// (Iwan 1966; Jenkins 1962).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickSlip<R> {
    /// Elements that are not used have stiffness 0.
    stiffness: [R; MAX_ELEMENTS],
    slip_limit: [R; MAX_ELEMENTS],
}

/// What a [`StickSlip`] remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct StickSlipState<R> {
    stretch: [R; MAX_ELEMENTS],
    previous: Option<R>,
}

impl<R: Real> StickSlip<R> {
    /// * `elements`: 1…6 pairs of stiffness, kN/mm, −1e9…1e9, and slip limit, mm, 1e-9…1e4
    ///
    /// # Errors
    /// No elements, too many, or the field that is not finite or out of range.
    pub fn new(elements: &[(R, R)]) -> Result<Self, ConfigError> {
        if elements.is_empty() {
            return Err(ConfigError::Empty("elements"));
        }
        if elements.len() > MAX_ELEMENTS {
            return Err(ConfigError::Full {
                field: "elements",
                capacity: MAX_ELEMENTS,
            });
        }
        let mut new = Self {
            stiffness: [R::ZERO; MAX_ELEMENTS],
            slip_limit: [R::ZERO; MAX_ELEMENTS],
        };
        let slots = new.stiffness.iter_mut().zip(&mut new.slip_limit);
        for ((stiffness, slip_limit), element) in slots.zip(elements) {
            *stiffness = in_range(
                "stiffness",
                element.0,
                -limits::COEFFICIENT,
                limits::COEFFICIENT,
            )?;
            *slip_limit = in_range("slip_limit", element.1, 1e-9, limits::DISPLACEMENT)?;
        }
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for StickSlip<R> {
    type State = StickSlipState<R>;

    #[inline]
    fn force(&self, state: &mut Self::State, motion: &Motion<R>, _: R) -> R {
        let y = motion
            .displacement
            .confined(R::from_f64(limits::DISPLACEMENT));
        let step = y - state.previous.unwrap_or(y);
        state.previous = Some(y);
        let mut total = R::ZERO;
        for ((stretch, limit), stiffness) in state
            .stretch
            .iter_mut()
            .zip(&self.slip_limit)
            .zip(&self.stiffness)
        {
            *stretch = (*stretch + step).confined(*limit);
            total += *stiffness * *stretch;
        }
        total
    }
}
