//! Confirms effects of a law whose error is above the noise: each is tested against conditions that it was not fitted to.

use std::collections::BTreeMap;

use mesh_damper_model::predict::NINETY_PERCENT;
use mesh_damper_model::{Family, ModelError};

use super::adopt::{gains, gains_clearly};
use super::closing::Closing;
use super::left_out::LeftOut;
use super::relative_error::RelativeError;
use super::result::{FoundEffect, HeldCondition};
use super::rule::Rule;
use super::select::Search;
use super::separating::Rivals;
use super::unlisted::Laws;
use crate::rows::Rows;
use crate::solution::Solution;
use crate::trace::verdict::VerdictPolicy;
use crate::uncertainty::{Interval, Uncertainty};

mesh_damper_recording::numbers! {
    /// When an effect is confirmed although something else is still missing.
    ConfirmPolicy {
        /// An effect is confirmed only if at least this many conditions show it.
        fewest: usize = 3, Convention("two may agree by chance");
        /// An effect is confirmed only if its parameters from any two of the fits differ by less than this many joint standard deviations.
        steady: f64 = 2.0, Convention("95 of 100 differences of one true value stay within that");
    }
}

/// A law, and the results for its effects from conditions held out in turn.
#[derive(Clone)]
pub(super) struct Confirmed {
    /// The law.
    pub law: Solution,
    /// For each family.
    pub families: Vec<Confirmation>,
}

impl Confirmed {
    /// Whether any effect is confirmed.
    pub fn any(&self) -> bool {
        self.families.iter().any(|one| one.rejected_by.is_none())
    }

    /// Whether the effects of a family are.
    pub fn confirms(&self, family: Family) -> bool {
        let mut families = self.families.iter();
        families.any(|one| one.family == family && one.rejected_by.is_none())
    }

    /// If none is confirmed: the effect that gains most among those rejected only because of rivals, and the laws that do equally
    /// well with another effect in its place.
    pub fn rivals(&self) -> Option<Rivals> {
        let is_rivalled = |one: &&Confirmation| one.rejected_by == Some(Rule::Rivalled);
        let rivalled = self.families.iter().filter(is_rivalled);
        let by_gain = |a: &&Confirmation, b: &&Confirmation| a.gain().total_cmp(&b.gain());
        let most = rivalled.max_by(by_gain).filter(|_| !self.any())?;
        let others = most.rivals.iter().cloned();
        Some(Rivals::in_place_of(most.family, &self.law, others))
    }

    /// Adds to `effects` the reason why they are not confirmed; those of `rivals` are rivals of each other.
    pub fn say_of(&self, effects: &mut [FoundEffect], rivals: Option<&Rivals>) {
        let names = |laws: &[(Family, Solution)]| -> Vec<String> {
            let families = laws.iter().map(|(family, _)| family.name().to_owned());
            families.collect()
        };
        let in_place = rivals.map_or_else(Vec::new, |rivals| names(&rivals.laws));
        for effect in effects {
            let mut families = self.families.iter();
            let of_effect = families.find(|one| one.family.name() == effect.family);
            if let Some(one) = of_effect {
                effect.unconfirmed_by = one.rejected_by;
                effect.rivals = names(&one.rivals);
            } else if in_place.contains(&effect.family) {
                effect.unconfirmed_by = Some(Rule::Rivalled);
                effect.rivals = in_place.clone();
                effect.rivals.retain(|name| *name != effect.family);
            }
        }
    }

