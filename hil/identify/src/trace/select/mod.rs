//! The search for missing effects: one at a time, each compared on cycles that it was not fitted to.

mod beside;
mod mass;
mod nodes;
mod refine;
mod rivals;
mod rough;
mod step;

pub use nodes::{amplitude_nodes, error_between};
pub use step::Candidate;

use std::sync::{Arc, OnceLock};

use mesh_damper_model::ModelError;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::{Stride, strides};

use super::fitted::Fitted;
use super::progress::Progress;
use super::ruled_out;
use super::score::ValidationSamples;
use super::sought::Sought;
use super::split::{Role, Roles};
use super::tones::OfMotion;
use super::unexplained;
use crate::families::Form;
use crate::known_terms::KnownTerm;
use crate::problem::Problem;
use crate::rows::{Purpose, Rows};
use crate::shape::Extent;
use crate::solution::Solution;
use crate::term::Term;
use crate::tolerance::goal;
use crate::trace::TracePolicy;
use crate::trace::verdict::VerdictPolicy;

mesh_damper_recording::numbers! {
    /// The search for effects.
    SelectPolicy {
        /// This many of the best laws enter the next step of a search: the best law with one effect need not be part of the best with two.
        beam: usize = 3, Tuned("the blind trial");
        /// At most this many candidates of a step are fitted, those with the largest predicted gain. The others keep the parameters of
        /// their best starting value.
        fitted: usize = 4, Tuned("the blind trial");
        /// A candidate is fitted only if its predicted gain exceeds this fraction of the largest.
        promising: f64 = 0.5, Tuned("the blind trial");
        /// A candidate is fitted from at most this many starting values.
        starts: usize = 2, Tuned("the blind trial");
    }
}

/// Laws are compared on at least about this many validation samples, if the recordings have as many. Convention: those of a minute or two
/// at 1 kHz.
const SCORED: usize = 20_000;

/// A search adds at most this many terms to the law. Convention: a search ends long before, when nothing is gained.
const MOST_TERMS: usize = 6;

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Eq 13 alone.
    pub baseline: Fitted,
    /// Eq 13 with the effects found.
    pub found: Fitted,
    /// All candidates, step by step, the best first.
    pub candidates: Vec<Candidate>,
    /// The tolerated error on the validation cycles.
    pub goal: f64,
    /// The least that a law which the samples were weighted for leaves of each recording, kN².
    pub left: Vec<f64>,
    /// Whether its coefficients over amplitude may as well be a [change with the temperature](Search::warms_along).
    pub warms_along: bool,
}

/// The search over one set of data.
#[derive(Clone)]
pub struct Search<'a> {
    trajectories: &'a [Trajectory],
    validation: ValidationSamples<'a>,
    /// Laws are scored along these.
    strides: Arc<Vec<Vec<Stride>>>,
    roles: &'a Roles,
    rows: Rows<'a>,
    extent: Extent,
    terms: Vec<Term>,
    known: Vec<KnownTerm>,
    /// Computed when a tone is searched for.
    of_motion: Arc<OnceLock<OfMotion>>,
}

impl<'a> Search<'a> {
    /// A search with separate coefficients of eq 13 at the amplitudes `nodes`, for effects that `sought` permits.
    pub fn new(
        trajectories: &'a [Trajectory],
        roles: &'a Roles,
        nodes: Vec<f64>,
        sought: &Sought,
    ) -> Self {
        let temperature = trajectories
            .iter()
            .find_map(|t| t.temperature.as_ref()?.first().copied());
        let terms = Form::all()
            .filter(|&form| sought.has(form.family()))
            .filter(|form| form.is_seen_in(trajectories))
            .map(|form| Term::sought(form, temperature.unwrap_or_default()))
            .collect();
        let law = sought.law;
        let has = |role: Role| move |which, sample| roles.of(which, sample) == role;
        let fitted = Arc::new(strides(
            trajectories,
            Purpose::Search.rows(),
            has(Role::Fit),
        ));
        let rows = Rows::along(
            &fitted,
            trajectories,
            law,
            nodes,
            Purpose::Search,
            has(Role::Fit),
        );
        let strides = Arc::new(strides(trajectories, SCORED, has(Role::Validation)));
        Self {
            trajectories,
            validation: ValidationSamples::of(trajectories, &strides, roles, Role::Validation),
            strides,
            roles,
            rows,
            extent: Extent::of(trajectories),
            terms,
            known: sought.known.clone(),
            of_motion: Arc::default(),
        }
    }

