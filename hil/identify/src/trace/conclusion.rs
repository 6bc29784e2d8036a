//! The verdict as a reader needs it.

use super::result::{TraceResult, Verdict};
use crate::policy::policy;

/// The verdict, with [`Verdict::None`] divided in two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conclusion {
    /// Named effects explain the part of the force that the law does not.
    Found,
    /// The law explains the recordings.
    NothingMissing,
    /// The law explains the recordings only because the estimated motion is uncertain: an effect may be hidden.
    NotDecided,
    /// Several effects explain the rest equally well.
    Ambiguous,
    /// No listed effect explains the rest.
    Unlisted,
}

impl Conclusion {
    /// Every conclusion.
    pub const ALL: [Self; 5] = [
        Self::Found,
        Self::NothingMissing,
        Self::NotDecided,
        Self::Ambiguous,
        Self::Unlisted,
    ];

    /// From a verdict on a model with the error `fitted` on fitted samples, where the noise of the force has the error `noise`; both NRMSE.
    pub fn of(verdict: Verdict, fitted: f64, noise: f64) -> Self {
        match verdict {
            Verdict::None if fitted > policy().verdict.hidden_by_motion * noise => Self::NotDecided,
            Verdict::None => Self::NothingMissing,
            Verdict::Found => Self::Found,
            Verdict::Ambiguous => Self::Ambiguous,
            Verdict::Unlisted => Self::Unlisted,
        }
    }

    /// In two words, for a table.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::NothingMissing => "nothing missing",
            Self::NotDecided => "not decided",
            Self::Ambiguous => "ambiguous",
            Self::Unlisted => "unlisted",
        }
    }
}

impl TraceResult {
    /// The verdict as a reader needs it.
    pub fn conclusion(&self) -> Conclusion {
        Conclusion::of(
            self.verdict,
            self.augmented.nrmse_fitted,
            self.noise_floor_nrmse,
        )
    }
}
