//! The numbers that decide what a fit and a trace find. How they are stated, [`mod@mesh_damper_recording::policy`] says.

pub use crate::beyond_noise::BeyondNoisePolicy;
pub use crate::correction::CorrectionPolicy;
pub use crate::correction::design::DesignPolicy;
pub use crate::correction::edges::EdgesPolicy;
pub use crate::correction::gram::GramPolicy;
pub use crate::correction::growth::GrowthPolicy;
pub use crate::correction::memory::{MemoryKind, MemoryPolicy};
pub use crate::correction::search::SearchPolicy;
pub use crate::correction::settle::SettlePolicy;
pub use crate::correction::system::SystemPolicy;
pub use crate::correction::trend::TrendPolicy;
pub use crate::exact::ExactPolicy;
pub use crate::problem::ProblemPolicy;
pub use crate::rows::RowsPolicy;
pub use crate::shape::ShapePolicy;
pub use crate::tolerance::TolerancePolicy;
pub use crate::trace::TracePolicy;
pub use crate::trace::adopt::AdoptPolicy;
pub use crate::trace::aligned::AlignedPolicy;
pub use crate::trace::confirm::ConfirmPolicy;
pub use crate::trace::held_range::HeldRangePolicy;
pub use crate::trace::left_out::LeftOutPolicy;
pub use crate::trace::remainder::RemainderPolicy;
pub use crate::trace::score::ScorePolicy;
pub use crate::trace::select::SelectPolicy;
pub use crate::trace::separating::SeparatingPolicy;
pub use crate::trace::split::SplitPolicy;
pub use crate::trace::tones::TonesPolicy;
pub use crate::trace::unexplained::UnexplainedPolicy;
pub use crate::trace::verdict::VerdictPolicy;
pub use crate::trace::wander::WanderPolicy;
pub use crate::uncertainty::UncertaintyPolicy;

mesh_damper_recording::policy! {
    /// What recordings of one rig share.
    aligned: AlignedPolicy,
    /// What a law leaves beyond the noise.
    beyond_noise: BeyondNoisePolicy,
    /// When a residual table is taken.
    correction: CorrectionPolicy,
    /// The samples that a residual table is fitted to.
    design: DesignPolicy,
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
    /// Blocks that are left out of a fit.
    left_out: LeftOutPolicy,
    /// What a residual table may remember.
    memory: MemoryPolicy,
    /// When a residual table takes the place of effects.
    unexplained: UnexplainedPolicy,
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
    /// How many samples a fit is made to.
    rows: RowsPolicy,
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
}