    /// The same search with coefficients of eq 13 at other amplitudes.
    #[must_use]
    pub fn with_nodes(&self, nodes: Vec<f64>) -> Self {
        Self {
            rows: self.rows.with_nodes(nodes),
            ..self.clone()
        }
    }

    /// The same search weighted for a law that leaves another variance of each recording, kN².
    #[must_use]
    pub fn beside_left(&self, left: Vec<f64>) -> Self {
        Self {
            rows: self.rows.beside(left.clone()),
            validation: self.validation.beside(left),
            ..self.clone()
        }
    }

    /// The same search weighted for `law`, if that leaves clearly less of some recording than the one that the samples are weighted for.
    /// Where it leaves more, the weights stay.
    fn sharper(&self, law: &Fitted) -> Result<Option<Self>, ModelError> {
        let predicted = law.solution.predicted(self.trajectories)?;
        let left = unexplained(self.trajectories, self.roles, predicted);
        let most = TracePolicy::in_use().same_weights;
        let is_less = |(left, before): (&f64, &f64)| *left < most * before;
        let before = self.rows.left();
        let least = left.iter().zip(before).map(|(a, b)| a.min(*b)).collect();
        let mut each = left.iter().zip(before);
        Ok(each.any(is_less).then(|| self.beside_left(least)))
    }

    /// A law of a search with other weights, fitted again with this one's; with its parameters as they are if the crate refuses that.
    ///
    /// # Errors
    /// The crate refuses the law as it is.
    pub fn reweighed(&self, law: &Fitted) -> Result<Fitted, ModelError> {
        let again = self.refit(&law.solution);
        again.or_else(|_| self.scored(law.solution.clone()))
    }