    /// The error of each condition, for `trace.json`.
    pub fn conditions(&self, left_out: &LeftOut) -> Vec<HeldCondition> {
        let each = left_out.conditions().iter().enumerate();
        let each = each.filter_map(|(number, condition)| {
            // A law that the crate refuses without this condition has no error there.
            let nrmse = |left: RelativeError| Some(left.error.sqrt()).filter(|it| it.is_finite());
            let left = |one: &Confirmation| Some(one.left.get(number)?.as_ref()?.map(nrmse));
            let each = self.families.iter();
            let nrmse_without: BTreeMap<String, f64> = each
                .filter_map(|one| Some((one.family.name().to_owned(), left(one)?[0]?)))
                .collect();
            let nrmse_with = self.families.first().and_then(left)?[1]?;
            let (part, repeats) = condition.parts.split_first()?;
            let trajectory = left_out.trajectory(part);
            let seconds = |sample: usize| sample as f64 * trajectory.tick;
            let mut blocks = trajectory.blocks.iter();
            let block = blocks.find(|block| block.samples == part.samples);
            Some(HeldCondition {
                recording: trajectory.name.clone(),
                span: [part.samples.start, part.samples.end].map(seconds),
                repeats: repeats.len(),
                amplitude: block.map(|block| block.amplitude),
                frequency: block.map(|block| block.frequency),
                nrmse_with,
                nrmse_without,
            })
        });
        each.collect()
    }
}

/// The result for the effects of one family from conditions held out in turn.
#[derive(Clone, Debug)]
pub(super) struct Confirmation {
    /// The family.
    pub family: Family,
    /// The reason why it is not confirmed; none if it is.
    pub rejected_by: Option<Rule>,
    /// The families that do equally well in its place, with the law that has them there.
    pub rivals: Vec<(Family, Solution)>,
    /// The error of the law on each condition without the family and with it, in the order of [`LeftOut::conditions`].
    pub left: Vec<Option<[RelativeError; 2]>>,
}

impl Confirmation {
    /// By how much the family reduces the error, as the mean logarithm: without bound if only with it the law can be run, and the same
    /// negative if it cannot with it.
    fn gain(&self) -> f64 {
        let left = || self.left.iter().flatten();
        if !left().all(|[_, with]| with.is_run()) {
            return f64::NEG_INFINITY;
        }
        let logs =
            left().map(|[without, with]| (without.beyond_noise() / with.beyond_noise()).ln());
        logs.sum::<f64>() / self.left.len() as f64
    }

    /// Whether the family reduces the total error over all conditions.
    fn gains(&self) -> bool {
        let each = self.left.iter().flatten();
        let (without, with): (Vec<_>, Vec<_>) =
            each.map(|&[without, with]| (without, with)).unzip();
        gains(&without, &with)
    }
}

/// The error of a law on each condition held out, with the parameters of that fit.
type Held = Vec<Option<(RelativeError, Vec<(Family, Interval)>)>>;

