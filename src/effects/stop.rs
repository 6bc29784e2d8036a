//! One-sided contact: a stop that the specimen or its fixture meets beyond a gap.

use super::{ConfinedMotion, EffectForce, LawForce};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// Most contacts in one [`Stop`]: one on each side, or two of one side.
pub const MAX_CONTACTS: usize = 2;

/// F = Σ kᵢ·max(y − gᵢ, 0) for the contacts with a gap above 0, and kᵢ·min(y − gᵢ, 0) for those below.
///
/// Elastic: it dissipates nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop<R> {
    /// One that is not there has a stiffness of 0.
    pub(super) contacts: [Contact<R>; MAX_CONTACTS],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact<R> {
    pub(super) stiffness: R,
    pub(super) gap: R,
}

impl<R: Real> Contact<R> {
    fn check(&self) -> Result<(), ConfigError> {
        in_range("stiffness", self.stiffness, 1e-9, limits::COEFFICIENT)?;
        in_range("gap", self.gap.abs(), 1e-9, limits::DISPLACEMENT).map(|_| ())
    }
}

impl<R: Real> Stop<R> {
    pub(super) const NONE: Self = Self {
        contacts: [Contact {
            stiffness: R::ZERO,
            gap: R::ZERO,
        }; MAX_CONTACTS],
    };

    /// * `contacts`: 1 or 2 pairs of stiffness, kN/mm, 1e-9…1e9, and gap, mm, 1e-9…1e4 on the side of positive displacement,
    ///   −1e4…−1e-9 on the other
    ///
    /// # Errors
    /// No contacts, too many, or the field that is not finite or out of range.
    pub fn new(contacts: &[(R, R)]) -> Result<Self, ConfigError> {
        if contacts.is_empty() {
            return Err(ConfigError::Empty("contacts"));
        }
        if contacts.len() > MAX_CONTACTS {
            return Err(ConfigError::Full {
                field: "contacts",
                capacity: MAX_CONTACTS,
            });
        }
        let mut new = Self::NONE;
        for (slot, &(stiffness, gap)) in new.contacts.iter_mut().zip(contacts) {
            *slot = Contact { stiffness, gap };
            slot.check()?;
        }
        Ok(new)
    }
}

impl<R: Real> EffectForce<R> for Stop<R> {
    type State = ();

    fn check(&self) -> Result<(), ConfigError> {
        for contact in &self.contacts {
            // Where there is one its gap says on which side.
            if contact.stiffness != R::ZERO || contact.gap != R::ZERO {
                contact.check()?;
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ConfinedMotion<R>, _: LawForce<R>) -> R {
        let y = motion.displacement();
        let mut total = R::ZERO;
        for contact in &self.contacts {
            let beyond = y - contact.gap;
            let touches = if contact.gap > R::ZERO {
                beyond > R::ZERO
            } else {
                beyond < R::ZERO
            };
            if touches {
                total += contact.stiffness * beyond;
            }
        }
        total
    }
}
