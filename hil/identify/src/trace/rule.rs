//! The rules by which a trace rejects candidates, by name.

use serde::{Deserialize, Serialize};

/// The reason why a candidate is not in the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// For a candidate: the law is noise-limited, and no effect is added to such a law.
    NoiseLimited,
    /// For a candidate: one of its terms would be a source of energy, or a negative stiffness.
    NotPassive,
    /// For a drift: the cycles within blocks do not show it.
    StandsStill,
    /// For a tone: its frequency is a sum of frequencies of the motion, and a specimen produces such frequencies itself.
    InStepWithMotion,
    /// For a drift: the measured temperature explains the force equally well.
    Warmth,
    /// For a candidate: its expected gain was too small for a fit, and its error with the parameters at the start of a fit was
    /// larger than that of the best candidate of the step.
    LittlePromise,
    /// For a candidate: the best candidate of the step predicts the validation data clearly better.
    Worse,
    /// For a candidate: it predicts as well as the best candidate of the step, which has the same families in another form.
    SameFamilies,
    /// For a candidate: it predicts as well as the best candidate of the step, but one of its shape parameters is at a limit at
    /// which the effect reduces to a simpler one.
    AtLimit,
    /// For a candidate: two simpler effects together predict clearly better.
    SimplerOnes,
    /// For a candidate: it does not predict the validation cycles clearly better than the law before the step.
    LittleGain,
    /// For an added candidate: the law without it predicts the validation data equally well.
    Needless,
    /// For an added candidate: fitted to all training and validation data, it vanishes, or may be 0 within its interval.
    Vanishes,
    /// For the effects found: their error is larger than that of noise-limited laws.
    LeavesTooMuch,
    /// For the effects found: their residual can be predicted from the motion on conditions left out, whatever its size is.
    Predictable,
    /// For the effects found: their residual beyond the noise is too large a part of the law's residual.
    AccountsForTooLittle,
    /// For the effects found: they hardly improve the prediction of blocks left out of the fit.
    UnknownElsewhere,
    /// For the effects found: they predict the held-out samples worse than the fitted samples, by more than the noise explains.
    SaysLess,
    /// For an effect of an incomplete law: it does not reduce the error on every held-out condition, or too few conditions show it.
    HelpsNotEverywhere,
    /// For an effect that conditions confirm: it does not reduce the error on the held-out samples.
    GainsNothingElsewhere,
    /// For such an effect: its parameters differ between the fits without single conditions by more than their uncertainty.
    Unsteady,
    /// For such an effect: another effect in its place predicts the held-out conditions equally well.
    Rivalled,
    /// For a residual table: no table fits clearly better than the law.
    TableWorthLittle,
    /// For a residual table: it does not clearly improve the prediction of blocks left out of the fit.
    TableUnknownElsewhere,
}

impl Rule {
    /// The reason in words, to follow the name of the rejected candidate.
    pub fn says(self) -> &'static str {
        match self {
            Self::NoiseLimited => "the law is noise-limited, so nothing is added",
            Self::NotPassive => "a term would deliver energy, or has a negative stiffness",
            Self::StandsStill => "the cycles within a block show no such drift",
            Self::InStepWithMotion => {
                "its frequency is one that a specimen can generate from the motion"
            }
            Self::Warmth => "the measured temperature explains as much as the drift",
            Self::LittlePromise => {
                "its predicted gain was too small to fit it, and the best of the step is clearly better"
            }
            Self::Worse => "the best of the step predicts the validation data clearly better",
            Self::SameFamilies => "another form of the same families predicts as well",
            Self::AtLimit => {
                "it predicts as well as the best, but only at a limit where it becomes a simpler effect"
            }
            Self::SimplerOnes => "two simpler effects together predict clearly better",
            Self::LittleGain => {
                "it does not predict the validation data clearly better than the law before the step"
            }
            Self::Needless => "the validation data is predicted as well without it",
            Self::Vanishes => "fitted to all training and validation data, it vanishes",
            Self::LeavesTooMuch => {
                "their residual exceeds the noise of the force and of the estimated motion"
            }
            Self::Predictable => "their residual can be predicted from the motion",
            Self::AccountsForTooLittle => {
                "their residual beyond the noise is too large a part of the law's"
            }
            Self::UnknownElsewhere => {
                "they predict blocks left out of the fit hardly better than the law alone"
            }
            Self::SaysLess => "their residual on the held-out data exceeds the noise",
            Self::HelpsNotEverywhere => {
                "it does not help on every condition held out in turn, or acts on too few of them"
            }
            Self::GainsNothingElsewhere => "it does not reduce the error on the held-out data",
            Self::Unsteady => {
                "its parameters differ between the conditions held out by more than their uncertainty"
            }
            Self::Rivalled => "another effect in its place predicts as well",
            Self::TableWorthLittle => "no table fits clearly better than the law",
            Self::TableUnknownElsewhere => {
                "it does not predict blocks left out of the fit clearly better"
            }
        }
    }
}