impl Closing<'_> {
    /// Decides which effects of `laws` are confirmed if the law is incomplete. If only some are confirmed, the trace ends in the
    /// law with those.
    pub(super) fn grade(&self, left_out: &LeftOut, laws: &mut Laws) -> Result<(), ModelError> {
        if laws.graded.is_some() || laws.solution.is_alone() || !left_out.differ() {
            return Ok(());
        }
        // A table was fitted together with all of them.
        let may_drop = laws.model.correction.is_none() && !laws.is_insisted;
        let confirmed = self.confirmed(left_out, laws.rows, &laws.solution, may_drop)?;
        if confirmed.law.terms.len() < laws.solution.terms.len() {
            laws.solution = self.fit_there(laws.rows, &confirmed.law);
            laws.model = laws.solution.model();
        }
        laws.graded = Some(confirmed);
        Ok(())
    }

    /// The same for effects that explain the fitted samples but predict the held-out samples less well. Each held-out recording is
    /// then a condition too, also for the rivals. The law stays as it is.
    pub(super) fn grade_elsewhere(
        &self,
        left_out: &LeftOut,
        laws: &mut Laws,
    ) -> Result<(), ModelError> {
        let mut graded = self.confirmed(left_out, laws.rows, &laws.solution, false)?;
        let with = self.left_of_held_out(&laws.model)?;
        for one in &mut graded.families {
            if !matches!(one.rejected_by, None | Some(Rule::Rivalled)) {
                continue;
            }
            let left_by =
                |law: &Solution| self.left_of_held_out(&self.fit_near(laws.rows, law).model());
            let without = left_by(&laws.solution.without_family(one.family))?;
            let rivals = std::mem::take(&mut one.rivals).into_iter();
            let rivals = rivals.map(|rival| Ok((left_by(&rival.1)?, rival)));
            let rivals = rivals.collect::<Result<_, ModelError>>()?;
            (one.rejected_by, one.rivals) = graded_elsewhere(&without, &with, rivals);
        }
        laws.graded = Some(graded);
        Ok(())
    }

    /// Decides which effects of `law` are confirmed. If some `may_drop`, it leaves out the effect with the smallest gain if that is
    /// not positive, or if nothing is confirmed: an effect that covers for another may hide it. This continues as long as the law
    /// is no worse without the effect on conditions held out in turn.
    fn confirmed(
        &self,
        left_out: &LeftOut,
        rows: &Rows,
        law: &Solution,
        may_drop: bool,
    ) -> Result<Confirmed, ModelError> {
        let nodes = rows.nodes().to_vec();
        let search = Search::new(self.trajectories, self.validation, nodes, self.sought);
        let held = self.held(left_out, rows, law);
        let of_all = errors(&held);
        let mut now = self.confirmations(left_out, rows, law, (&held, &search))?;
        // The law without effects that gain nothing.
        let mut kept = now.clone();
        while may_drop && now.families.len() > 1 {
            let by_gain = |a: &&Confirmation, b: &&Confirmation| a.gain().total_cmp(&b.gain());
            let Some(least) = now.families.iter().min_by(by_gain) else {
                break;
            };
            let is_needless = !least.gains();
            if !is_needless && now.any() {
                break;
            }
            let rest = self.fit_near(rows, &now.law.without_family(least.family));
            let held = self.held(left_out, rows, &rest);
            if gains_clearly(&errors(&held), &of_all) {
                break;
            }
            let was_kept = kept.families.len() == now.families.len();
            now = self.confirmations(left_out, rows, &rest, (&held, &search))?;
            if now.any() || is_needless && was_kept {
                kept = now.clone();
            }
        }
        Ok(kept)
    }

    fn held(&self, left_out: &LeftOut, rows: &Rows, law: &Solution) -> Held {
        left_out.each_in_turn(&|picked| {
            let (rows, solution) = self.refit(rows, law, picked);
            let uncertainty = Uncertainty::of(&rows, self.extent(), &solution);
            (Ok(solution.model()), parameters(&solution, &uncertainty))
        })
    }

    fn confirmations(
        &self,
        left_out: &LeftOut,
        rows: &Rows,
        law: &Solution,
        (held, search): (&Held, &Search),
    ) -> Result<Confirmed, ModelError> {
        let in_turn = |law: &Solution| {
            left_out.each_in_turn(&|picked| (Ok(self.refit_model(rows, law, picked)), ()))
        };
        let of_law = errors(held);
        let each = law.families().into_iter().map(|family| {
            let rest = law.without_family(family);
            let pairs = in_turn(&rest).into_iter().zip(held);
            let left: Vec<Option<[RelativeError; 2]>> = pairs
                .map(|(without, with)| Some([without?.0, with.as_ref()?.0]))
                .collect();
            let fits = held.iter().flatten();
            let fits: Vec<Vec<Interval>> = fits.map(|(_, all)| of_family(all, family)).collect();
            let mut rivals = Vec::new();
            let rejected_by = if !helps_everywhere(&left) {
                Some(Rule::HelpsNotEverywhere)
            } else if largest_difference(&fits) >= ConfirmPolicy::in_use().steady {
                Some(Rule::Unsteady)
            } else {
                for rival in search.rivals(law, &rest) {
                    let of_rival = errors(&in_turn(&rival));
                    // A rival that contains the effect does equally well for that reason alone, so it has to be clearly better.
                    let does_as_well = match is_more_than(&rival, family) {
                        true => gains_clearly(&of_law, &of_rival),
                        false => !gains_clearly(&of_rival, &of_law),
                    };
                    let last = rival.terms.last().map(|last| last.term.form.family());
                    if let Some(family) = last.filter(|_| does_as_well) {
                        rivals.push((family, rival));
                    }
                }
                (!rivals.is_empty()).then_some(Rule::Rivalled)
            };
            Ok(Confirmation {
                family,
                rejected_by,
                rivals,
                left,
            })
        });
        Ok(Confirmed {
            law: law.clone(),
            families: each.collect::<Result<_, ModelError>>()?,
        })
    }
}

