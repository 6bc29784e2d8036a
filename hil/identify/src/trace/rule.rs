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
    /// Of a candidate: the best of the step predicts the judging cycles clearly better.
    Worse,
    /// Of a candidate: it does as well as the best of the step, which has the same families in another form.
    SameFamilies,
    /// Of a candidate: it does as well as the best of the step, but a shape of it stands where the effect is a simpler one.
    AtLimit,
    /// Of a candidate: two simpler effects that it may stand for do as well in its place.
    SimplerOnes,
    /// Of a candidate: it predicts the judging cycles not clearly better than the law before the step.
    LittleGain,
    /// Of a candidate that was added: the judging cycles are predicted as well without it.
    Needless,
    /// Of a candidate that was added: fitted to all that may be fitted it is nothing.
    Vanishes,
    /// Of the effects found: they leave more than noise-limited laws do.
    LeavesTooMuch,
    /// Of the effects found: they leave too large a part of what the law alone leaves beyond the noise.
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
    /// Of a residual table: no table fits clearly better than the law does.
    TableWorthLittle,
    /// Of a residual table: blocks that are left out of the fit are not clearly better predicted than without it.
    TableUnknownElsewhere,
}

impl Rule {
    /// What the rule says of what it rejects, to follow a name.
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
