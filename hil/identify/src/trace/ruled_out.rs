//! Assigns the rejecting rule to each candidate of a search.

use super::fitted::Fitted;
use super::rule::Rule;
use super::select::Candidate;

/// For the candidates of one step, the best first: those that the validation cycles distinguish from the best, or that the best
/// contains.
pub(super) fn by_the_best(tried: &mut [Candidate]) {
    let Some((best, rest)) = tried.split_first_mut() else {
        return;
    };
    for rival in rest.iter_mut().filter(|rival| rival.rejected_by.is_none()) {
        let same_families = || rival.fitted.families() == best.fitted.families();
        rival.rejected_by = match (rival.distinguishable, rival.was_fitted) {
            (true, true) => Some(Rule::Worse),
            (true, false) => Some(Rule::LittlePromise),
            (false, _) if same_families() => Some(Rule::SameFamilies),
            (false, _) if rival.degenerate => Some(Rule::AtLimit),
            (false, _) => None,
        };
    }
}

/// For a step that added nothing: the best and its equals, or all if nothing `may_add` to a law.
pub(super) fn by_the_law_before(tried: &mut [Candidate], may_add: bool) {
    for candidate in tried.iter_mut().filter(|candidate| candidate.admissible) {
        if !may_add {
            candidate.rejected_by = Some(Rule::NoiseLimited);
        } else if candidate.rejected_by.is_none() {
            candidate.rejected_by = Some(Rule::LittleGain);
        }
    }
}

/// For those that were added and are not in the final law `found`.
pub(super) fn in_the_end(candidates: &mut [Candidate], found: &Fitted) {
    let kept = found.families();
    for candidate in candidates {
        if candidate.added && !kept.contains(&candidate.family) {
            candidate.rejected_by = Some(Rule::Needless);
        }
    }
}