    /// Adds effects while one of them clearly reduces the error on the validation cycles, then drops those that became unnecessary.
    /// `progress` says what each step does.
    ///
    /// A search `from` the law of another, in which the motion, the force or the amplitudes differed a little, begins with that law but its
    /// last effect, which has to win again over all others.
    ///
    /// # Errors
    /// The crate refuses a fitted law.
    pub fn run(
        &self,
        from: Option<&Selection>,
        progress: Progress,
    ) -> Result<Selection, ModelError> {
        progress.at(0.0, "fitting the law");
        let mut search = self.clone();
        let mut baseline = self.scored(self.without_more())?;
        if let Some(sharper) = self.sharper(&baseline)? {
            baseline = sharper.reweighed(&baseline)?;
            search = sharper;
        }
        let mut found = baseline.clone();
        let mut candidates = Vec::new();
        if let Some(from) = from
            && let Some(start) = search.start(&from.found.solution, &baseline)
        {
            found = start;
            let steps = found.solution.found().count();
            let before = from.candidates.iter().filter(|one| one.step <= steps);
            candidates.extend(before.cloned());
            if let Some(sharper) = search.sharper(&found)? {
                found = sharper.reweighed(&found)?;
                search = sharper;
            }
        }
        let mut beam = vec![found.clone()];
        for step in found.solution.found().count() + 1..=MOST_TERMS {
            // Most searches end after two or three steps.
            let done = 1.0 - 0.6_f64.powi(step as i32 - 1);
            let what = format!(
                "trying {} forms of effects in addition to {}",
                search.terms.len(),
                found.named()
            );
            progress.at(done, &what);
            let may_add = !search.is_settled(&found);
            let mut tried = search.step(
                &beam,
                step,
                if may_add {
                    SelectPolicy::in_use().fitted
                } else {
                    0
                },
            );
            let is_mass = |one: &Candidate| one.admissible && one.fitted.is_with_mass(&found);
            let place = tried.iter().position(is_mass).filter(|_| !may_add);
            let mass =
                place.and_then(|place| Some((place, search.heavier(&tried[place], &found)?)));
            let is_found = mass.is_some();
            if let Some((place, heavier)) = mass {
                tried[place].fitted = heavier;
                tried[place].was_fitted = true;
                tried[..=place].rotate_right(1);
                let (mass, rivals) = tried.split_at_mut(1);
                for rival in rivals.iter_mut().filter(|rival| rival.admissible) {
                    let score = &rival.fitted.score;
                    rival.distinguishable = mass[0].fitted.score.gains_throughout(score);
                }
            }
            let adds = |best: &Candidate, search: &Search, found: &Fitted| {
                may_add && best.admissible && search.is_better(&best.fitted, found)
            };
            let first = tried.first();
            let added = first.filter(|best| adds(best, &search, &found));
            let sharper = added.map(|best| search.sharper(&best.fitted)).transpose()?;
            // What the best leaves decides between it and its rivals. If nothing is added then, the weights stay those of the law before.
            let mut is_added = added.is_some();
            if let Some(sharper) = sharper.flatten() {
                let before = sharper.reweighed(&found)?;
                let laws = beam.iter().map(|law| sharper.reweighed(law));
                let beam = laws.collect::<Result<Vec<_>, _>>()?;
                let again = sharper.step(&beam, step, SelectPolicy::in_use().fitted);
                let first = again.first();
                is_added = first.is_some_and(|best| adds(best, &sharper, &before));
                if is_added {
                    (search, tried) = (sharper, again);
                }
            }
            let Some(best) = tried.first_mut() else { break };
            let accepted = is_found || is_added;
            let next = best.fitted.clone();
            best.added = accepted;
            let others = &mut tried[usize::from(accepted)..];
            if !accepted || !may_add {
                ruled_out::by_the_law_before(others, may_add);
            }
            beam = tried
                .iter()
                .filter(|candidate| candidate.admissible)
                .map(|candidate| candidate.fitted.clone())
                .take(SelectPolicy::in_use().beam)
                .collect();
            candidates.extend(tried);
            if !accepted {
                break;
            }
            // A law near the noise is refined too: a missing term distorts its parameters.
            found = search.refined(&next);
            if let Some(first) = beam.first_mut() {
                *first = found.clone();
            }
        }
        if !search.is_settled(&found) {
            found = search.exchanged(found);
        }
        found = search.prune(search.unrefined(found));
        ruled_out::in_the_end(&mut candidates, &found);
        Ok(Selection {
            baseline: search.reweighed(&baseline)?,
            found,
            candidates,
            goal: search.goal(),
            left: search.rows.left().to_vec(),
            warms_along: false,
        })
    }

    /// The law that a search `from` another law begins with; none if it is no better than the law alone, or that is within the noise.
    fn start(&self, from: &Solution, alone: &Fitted) -> Option<Fitted> {
        if self.is_settled(alone) {
            return None;
        }
        let last = from.terms.iter().rposition(|value| !value.term.is_known)?;
        let start = self.refit(&from.without(last)).ok()?;
        let is_start = self.is_better(&start, alone) && self.rejected_by(&start).is_none();
        is_start.then_some(start)
    }

    /// The law with the known effects.
    fn without_more(&self) -> Solution {
        let mut terms = Vec::new();
        let mut law = Problem::new(&self.rows, &self.extent, &terms).solve();
        for known in &self.known {
            terms.push(known.term);
            let problem = Problem::new(&self.rows, &self.extent, &terms);
            law = problem.solve_from(&law, &known.shapes);
        }
        law
    }

    fn of_motion(&self) -> &OfMotion {
        self.of_motion
            .get_or_init(|| OfMotion::of(self.trajectories))
    }

    /// Whether the error is within the noise.
    pub fn is_settled(&self, law: &Fitted) -> bool {
        self.trajectories.iter().all(|one| one.noise_is_bounded)
            && law.score.nrmse() <= VerdictPolicy::in_use().noise_limited * self.goal()
    }

