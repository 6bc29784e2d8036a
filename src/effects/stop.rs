//! One-sided contact: a stop that the specimen or its fixture reaches beyond a gap.

use super::description::{Dependence, Description, Growth};
use super::{ClampedMotion, Equations, LawForce, Packed};
use crate::error::ConfigError;
use crate::limits;
use crate::real::{Real, in_range};

/// Most contacts in one [`Stop`]: one on each side, or two on one side.
pub const MAX_CONTACTS: usize = 2;

/// F = Σ kᵢ·max(y − gᵢ, 0) for the contacts with a gap above 0, and kᵢ·min(y − gᵢ, 0) for those below.
///
/// It is elastic, and dissipates nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop<R> {
    /// An absent contact has a stiffness of 0.
    contacts: [Contact<R>; MAX_CONTACTS],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Contact<R> {
    stiffness: R,
    gap: R,
}

numbers! {
    Contact { stiffness, gap } of {
        stiffness: "kN/mm" in [0.0, limits::COEFFICIENT],
        gap: "mm" in [-limits::DISPLACEMENT, limits::DISPLACEMENT],
    }
}

impl<R: Real> Contact<R> {
    /// The sign of its gap gives its side.
    fn check(&self) -> Result<(), ConfigError> {
        in_range("stiffness", self.stiffness, 0.0, limits::COEFFICIENT)?;
        in_range("gap", self.gap.abs(), 1e-9, limits::DISPLACEMENT).map(|_| ())
    }
}

impl<R: Real> Stop<R> {
    /// * `contacts`: 1 or 2 pairs of stiffness, kN/mm, 0…1e9, and gap, mm, 1e-9…1e4 on the side of positive displacement,
    ///   −1e4…−1e-9 on the other
    ///
    /// # Errors
    /// No contacts, too many, or the field that is not finite or out of range.
    pub fn new(contacts: &[(R, R)]) -> Result<Self, ConfigError> {
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
        new.check()?;
        Ok(new)
    }
}

impl<R: Real> Equations<R> for Stop<R> {
    const DESCRIPTION: Description = Description {
        name: "stop",
        family: "stop",
        number: 9,
        parameters: Contact::<R>::PARAMETERS,
        most: MAX_CONTACTS,
        typical: &[2.0, 0.06, 3.0, -0.08],
        depends_on: &[Dependence::Displacement],
        outside: Growth::LinearBeyondGap,
        sentence: "One-sided contact: a stop that the specimen or its fixture meets beyond a gap.",
        ..Description::PLAIN
    };
    const NONE: Self = Self {
        contacts: [Contact::ABSENT; MAX_CONTACTS],
    };

    type State = ();
    const AT_REST: () = ();

    fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, ConfigError> {
        let contacts = super::numbers::elements::<2, MAX_CONTACTS, _>(
            "contacts",
            parameters,
            |[stiffness, gap]| (R::from_f64(stiffness), R::from_f64(gap)),
        )?;
        Self::new(&contacts)
    }

    fn check(&self) -> Result<(), ConfigError> {
        let is_there = |contact: &&Contact<R>| **contact != Contact::ABSENT;
        let mut there = self.contacts.iter().filter(is_there).peekable();
        if there.peek().is_none() {
            return Err(ConfigError::Empty("contacts"));
        }
        there.try_for_each(Contact::check)
    }

    #[inline(always)]
    fn force(&self, _: &mut (), motion: &ClampedMotion<R>, _: LawForce<R>) -> R {
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

impl Packed for Stop<f32> {
    fn pack(&self, put: &mut impl FnMut(f32)) {
        for contact in &self.contacts {
            contact.pack(put);
        }
    }

    fn unpack(words: &[f32]) -> Option<Self> {
        let ([first, second], []) = words.as_chunks::<2>() else {
            return None;
        };
        Some(Self {
            contacts: [Contact::unpack(first)?, Contact::unpack(second)?],
        })
    }
}