/// Whether the last effect of a law contains one of `family`.
fn is_more_than(law: &Solution, family: Family) -> bool {
    let last = law.terms.last().map(|value| value.term.form);
    last.is_some_and(|form| form.special_cases.contains(&family.name()))
}

fn errors<T>(held: &[Option<(RelativeError, T)>]) -> Vec<RelativeError> {
    held.iter().flatten().map(|(left, _)| *left).collect()
}

fn parameters(solution: &Solution, uncertainty: &Uncertainty) -> Vec<(Family, Interval)> {
    let terms = solution.terms.iter().zip(&uncertainty.terms);
    let each = terms.flat_map(|(value, uncertainty)| {
        let family = value.term.form.family();
        let elements = uncertainty.elements(value).into_iter().flatten();
        elements.map(move |(_, interval)| (family, interval))
    });
    each.collect()
}

fn of_family(all: &[(Family, Interval)], family: Family) -> Vec<Interval> {
    let own = all.iter().filter(|(of, _)| *of == family);
    own.map(|(_, interval)| *interval).collect()
}

/// The result for an effect that conditions confirm, or that fails only because of rivals. It and each rival has to reduce the
/// error elsewhere: the error is `without` the effect, `with` it, or with the rival's value.
fn graded_elsewhere<R>(
    without: &[RelativeError],
    with: &[RelativeError],
    rivals: Vec<(Vec<RelativeError>, R)>,
) -> (Option<Rule>, Vec<R>) {
    if !gains(without, with) {
        return (Some(Rule::GainsNothingElsewhere), Vec::new());
    }
    let does_as_well = |left: &[RelativeError]| gains(without, left) && !gains_clearly(left, with);
    let rivals = rivals.into_iter().filter(|(left, _)| does_as_well(left));
    let rivals: Vec<R> = rivals.map(|(_, rival)| rival).collect();
    ((!rivals.is_empty()).then_some(Rule::Rivalled), rivals)
}

/// Whether the error decreases on every condition on which there is something to gain.
fn helps_everywhere(left: &[Option<[RelativeError; 2]>]) -> bool {
    let noise_limited = VerdictPolicy::in_use().noise_limited.powi(2);
    let shown: Vec<[RelativeError; 2]> = left
        .iter()
        .flatten()
        .copied()
        .filter(|[without, _]| without.error > noise_limited * without.noise)
        .collect();
    shown.len() >= ConfirmPolicy::in_use().fewest
        && shown
            .iter()
            .all(|[without, with]| gains(&[*without], &[*with]))
}

