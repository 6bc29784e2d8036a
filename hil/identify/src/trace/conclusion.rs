//! The verdict as a reader needs it.

use super::result::{TraceResult, Verdict};
use crate::trace::verdict::VerdictPolicy;

/// The verdict, with [`Verdict::None`] divided in three: nothing is missing, or nothing can be decided for one of two reasons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conclusion {
    /// Named effects explain the part of the force that the law does not.
    Found,
    /// The law explains the recordings.
    NothingMissing,
    /// The law explains the recordings only because the estimated motion is uncertain: an effect may be hidden.
    Hidden,
    /// The law explains the fitted samples, but not the held-out ones: an effect may be missing that the fitted samples do not show.
    Contradicted,
    /// Several effects explain the rest equally well.
    Ambiguous,
    /// No listed effect explains the rest.
    Unlisted,
}

impl Conclusion {
    /// Every conclusion.
    pub const ALL: [Self; 6] = [
        Self::Found,
        Self::NothingMissing,
        Self::Hidden,
        Self::Contradicted,
        Self::Ambiguous,
        Self::Unlisted,
    ];

    /// From a verdict on a model with the error `fitted` on fitted samples, where the noise of the force has the error `noise`, both NRMSE;
    /// and [`TraceResult::held_out_differs`].
    pub fn of(verdict: Verdict, fitted: f64, noise: f64, held_out_differs: bool) -> Self {
        match verdict {
            Verdict::None if fitted > VerdictPolicy::in_use().hidden_by_motion * noise => {
                Self::Hidden
            }
            Verdict::None if held_out_differs => Self::Contradicted,
            Verdict::None => Self::NothingMissing,
            Verdict::Found => Self::Found,
            Verdict::Ambiguous => Self::Ambiguous,
            Verdict::Unlisted => Self::Unlisted,
        }
    }

    /// In a few words, for a table.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::NothingMissing => "nothing missing",
            Self::Hidden => "not decided: motion uncertain",
            Self::Contradicted => "not decided: held-out data differ",
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
            self.held_out_differs,
        )
    }
}