    /// The tolerated error on the validation cycles: the noise, or [`quiet`](crate::tolerance::TolerancePolicy::quiet) if the
    /// recording is quieter.
    pub fn goal(&self) -> f64 {
        goal(self.validation.noise())
    }

    /// The same terms fitted to this search's samples, with coefficients of its nodes.
    ///
    /// # Errors
    /// The crate refuses a fitted law.
    pub fn refit(&self, law: &Solution) -> Result<Fitted, ModelError> {
        let problem = Problem::new(&self.rows, &self.extent, &law.terms());
        self.scored(problem.solve_near(law))
    }

    fn scored(&self, solution: Solution) -> Result<Fitted, ModelError> {
        let predicted = solution.predicted_along(self.trajectories, &self.strides)?;
        let score = self.validation.score(&predicted);
        Ok(Fitted { solution, score })
    }
}

#[cfg(test)]
mod tests {
    use mesh_damper::effects::Inertia;
    use mesh_damper_model::Family;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, Normal};

    use super::super::set_unexplained;
    use super::*;

    /// Two recordings of a spring, of which the second has a mass too, with noise.
    fn recordings() -> [Trajectory; 2] {
        [0.0, 20.0].map(|mass| {
            let inertia = Inertia::new(mass).unwrap();
            let rate = |n: i32| std::f64::consts::TAU * if n < 2000 { 10.0 } else { 4.0 };
            let mut random = ChaCha8Rng::seed_from_u64(1);
            let mut noise = || Normal::new(0.0, 2e-3).unwrap().sample(&mut random);
            let moved = |n: i32| 0.2 * (rate(n) * 1e-3 * f64::from(n)).sin();
            let displacement: Vec<f64> = (0..4000).map(moved).collect();
            let force = (0..4000).map(|n| {
                let y = moved(n);
                2.0 * y + inertia.force_at(-rate(n).powi(2) * y) + noise()
            });
            Trajectory::new("sine", 1e-3, &displacement, force.collect(), None, None)
        })
    }

    fn roles(trajectories: &[Trajectory]) -> Roles {
        let mut roles = Roles::all_fit(trajectories);
        roles.keep_apart(trajectories, Role::Validation);
        roles
    }

    #[test]
    fn weights_follow_a_law_where_it_leaves_less() {
        let mut trajectories = recordings();
        let roles = roles(&trajectories);
        set_unexplained(&mut trajectories, &[1.0, 1e-12]);
        let search = Search::new(&trajectories, &roles, vec![0.0], &Sought::default());
        let law = search.scored(search.without_more()).unwrap();
        let sharper = search
            .sharper(&law)
            .unwrap()
            .expect("the first is explained");
        let [first, second] = sharper.rows.left() else {
            panic!()
        };
        assert!(*first < 1e-3, "{first}");
        assert_eq!(*second, 1e-12, "one law for both leaves more there");
        let again = sharper.reweighed(&law).unwrap();
        assert!(sharper.sharper(&again).unwrap().is_none());
    }

    /// Of the law alone, and of a law with a mass.
    #[test]
    fn a_selection_is_weighted_for_its_own_law() {
        for (which, recording) in recordings().iter().enumerate() {
            let selection = selected_from([recording.clone(), recording.clone()]);
            assert_eq!(selection.found.solution.terms.len(), which);
        }
    }

    fn selected_from(mut trajectories: [Trajectory; 2]) -> Selection {
        let roles = roles(&trajectories);
        set_unexplained(&mut trajectories, &[1.0; 2]);
        let search = Search::new(&trajectories, &roles, vec![0.0], &Sought::default());
        let selection = search.run(None, Progress::of(&|_| ())).unwrap();
        let left = &selection.left;
        let predicted = selection.found.solution.predicted(&trajectories).unwrap();
        let by_found = unexplained(&trajectories, &roles, predicted);
        for (left, by_found) in left.iter().zip(&by_found) {
            assert!(*left < 1e-2 && *by_found > 0.4 * left, "{left} {by_found}");
        }
        let same = search.beside_left(left.clone());
        let scored = same.scored(selection.found.solution.clone()).unwrap();
        assert_eq!(scored.score.nrmse(), selection.found.score.nrmse());
        assert_eq!(same.goal(), selection.goal);
        selection
    }

    /// The last effect has to win again, and what the motion no longer shows goes.
    #[test]
    fn a_search_goes_on_from_the_law_of_another() {
        let [light, massive] = recordings();
        let mut trajectories = [massive.clone(), massive];
        let roles = roles(&trajectories);
        set_unexplained(&mut trajectories, &[1.0; 2]);
        let search = Search::new(&trajectories, &roles, vec![0.0], &Sought::default());
        let first = search.run(None, Progress::of(&|_| ())).unwrap();
        let with = first.found.solution.clone();
        let offset = Term {
            form: Form::named("offset").unwrap(),
            ..with.terms[0].term
        };
        let terms = [with.terms[0].term, offset];
        let two = Problem::new(&search.rows, &search.extent, &terms).solve();
        let start = search.start(&two, &first.baseline).unwrap();
        assert_eq!(start.families(), first.found.families());
        let two = Selection {
            found: search.scored(two).unwrap(),
            ..first.clone()
        };
        let again = search.run(Some(&two), Progress::of(&|_| ())).unwrap();
        assert_eq!(again.found.families(), first.found.families(), "no offset");
        let steps = |step: usize| again.candidates.iter().filter(move |one| one.step == step);
        let first_step = first.candidates.iter().filter(|one| one.step == 1);
        assert_eq!(
            steps(1).count(),
            first_step.count(),
            "that of the law it starts from"
        );
        assert!(steps(2).count() > 0 && steps(2).all(|one| !one.added));
        assert!(
            search.start(&two.found.solution, &first.found).is_none(),
            "within the noise"
        );
        let mut trajectories = [light.clone(), light];
        set_unexplained(&mut trajectories, &[1.0; 2]);
        let search = Search::new(&trajectories, &roles, vec![0.0], &Sought::default());
        assert!(
            search
                .run(Some(&two), Progress::of(&|_| ()))
                .unwrap()
                .found
                .solution
                .is_alone()
        );
    }

    /// A branch that was added before the slider it stands for.
    #[test]
    fn an_effect_is_exchanged_for_another_that_is_better_in_its_place() {
        let mut stretch = 0.0_f64;
        let mut before = 0.0;
        let moved = |n: i32| 0.2 * (0.03 * f64::from(n)).sin() + 0.07 * (0.13 * f64::from(n)).sin();
        let displacement: Vec<f64> = (0..8000).map(moved).collect();
        let noise = |n: usize| 2e-3 * (n as f64 * 1.234_567).sin() * (n as f64 * 0.789).cos();
        let force = displacement.iter().enumerate().map(|(n, &y)| {
            stretch = (stretch + y - before).clamp(-0.02, 0.02);
            before = y;
            2.0 * y + 1.5 * stretch + 0.1 + noise(n)
        });
        let force = force.collect();
        let trajectories = [Trajectory::new(
            "slides",
            2e-3,
            &displacement,
            force,
            None,
            None,
        )];
        let roles = roles(&trajectories);
        let search = Search::new(&trajectories, &roles, vec![0.0], &Sought::default());
        let terms =
            ["relaxation", "offset"].map(|form| Term::sought(Form::named(form).unwrap(), 0.0));
        let law = Problem::new(&search.rows, &search.extent, &terms).solve();
        let law = search.scored(law).unwrap();
        let better = search.exchanged(law.clone());
        let names = |law: &Fitted| law.families().into_iter().map(Family::name).collect();
        let [before, after]: [Vec<&str>; 2] = [names(&law), names(&better)];
        assert_eq!(before, ["offset", "relaxation"]);
        assert_eq!(after, ["offset", "stick_slip"]);
        assert!(better.score.beats(&law.score));
        let same = search.exchanged(better.clone());
        assert_eq!(same.score.nrmse(), better.score.nrmse());
    }
}
