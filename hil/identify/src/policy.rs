//! All numbers that decide what a fit and a trace find, for whoever changes or prints them; the code itself reads them in their places.
//! [`mod@mesh_damper_recording::numbers`] says how they are stated.

use crate::beyond_noise::BeyondNoisePolicy;
use crate::correction::CorrectionPolicy;
use crate::correction::design::DesignPolicy;
use crate::correction::edges::EdgesPolicy;
use crate::correction::gram::GramPolicy;
use crate::correction::growth::GrowthPolicy;
use crate::correction::memory::MemoryPolicy;
use crate::correction::search::SearchPolicy;
use crate::correction::settle::SettlePolicy;
use crate::correction::system::SystemPolicy;
use crate::correction::trend::TrendPolicy;
use crate::exact::ExactPolicy;
use crate::problem::ProblemPolicy;
use crate::shape::ShapePolicy;
use crate::tolerance::TolerancePolicy;
use crate::trace::TracePolicy;
use crate::trace::adopt::AdoptPolicy;
use crate::trace::aligned::AlignedPolicy;
use crate::trace::confirm::ConfirmPolicy;
use crate::trace::early::EarlyPolicy;
use crate::trace::held_range::HeldRangePolicy;
use crate::trace::left_out::LeftOutPolicy;
use crate::trace::remainder::RemainderPolicy;
use crate::trace::score::ScorePolicy;
use crate::trace::select::SelectPolicy;
use crate::trace::separating::SeparatingPolicy;
use crate::trace::split::SplitPolicy;
use crate::trace::tones::TonesPolicy;
use crate::trace::verdict::VerdictPolicy;
use crate::trace::wander::WanderPolicy;
use crate::trace::witness::WitnessPolicy;
use crate::uncertainty::UncertaintyPolicy;

mesh_damper_recording::policy! {
    /// What recordings of one rig share.
    aligned: AlignedPolicy,
    /// What a law leaves beyond the noise.
    beyond_noise: BeyondNoisePolicy,
    /// When a residual table is taken.
    correction: CorrectionPolicy,
    /// The samples that a residual table is fitted to.
    design: DesignPolicy,
    /// A force that is early although a damper could have it.
    early: EarlyPolicy,
    /// Where something may touch.
    edges: EdgesPolicy,
    /// The last steps of a fit, by the crate's own force.
    exact: ExactPolicy,
    /// The least squares of a residual table.
    gram: GramPolicy,
    /// Which trends a residual table follows.
    growth: GrowthPolicy,
    /// Held-out recordings outside the fitted conditions.
    held_range: HeldRangePolicy,
    /// Conditions that are left out of a fit.
    left_out: LeftOutPolicy,
    /// What a residual table may remember.
    memory: MemoryPolicy,
    /// When a law with more takes the place of the law alone.
    adopt: AdoptPolicy,
    /// When an effect is confirmed though something else is missing too.
    confirm: ConfirmPolicy,
    /// When a force wanders.
    wander: WanderPolicy,
    /// What the remainder depends on.
    remainder: RemainderPolicy,
    /// The fit of the law and of effects.
    problem: ProblemPolicy,
    /// Whether one law predicts better than another.
    score: ScorePolicy,
    /// How a residual table is sought.
    search: SearchPolicy,
    /// The search for effects.
    select: SelectPolicy,
    /// The test that would tell effects apart.
    separating: SeparatingPolicy,
    /// When the exponents beside a residual table have settled.
    settle: SettlePolicy,
    /// Within what ranges the parameters of effects are sought.
    shape: ShapePolicy,
    /// Which samples are kept apart.
    split: SplitPolicy,
    /// How smooth a residual table is.
    system: SystemPolicy,
    /// The error that a law is held to.
    tolerance: TolerancePolicy,
    /// Tones in a residual.
    tones: TonesPolicy,
    /// The steps of a trace.
    trace: TracePolicy,
    /// What a residual table may follow.
    trend: TrendPolicy,
    /// Intervals of what was fitted.
    uncertainty: UncertaintyPolicy,
    /// What is concluded.
    verdict: VerdictPolicy,
    /// When a residual can be predicted.
    witness: WitnessPolicy,
}
