//! The numbers of an effect, and what follows from their list: its constructor, the checks, and its words in a pack.

use super::Packed;
use crate::error::ConfigError;
use crate::limits;

/// Range of a coefficient that may have either sign.
pub(super) const COEFFICIENTS: [f64; 2] = [-limits::COEFFICIENT, limits::COEFFICIENT];
/// Range of a stretch at which something slips, mm.
pub(super) const SLIP_LIMITS: [f64; 2] = [1e-9, limits::DISPLACEMENT];

/// Makes what follows from the list of an effect's parameters, each with unit, range, and after `=>` how a file may leave it out.
///
/// An effect that is made of its parameters as they are has its type made too, with a constructor that takes them in this order and
/// their documentation; `listed!` in its [`Equations`](super::Equations) refers to that. So has an `element` of which an effect has
/// several, without a constructor.
///
/// An effect that computes other numbers from its parameters has its own type, constructor and checks. For that, the names of its fields
/// stand before `of`, unless they do not go into a pack as they are:
///
/// ```text
/// numbers! {
///     Compliance { stiffness, step } of {
///         stiffness: "kN/mm" in [1e-3, limits::COEFFICIENT],
///     }
/// }
/// ```
macro_rules! numbers {
    (
        $(#[$attribute:meta])*
        pub struct $effect:ident {
            $($(#[doc = $doc:literal])+ $name:ident: $unit:literal in $range:expr $(=> $absent:expr)?,)+
        }
    ) => {
        numbers! {
            element $(#[$attribute])*
            pub struct $effect {
                $($name: $unit in $range $(=> $absent)?,)+
            }
        }

        impl<R: crate::real::Real> $effect<R> {
            $(#[doc = concat!("* `", stringify!($name), "`:" $(, $doc, "\n  ")+)])+
            ///
            /// # Errors
            /// The field that is not finite or out of range.
            pub fn new($($name: R),+) -> Result<Self, crate::error::ConfigError> {
                let new = Self { $($name),+ };
                new.check_numbers()?;
                Ok(new)
            }

            fn of_parameters(parameters: &[f64]) -> Result<Self, crate::error::ConfigError> {
                let [$($name),+] = crate::effects::numbers::exactly(parameters)?.map(R::from_f64);
                Self::new($($name),+)
            }
        }
    };
    (
        element $(#[$attribute:meta])*
        $visibility:vis struct $effect:ident {
            $($name:ident: $unit:literal in $range:expr $(=> $absent:expr)?,)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $visibility struct $effect<R> {
            $($name: R,)+
        }

        impl<R: crate::real::Real> $effect<R> {
            fn check_numbers(&self) -> Result<(), crate::error::ConfigError> {
                $({
                    const RANGE: [f64; 2] = $range;
                    crate::real::in_range(stringify!($name), self.$name, RANGE[0], RANGE[1])?;
                })+
                Ok(())
            }
        }

        numbers! {
            $effect { $($name),+ } of {
                $($name: $unit in $range $(=> $absent)?,)+
            }
        }
    };
    (
        $effect:ident { $($word:ident),+ } of $parameters:tt
    ) => {
        numbers! { $effect of $parameters }

        impl<R: crate::real::Real> $effect<R> {
            const ABSENT: Self = Self { $($word: R::ZERO),+ };
        }

        impl crate::effects::Packed for $effect<f32> {
            fn pack(&self, put: &mut impl FnMut(f32)) {
                [$(self.$word),+].into_iter().for_each(put);
            }

            fn unpack(words: &[f32]) -> Option<Self> {
                let &[$($word),+] = words else { return None };
                Some(Self { $($word),+ })
            }
        }
    };
    (
        $effect:ident of {
            $($name:ident: $unit:literal in $range:expr $(=> $absent:expr)?,)+
        }
    ) => {
        impl<R: crate::real::Real> $effect<R> {
            const PARAMETERS: &'static [crate::effects::description::Parameter] = &[$({
                const RANGE: [f64; 2] = $range;
                crate::effects::description::Parameter::new(stringify!($name), $unit, RANGE[0], RANGE[1])
                    $(.or($absent))?
            },)+];
        }
    };
}

/// In the [`Equations`](super::Equations) of an effect that is made of its parameters as they are: what `numbers!` made of their list.
macro_rules! listed {
    () => {
        const NONE: Self = Self::ABSENT;

        fn from_parameters(parameters: &[f64], _: f64) -> Result<Self, crate::error::ConfigError> {
            Self::of_parameters(parameters)
        }

        fn check(&self) -> Result<(), crate::error::ConfigError> {
            self.check_numbers()
        }
    };
}

/// Up to `MOST` elements of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Elements<E, const MOST: usize> {
    /// An absent element is all zeros.
    pub all: [E; MOST],
    /// The number of those that are present.
    pub count: usize,
}

impl<E: Copy, const MOST: usize> Elements<E, MOST> {
    /// None.
    pub const fn absent(absent: E) -> Self {
        Self {
            all: [absent; MOST],
            count: 0,
        }
    }

    /// One of each of `given`.
    ///
    /// # Errors
    /// Those of `make`. Their number is not checked.
    pub fn of<G>(
        given: &[G],
        absent: E,
        make: impl Fn(&G) -> Result<E, ConfigError>,
    ) -> Result<Self, ConfigError> {
        let mut new = Self {
            all: [absent; MOST],
            count: given.len(),
        };
        for (slot, given) in new.all.iter_mut().zip(given) {
            *slot = make(given)?;
        }
        Ok(new)
    }

    /// Those that are present.
    #[inline(always)]
    pub fn used(&self) -> impl Iterator<Item = &E> {
        self.all.iter().take(self.count)
    }

    /// Checks each with `check`.
    ///
    /// # Errors
    /// None of them, too many, or the error of `check`.
    pub fn check(
        &self,
        field: &'static str,
        check: fn(&E) -> Result<(), ConfigError>,
    ) -> Result<(), ConfigError> {
        some(field, &self.all, self.count)?
            .iter()
            .try_for_each(check)
    }
}

impl<E: Packed + Copy, const MOST: usize> Elements<E, MOST> {
    /// Passes the words of each to `put`.
    pub fn pack(&self, put: &mut impl FnMut(f32)) {
        self.used().for_each(|element| element.pack(put));
    }

    /// The elements from their words, `WORDS` of each. `None` if they cannot be that; their number is not checked.
    pub fn unpack<const WORDS: usize>(words: &[f32], absent: E) -> Option<Self> {
        let (packed, []) = words.as_chunks::<WORDS>() else {
            return None;
        };
        let mut all = [absent; MOST];
        for (slot, words) in all.iter_mut().zip(packed) {
            *slot = E::unpack(words)?;
        }
        Some(Self {
            all,
            count: packed.len(),
        })
    }
}

/// Returns `parameters` as an array of `N`.
///
/// # Errors
/// More or fewer than `N`.
pub(super) fn exactly<const N: usize>(parameters: &[f64]) -> Result<[f64; N], ConfigError> {
    parameters.try_into().map_err(|_| ConfigError::Full {
        field: "parameters",
        capacity: N,
    })
}

/// Splits `parameters` into elements of `N`, at most `MOST` of them, and applies `make` to each.
///
/// # Errors
/// Too many elements, or an incomplete one.
pub(super) fn elements<const N: usize, const MOST: usize, E>(
    field: &'static str,
    parameters: &[f64],
    make: impl Fn([f64; N]) -> E,
) -> Result<heapless::Vec<E, MOST>, ConfigError> {
    let (groups, rest) = parameters.as_chunks();
    if !rest.is_empty() || groups.len() > MOST {
        return Err(ConfigError::Full {
            field,
            capacity: MOST,
        });
    }
    let mut elements = heapless::Vec::new();
    for &group in groups {
        // There is room, as checked above.
        let _ = elements.push(make(group));
    }
    Ok(elements)
}

/// The first `used` of an effect's elements, at least one.
///
/// # Errors
/// None, or more than the capacity.
#[inline(never)]
fn some<'t, T>(field: &'static str, all: &'t [T], used: usize) -> Result<&'t [T], ConfigError> {
    match all.get(..used) {
        Some([]) => Err(ConfigError::Empty(field)),
        Some(used) => Ok(used),
        None => Err(ConfigError::Full {
            field,
            capacity: all.len(),
        }),
    }
}
