//! The numbers that decide how a recording is read, and the way in which such numbers are stated.
//!
//! A number decides where another value of it would lead to another answer: a threshold, a limit, the length of a window, a
//! count of candidates, a level of significance. Each stands in one struct beside the code that it is for, by
//! [`numbers!`](crate::numbers), with a sentence and a [`Mark`] that says where it comes from; [`policy!`](crate::policy!) makes
//! one [`Policy`] of these structs. Where an array's length or a pattern needs a constant, it stays one, with the same mark in
//! its comment.
//!
//! A mark names what a number was tuned on in a few words:
//!
//! | words | what |
//! |---|---|
//! | the blind trial | `hil blind`: specimens with hidden effects, `hil/trials/src/blind` |
//! | the injected channel faults | `hil/identify/tests/identify/channel_faults.rs` |
//! | the estimated motions | `hil/recording/tests/motion.rs`, and the error of the motion in the blind trial |
//! | the recordings of others | `../shared/recordings` beside the repository |
//!
//! What each tuned number is worth, `hil study numbers` measures: the blind trial with the number halved and doubled, in
//! `docs/numbers.md`.

pub use crate::averaging::AveragingPolicy;
pub use crate::clock::ClockPolicy;
pub use crate::consistency::ConsistencyPolicy;
pub use crate::cycles::CyclesPolicy;
pub use crate::faults::FaultsPolicy;
pub use crate::faults::bridge::BridgePolicy;
pub use crate::faults::clipping::ClippingPolicy;
pub use crate::faults::held::HeldPolicy;
pub use crate::faults::hum::HumPolicy;
pub use crate::faults::scale::ScalePolicy;
pub use crate::faults::shift::ShiftPolicy;
pub use crate::faults::sign::SignPolicy;
pub use crate::faults::spikes::SpikesPolicy;
pub use crate::faults::velocity::VelocityPolicy;
pub use crate::harmonic::HarmonicPolicy;
pub use crate::kinks::KinksPolicy;
pub use crate::motion::MotionPolicy;
pub use crate::motion_error::MotionErrorPolicy;
pub use crate::noise::NoisePolicy;
pub use crate::pink::PinkPolicy;
pub use crate::resample::ResamplePolicy;
pub use crate::rest::RestPolicy;
pub use crate::smoother::SmootherPolicy;
pub use crate::trajectory::TrajectoryPolicy;
pub use crate::zero::ZeroPolicy;
pub use crate::zeros::ZerosPolicy;

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// It follows from something else, which the reason gives.
    Derived,
    /// Another would do as well, or it bounds time and memory; the reason says why this one.
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

/// A policy was given after the first number of the one in use was read.
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
            pub const FIELDS: &[$crate::policy::Field] = &[$($crate::policy::Field {
                name: stringify!($field),
                about: concat!($($about),+),
                mark: $crate::policy::Mark::$mark,
                reason: $reason,
            },)+];
        }
    };
}

/// Makes the one policy of a crate of its concerns: the struct `Policy`, `policy()`, which gives the one in use, and `install`.
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
            pub const PARTS: &[(&str, &[$crate::policy::Field])] = &[$((stringify!($part), <$kind>::FIELDS),)+];
        }

        static IN_USE: ::std::sync::OnceLock<Policy> = ::std::sync::OnceLock::new();

        /// The policy in use: that which was installed, or the default.
        pub fn policy() -> &'static Policy {
            IN_USE.get_or_init(Policy::default)
        }

        /// Puts `policy` in use for the whole process, before any work.
        ///
        /// # Errors
        /// A policy was installed or read before.
        pub fn install(policy: Policy) -> Result<(), $crate::policy::AlreadyInUse> {
            IN_USE.set(policy).map_err(|_| $crate::policy::AlreadyInUse)
        }
    };
}

crate::policy! {
    /// Channels that were smoothed before they were written.
    averaging: AveragingPolicy,
    /// What stands in for samples that were not measured.
    bridge: BridgePolicy,
    /// Channels at the end of their range.
    clipping: ClippingPolicy,
    /// The clock behind the times.
    clock: ClockPolicy,
    /// Recordings that contradict each other.
    consistency: ConsistencyPolicy,
    /// Cycles, and blocks of like ones.
    cycles: CyclesPolicy,
    /// What all searches for channel faults share.
    faults: FaultsPolicy,
    /// Motion that is a sine.
    harmonic: HarmonicPolicy,
    /// Values that were repeated.
    held: HeldPolicy,
    /// Hum of the mains.
    hum: HumPolicy,
    /// Where the velocity jumps.
    kinks: KinksPolicy,
    /// Velocity and acceleration of a measured displacement.
    motion: MotionPolicy,
    /// How far that may be off.
    motion_error: MotionErrorPolicy,
    /// The noise of a channel.
    noise: NoisePolicy,
    /// Noise that grows towards low frequencies.
    pink: PinkPolicy,
    /// Equal steps of time.
    resample: ResamplePolicy,
    /// Where the displacement stands still.
    rest: RestPolicy,
    /// Units off by a thousand.
    scale: ScalePolicy,
    /// A force that is late or early.
    shift: ShiftPolicy,
    /// A force with the wrong sign.
    sign: SignPolicy,
    /// Motions of few samples to the cycle.
    smoother: SmootherPolicy,
    /// Samples that stand out.
    spikes: SpikesPolicy,
    /// A recording made ready for identification.
    trajectory: TrajectoryPolicy,
    /// A measured velocity.
    velocity: VelocityPolicy,
    /// A zero that steps.
    zero: ZeroPolicy,
    /// A zero that is not that of other recordings.
    zeros: ZerosPolicy,
}
