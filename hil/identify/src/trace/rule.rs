//! The rules by which a trace rejects what it tried, by name.

use serde::{Deserialize, Serialize};

/// Why something that was tried is not in the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Of a candidate: nothing is added to a law that is noise-limited.
    NoiseLimited,
    /// Of a candidate: a term of it gives energy, or is a mass or a spring that pushes.
    NotPassive,
    /// Of a drift: the cycles within blocks know nothing of it.
    StandsStill,
    /// Of a tone: its frequency is a sum of the motion's, which a specimen makes of them.
    InStepWithMotion,
    /// Of a drift: the measured temperature does as well in its place.
    Warmth,
    /// Of a candidate: too little was promised for a fit, and less was left as a fit would begin by the best of the step.
    LittlePromise,
    /// Of a candidate: the best of the step predicts the validation data clearly better.
    Worse,
    /// Of a candidate: it does as well as the best of the step, which has the same families in another form.
    SameFamilies,
    /// Of a candidate: it does as well as the best of the step, but a shape of it stands where the effect is a simpler one.
    AtLimit,
    /// Of a candidate: two simpler effects together predict as well in its place.
    SimplerOnes,
    /// Of a candidate: it predicts the judging cycles not clearly better than the law before the step.
    LittleGain,
    /// Of a candidate that was added: the validation data is predicted as well without it.
    Needless,
    /// Of a candidate that was added: fitted to all that may be fitted it is nothing.
    Vanishes,
    /// Of the effects found: they leave more than noise-limited laws do.
    LeavesTooMuch,
    /// Of the effects found: their residual beyond the noise is too large a part of the law's.
    AccountsForTooLittle,
    /// Of the effects found: blocks that are left out of the fit are hardly better predicted than by the law alone.
    UnknownElsewhere,
    /// Of the effects found: what was held out is predicted less well than what was fitted, by more than noise makes.
    SaysLess,
    /// Of an effect beside which something is missing: held out, some condition is not left with less by it, or too few show it.
    HelpsNotEverywhere,
    /// Of an effect that conditions confirm: what was held out is not left with less by it.
    GainsNothingElsewhere,
    /// Of such an effect: fits without one condition or the other differ in its parameters by more than these are uncertain.
    Unsteady,
    /// Of such an effect: another in its place predicts the conditions held out as well.
    Rivalled,
    /// Of a residual table: no table fits clearly better than the law.
    TableWorthLittle,
    /// Of a residual table: blocks that are left out of the fit are not clearly better predicted than without it.
    TableUnknownElsewhere,
}

impl Rule {
    /// What the rule says of what it rejects, to follow a name.
    pub fn says(self) -> &'static str {
        match self {
            Self::NoiseLimited => "the law is noise-limited, so nothing is added",
            Self::NotPassive => "a term would deliver energy, or act as no mass or spring can",
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
            Self::SimplerOnes => "two simpler effects together predict as well",
            Self::LittleGain => {
                "it does not predict the validation data clearly better than the law before the step"
            }
            Self::Needless => "the validation data is predicted as well without it",
            Self::Vanishes => "fitted to all training and validation data, it vanishes",
            Self::LeavesTooMuch => {
                "their residual exceeds the noise of the force and of the estimated motion"
            }
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