/// The largest difference of any parameter between any two fits, in joint deviations; infinite if a parameter has no bound.
fn largest_difference(fits: &[Vec<Interval>]) -> f64 {
    let deviation = |one: &Interval| (one.high - one.low) / (2.0 * NINETY_PERCENT);
    let mut largest = 0.0_f64;
    for (number, a) in fits.iter().enumerate() {
        for b in &fits[..number] {
            // An element that one of them lacks has no value there.
            if a.len() != b.len() {
                return f64::INFINITY;
            }
            for (a, b) in a.iter().zip(b) {
                // A parameter that its form holds constant does not differ.
                let joint = deviation(a).hypot(deviation(b)).max(f64::MIN_POSITIVE);
                let differs = (a.value - b.value).abs() / joint;
                largest = match joint.is_finite() && differs.is_finite() {
                    true => largest.max(differs),
                    false => f64::INFINITY,
                };
            }
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(without: f64, with: f64) -> Option<[RelativeError; 2]> {
        let each = [without, with].map(|error| RelativeError {
            error: error * error,
            noise: 1e-4,
            most: 0.0,
        });
        Some(each)
    }

    #[test]
    fn an_effect_helps_on_each_of_some_conditions_that_show_it() {
        let helps = [left(0.1, 0.05), left(0.2, 0.19), left(0.1, 0.09)];
        assert!(helps_everywhere(&helps));
        assert!(!helps_everywhere(&helps[..2]), "too few");
        let one_not = [&helps[..], &[left(0.1, 0.101)]].concat();
        assert!(!helps_everywhere(&one_not));
        let one_at_the_noise = [&helps[..], &[left(0.012, 0.013)]].concat();
        assert!(helps_everywhere(&one_at_the_noise));
        assert!(
            !helps_everywhere(&[left(0.012, 0.005); 4]),
            "nothing shows it"
        );
    }

    #[test]
    fn a_law_that_cannot_be_run_gains_nothing_and_one_that_alone_can_gains_all() {
        let of = |left: &[Option<[RelativeError; 2]>]| Confirmation {
            family: Family::all().next().unwrap(),
            rejected_by: None,
            rivals: Vec::new(),
            left: left.to_vec(),
        };
        let fine = left(0.1, 0.05);
        let [refused, saved] =
            [[0.1, f64::INFINITY], [f64::INFINITY, 0.1]].map(|[a, b]| left(a, b));
        let gain = of(&[fine; 3]).gain();
        assert!((gain - 2.0_f64.ln()).abs() < 0.02, "{gain}");
        assert_eq!(of(&[fine, refused, saved]).gain(), f64::NEG_INFINITY);
        assert_eq!(of(&[fine, saved]).gain(), f64::INFINITY);
        assert!(!of(&[fine, refused]).gains() && of(&[saved]).gains());
    }

    #[test]
    fn elsewhere_an_effect_helps_and_each_of_its_rivals() {
        let errors = |each: &[f64]| -> Vec<RelativeError> {
            each.iter()
                .map(|&error| left(0.0, error).unwrap()[1])
                .collect()
        };
        let without = errors(&[0.1, 0.2]);
        let with = errors(&[0.05, 0.1]);
        let as_well = (errors(&[0.051, 0.1]), "as well");
        let worse = (errors(&[0.08, 0.16]), "worse");
        let no_help = (errors(&[0.1, 0.21]), "no help");
        let say = |with: &[RelativeError], rivals| graded_elsewhere(&without, with, rivals);
        assert_eq!(say(&with, Vec::new()), (None, vec![]));
        let all = vec![as_well, worse.clone(), no_help.clone()];
        let rivalled = (Some(Rule::Rivalled), vec!["as well"]);
        assert_eq!(say(&with, all.clone()), rivalled);
        // It is confirmed if no rival helps as much.
        assert_eq!(say(&with, vec![worse, no_help]), (None, vec![]));
        let fails = (Some(Rule::GainsNothingElsewhere), vec![]);
        assert_eq!(say(&errors(&[0.099, 0.199]), all), fails);
    }

    #[test]
    fn parameters_differ_in_their_joint_deviations() {
        let interval = |value: f64, half: f64| Interval {
            value,
            low: value - NINETY_PERCENT * half,
            high: value + NINETY_PERCENT * half,
        };
        let fits = [(1.0, 0.3), (1.5, 0.4), (1.2, 0.3)].map(|(v, h)| vec![interval(v, h)]);
        assert!((largest_difference(&fits) - 1.0).abs() < 1e-12);
        let held = [vec![interval(0.0, 0.0)], vec![interval(0.0, 0.0)]];
        assert_eq!(largest_difference(&held), 0.0);
        let unbounded = [vec![interval(1.0, 0.1)], vec![interval(1.0, f64::INFINITY)]];
        assert_eq!(largest_difference(&unbounded), f64::INFINITY);
        let lacks_one = [vec![interval(1.0, 0.1); 2], vec![interval(1.0, 0.1)]];
        assert_eq!(largest_difference(&lacks_one), f64::INFINITY);
    }
}
