//! The rules by which a trace rejects candidates, by name.

use serde::{Deserialize, Serialize};

/// The reason why a candidate is not in the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Of a candidate: no effects are added to a law that is noise-limited.
    NoiseLimited,
    /// Of a candidate: one of its terms is a source of energy, or a mass or a spring that pushes.
    NotPassive,
    /// Of a drift: the cycles within blocks do not show it.
    StandsStill,
    /// Of a tone: its frequency is a sum of frequencies of the motion, which a specimen produces from them.
    InStepWithMotion,
    /// Of a drift: the measured temperature does equally well in its place.
    Warmth,
    /// Of a candidate: it promised too little for a fit, and with the parameters of the start of a fit its error was larger than
    /// that of the best of the step.
    LittlePromise,
    /// Of a candidate: the best of the step predicts the judging cycles clearly better.
    Worse,
    /// Of a candidate: it does as well as the best of the step, which has the same families in another form.
    SameFamilies,
    /// Of a candidate: it does as well as the best of the step, but one of its shapes has a value at which the effect is a simpler
    /// one.
    AtLimit,
    /// Of a candidate: two simpler effects that it may stand for do equally well in its place.
    SimplerOnes,
    /// Of a candidate: it does not predict the judging cycles clearly better than the law before the step.
    LittleGain,
    /// Of a candidate that was added: the judging cycles are predicted equally well without it.
    Needless,
    /// Of a candidate that was added: it vanishes in the fit to all open samples.
    Vanishes,
    /// Of the effects found: their error is larger than that of noise-limited laws.
    LeavesTooMuch,
    /// Of the effects found: the remaining error is too large a part of the error of the law alone beyond the noise.
    AccountsForTooLittle,
    /// Of the effects found: they hardly improve the prediction of blocks left out of the fit.
    UnknownElsewhere,
    /// Of the effects found: they predict the held-out samples less well than the fitted ones, by more than the noise explains.
    SaysLess,
    /// Of an effect of an incomplete law: it does not reduce the error on some held-out condition, or too few conditions show it.
    HelpsNotEverywhere,
    /// Of an effect that conditions confirm: it does not reduce the error on the held-out samples.
    GainsNothingElsewhere,
    /// Of such an effect: its parameters differ between fits without one or another condition by more than their uncertainty.
    Unsteady,
    /// Of such an effect: another one in its place predicts the held-out conditions equally well.
    Rivalled,
    /// Of a residual table: no table fits clearly better than the law does.
    TableWorthLittle,
    /// Of a residual table: it does not clearly improve the prediction of blocks left out of the fit.
    TableUnknownElsewhere,
}

impl Rule {
    /// The reason in words, to follow the name of the rejected candidate.
    pub fn says(self) -> &'static str {
        match self {
            Self::NoiseLimited => "nothing is added to a noise-limited law",
            Self::NotPassive => "a term would give energy, or push as a mass or a spring does not",
            Self::StandsStill => "the cycles within a block show nothing of such a drift",
            Self::InStepWithMotion => "its frequency is one that a specimen makes of the motion's",
            Self::Warmth => "the measured temperature explains as much in the place of the drift",
            Self::LittlePromise => {
                "it promised too little to be fitted, and the best of the step is clearly better"
            }
            Self::Worse => "the best of the step predicts the judging cycles clearly better",
            Self::SameFamilies => "another form of the same families does as well",
            Self::AtLimit => {
                "it does as well as the best, but only where it turns into a simpler effect"
            }
            Self::SimplerOnes => "two simpler effects that it may stand for do as well",
            Self::LittleGain => {
                "the judging cycles are not predicted clearly better than before the step"
            }
            Self::Needless => "the judging cycles are predicted as well without it",
            Self::Vanishes => "fitted to all that may be fitted, nothing of it is left",
            Self::LeavesTooMuch => {
                "they leave more than the noise of the force and of the estimated motion"
            }
            Self::AccountsForTooLittle => {
                "they leave too large a part of what the law alone leaves beyond the noise"
            }
            Self::UnknownElsewhere => {
                "blocks that were left out of the fit are hardly better predicted than by the law alone"
            }
            Self::SaysLess => {
                "they leave more than the noise of what was held out, which was not fitted"
            }
            Self::HelpsNotEverywhere => {
                "it does not help on every condition held out in turn, or shows on too few"
            }
            Self::GainsNothingElsewhere => "it gains nothing on what was held out",
            Self::Unsteady => {
                "its parameters differ from one condition held out to the next by more than they are uncertain"
            }
            Self::Rivalled => "another effect in its place does as well",
            Self::TableWorthLittle => "no table fits clearly better than the law does",
            Self::TableUnknownElsewhere => {
                "blocks that were left out of the fit are not clearly better predicted than without it"
            }
        }
    }
}
