//! How numbers that decide something are stated.
//!
//! A number decides where another value of it would lead to another answer: a threshold, a limit of what is accepted, the length of a
//! window, a level of significance. Each stands in one struct beside the code that it is for, by [`numbers!`](macro@crate::numbers), with a
//! sentence and a [`Mark`] that says where it comes from. The code reads it there: `SignPolicy::in_use().certain`. A list of these
//! structs, by [`policy!`](macro@crate::policy), serves whoever changes or prints them all.
//!
//! A number that only bounds time or memory, and constants that an array's length or a pattern needs, are plain constants with the
//! same sentence and source in their comment.
//!
//! A mark names what a number was tuned on in a few words:
//!
//! | words | what |
//! |---|---|
//! | the blind trial | `hil blind`: specimens with hidden effects, `hil/trials/src/blind` |
//! | the injected channel faults | `hil/trials/tests/traces/channel_faults.rs` |
//! | the estimated motions | `hil/recording/tests/recording/motion.rs`, and the error of the motion in the blind trial |
//! | the recordings of others | `../shared/recordings` beside the repository |
//!
//! What each tuned number is worth, `hil study numbers` measures: the blind trial with the number halved and doubled, in
//! `docs/numbers.md`.

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// It follows from something else, which the reason gives.
    Derived,
    /// Another would do as well; the reason says why this one.
    Convention,
    /// It was chosen for what it leads to; the reason says on what.
    Tuned,
}

/// A number of a policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Field {
    /// Its name in its part of the policy.
    pub name: &'static str,
    /// What it decides, with its unit.
    pub about: &'static str,
    /// Where it comes from.
    pub mark: Mark,
    /// The derivation, why this convention, or on what it was tuned.
    pub reason: &'static str,
}

/// Numbers were given after those in use were read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the numbers that decide are in use already")]
pub struct AlreadyInUse;

/// States the numbers of one concern: a struct with their values, their [`Default`], and the list `FIELDS` of them.
///
/// ```
/// mesh_damper_recording::numbers! {
///     /// When a door is opened.
///     DoorPolicy {
///         /// Knocks after which it is opened.
///         knocks: usize = 3, Convention("one may be the wind");
///     }
/// }
/// assert_eq!(DoorPolicy::default().knocks, 3);
/// assert_eq!(DoorPolicy::FIELDS[0].reason, "one may be the wind");
/// ```
#[macro_export]
macro_rules! numbers {
    ($(#[doc = $concern:literal])+ $name:ident {
        $($(#[doc = $about:literal])+ $field:ident: $kind:ty = $default:expr, $mark:ident($reason:literal);)+
    }) => {
        $(#[doc = $concern])+
        #[derive(Clone, Debug, PartialEq, ::serde::Serialize, ::serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[doc = $about])+ #[doc = concat!(" ", stringify!($mark), ": ", $reason, ".")] pub $field: $kind,)+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }

        impl $name {
            /// Its numbers, in order.
            pub const FIELDS: &[$crate::numbers::Field] = &[$($crate::numbers::Field {
                name: stringify!($field),
                about: concat!($($about),+),
                mark: $crate::numbers::Mark::$mark,
                reason: $reason,
            },)+];

            fn cell() -> &'static ::std::sync::OnceLock<Self> {
                static IN_USE: ::std::sync::OnceLock<$name> = ::std::sync::OnceLock::new();
                &IN_USE
            }

            /// The numbers in use: those that were installed, or the default.
            pub fn in_use() -> &'static Self {
                Self::cell().get_or_init(Self::default)
            }

            /// Puts these numbers in use for the whole process, before any work.
            ///
            /// # Errors
            /// Numbers of this concern were installed or read before.
            pub fn install(self) -> Result<(), $crate::numbers::AlreadyInUse> {
                Self::cell().set(self).map_err(|_| $crate::numbers::AlreadyInUse)
            }
        }
    };
}

/// Lists the concerns of a crate: the struct `Policy` of their numbers, which can be installed together.
#[macro_export]
macro_rules! policy {
    ($($(#[doc = $about:literal])+ $part:ident: $kind:ty,)+) => {
        /// The numbers that decide in this crate, concern by concern.
        #[derive(Clone, Debug, Default, PartialEq, ::serde::Serialize, ::serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct Policy {
            $($(#[doc = $about])+ pub $part: $kind,)+
        }

        impl Policy {
            /// Its concerns by name, each with its numbers.
            pub const PARTS: &[(&str, &[$crate::numbers::Field])] = &[$((stringify!($part), <$kind>::FIELDS),)+];

            /// The numbers in use.
            pub fn in_use() -> Self {
                Self { $($part: <$kind>::in_use().clone(),)+ }
            }

            /// Puts them in use for the whole process, before any work.
            ///
            /// # Errors
            /// Numbers of a concern were installed or read before; those of the concerns before it are installed then.
            pub fn install(self) -> Result<(), $crate::numbers::AlreadyInUse> {
                $(self.$part.install()?;)+
                Ok(())
            }
        }
    };
}
