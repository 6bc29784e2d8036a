//! The end of a trace: fits the result to all open samples, and computes its error on the held-out ones.

use std::cell::LazyCell;
use std::sync::Arc;

use mesh_damper_model::file::Elsewhere;
use mesh_damper_model::predict::{predict, predict_embedded};
use mesh_damper_model::{Family, Model, ModelError};
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::{Stride, strides};

use super::confirm::Confirmed;
use super::estimates::law_estimates;
use super::left_out::{LeftOut, Picked};
use super::operating;
use super::progress::Progress;
use super::relative_error::RelativeError;
use super::result::{
    Baseline, CorrectionSummary, Errors, FoundEffect, OnTarget, TraceResult, Verdict,
};
use super::rule::Rule;
use super::search_verdict::Concluded;
use super::select::{Search, Selection};
use super::separating::{Rivals, bounding_test, separating_test};
use super::sought::Sought;
use super::split::{Role, Roles};
use super::unlisted::Laws;
use super::verdict::{depends_on, warnings, zero_in_doubt};
use crate::base_law::BaseLaw;
use crate::basis::Basis;
use crate::families::asymmetry;
use crate::problem::Problem;
use crate::rows::{Purpose, Rows};
use crate::shape::Extent;
use crate::solution::Solution;
use crate::staged::staged;
use crate::term::TermValue;
use crate::tolerance::noise_floor;
use crate::trace::TracePolicy;
use crate::trace::verdict::VerdictPolicy;
use crate::uncertainty::Uncertainty;

/// A trace without the trajectories that it was made of; the caller has those.
pub(super) struct Closed {
    /// The contents of `trace.json`.
    pub result: TraceResult,
    /// Eq 13 alone.
    pub baseline: Model,
    /// Eq 13 with the effects found.
    pub model: Model,
    /// For the fitted recordings, then for the held-out ones.
    pub forces: Vec<Forces>,
    /// The search.
    pub selection: Selection,
}

/// The role of each sample of a recording, and the force there of the mixed damping law alone and of the result, kN.
pub(super) struct Forces {
    pub roles: Vec<Role>,
    pub before: Vec<f64>,
    pub after: Vec<f64>,
}

/// The recordings of a trace, with the role of each sample.
pub(super) struct Closing<'a> {
    /// The fitted recordings, then the held-out ones.
    pub(super) recordings: Vec<(&'a Trajectory, Vec<Role>)>,
    /// The fitted recordings.
    pub(super) trajectories: &'a [Trajectory],
    fitted: usize,
    pub(super) validation: &'a Roles,
    roles: &'a Roles,
    /// With the preferred nodes, then with others.
    pub(super) rows: Vec<Rows<'a>>,
    /// The samples that the fits of folds use.
    strides: Arc<Vec<Vec<Stride>>>,
    extent: Extent,
    noise_floor: f64,
    pub(super) sought: &'a Sought,
}

impl<'a> Closing<'a> {
    /// Effects were chosen by the roles `validation`; no fit uses the samples that `roles` hold out. `nodes` are amplitudes at which
    /// eq 13 has separate coefficients, mm: the preferred ones, then alternatives.
    pub fn new(
        fitted: &'a [Trajectory],
        [validation, roles]: [&'a Roles; 2],
        held: &'a [Trajectory],
        nodes: Vec<Vec<f64>>,
        sought: &'a Sought,
    ) -> Self {
        let of_fitted = fitted.iter().enumerate().map(|(which, trajectory)| {
            let roles = (0..trajectory.len())
                .map(|sample| roles.of(which, sample))
                .collect();
            (trajectory, roles)
        });
        let of_held = held
            .iter()
            .map(|trajectory| (trajectory, held_roles(trajectory, fitted)));
        Self {
            recordings: of_fitted.chain(of_held).collect(),
            trajectories: fitted,
            fitted: fitted.len(),
            validation,
            roles,
            noise_floor: noise_floor(fitted),
            rows: nodes
                .into_iter()
                .map(|nodes| {
                    Rows::gather(
                        fitted,
                        sought.law,
                        nodes,
                        Purpose::Result.rows(),
                        |which, sample| roles.is_open(which, sample),
                    )
                })
                .collect(),
            strides: Arc::new(strides(fitted, Purpose::InTurn.rows(), |which, sample| {
                roles.is_open(which, sample)
            })),
            extent: Extent::of(fitted),
            sought,
        }
    }

    /// Fits the mixed damping law alone and with the effects of `selection`, and reports.
    pub fn close(&self, selected: Selection, progress: Progress) -> Result<Closed, ModelError> {
        let selection = &selected;
        let rows = &self.rows[0];
        let alone = self.fit_near(rows, &selection.baseline.solution);
        let solution = self.fit_there(rows, &selection.found.solution);
        let left_out = LeftOut::of(self.trajectories, self.roles);
        let found = solution.clone();
        let Concluded {
            mut verdict,
            left,
            effects_rejected_by,
            explainable,
            in_turn,
        } = self.verdict(selection, &left_out, [&alone, &solution])?;
        let is_more_missing = verdict == Verdict::Unlisted;
        let mut laws = if is_more_missing {
            let found = match solution.is_alone() {
                true => solution,
                false => self.preferred(selection, &left_out, solution)?,
            };
            self.unlisted(&left_out, alone, found, progress.within([0.1, 0.9]))?
        } else {
            Laws {
                rows,
                alone,
                model: solution.model(),
                solution,
                residual_depends_on: Vec::new(),
                table_rejected_by: None,
                rejected: None,
                is_insisted: false,
                graded: None,
                in_turn,
            }
        };
        if is_more_missing {
            self.grade(&left_out, &mut laws)?;
        }
        let mut uncertainty = Uncertainty::of(laws.rows, &self.extent, &laws.solution);
        let (before, without) = self.evaluate(&laws.alone.model(), predict)?;
        let (after, with) = self.evaluate(&laws.model, predict)?;
        let (_, on_target) = self.evaluate(&laws.model, predict_embedded)?;
        let over_noise = self.over_noise(&after);
        let terms = laws.solution.terms.iter().zip(&uncertainty.terms);
        let mut unbounded: Vec<Family> = terms
            .filter(|(value, uncertainty)| !value.term.is_known && !uncertainty.is_bounded())
            .map(|(value, _)| value.term.form.family())
            .collect();
        // If a named effect predicts the held-out samples less well, it is accepted only if conditions confirm it. This affects
        // only the verdict.
        let fails_on_held_out = verdict == Verdict::Found
            && unbounded.is_empty()
            && left_out.differ()
            && over_noise.fails_on_held_out();
        if fails_on_held_out {
            self.grade_elsewhere(&left_out, &mut laws)?;
            verdict = Verdict::Unlisted;
        }
        let rivals = match verdict {
            Verdict::Ambiguous => Some(Rivals::of(selection)),
            Verdict::Found if !unbounded.is_empty() => {
                let nodes = laws.rows.nodes().to_vec();
                let search = Search::new(self.trajectories, self.validation, nodes, self.sought);
                search.in_place_of_unbounded(&selection.found, &unbounded)
            }
            _ => laws.graded.as_ref().and_then(Confirmed::rivals),
        };
        if rivals.is_some() {
            verdict = Verdict::Ambiguous;
        } else if laws.graded.as_ref().is_some_and(Confirmed::any) {
            verdict = Verdict::Found;
        }
        let Laws {
            rows,
            alone,
            solution,
            model,
            residual_depends_on,
            table_rejected_by,
            rejected,
            is_insisted,
            graded,
            in_turn,
        } = laws;
        let baseline = alone.model();
        let named = solution.model();
        let left_by = |model: &Model| -> Result<f64, ModelError> {
            Ok(match is_more_missing {
                true => left_out.left_by(model)?.in_most().unwrap_or(left),
                false => left,
            })
        };
        let left_by_named = left_by(&named)?;
        let left = left_by(&model)?;
        let is_named = |family: Family| match (&graded, &rivals) {
            (Some(graded), _) if graded.any() => graded.confirms(family),
            (Some(_), Some(rivals)) => rivals.laws.iter().any(|(rival, _)| *rival == family),
            _ => true,
        };
        unbounded.retain(|&family| is_named(family));
        unbounded.dedup();
        let moved = self.fit_moved(rows, &solution);
        uncertainty.widen(&solution, &moved);
        let noise_floor = self.noise_floor;
        let mut effects = self.effects(rows, &solution, &uncertainty, with.nrmse_held_out)?;
        if let Some(rivals) = &rivals {
            effects.extend(self.of_rivals(rows, rivals)?);
        }
        if let Some(graded) = &graded {
            graded.say_of(&mut effects, rivals.as_ref());
        }
        let zero_is_known = self.sought.rig.zero.is_some();
        let mut in_doubt = zero_in_doubt(&model, self.trajectories).filter(|_| !zero_is_known);
        let uneven = asymmetry::FORMS[0].family();
        let is_in_doubt =
            |effect: &FoundEffect| in_doubt.is_some() && effect.family == uneven.name();
        for effect in effects.iter_mut().filter(|one| is_in_doubt(one)) {
            effect.unconfirmed_by.get_or_insert(Rule::Rivalled);
            effect.rivals.push("zero".to_owned());
        }
        let (mut effects, mut unconfirmed): (Vec<_>, Vec<_>) = effects
            .into_iter()
            .partition(|effect| Family::named(&effect.family).is_none_or(is_named));
        if in_doubt.is_some() && rivals.is_none() && !effects.iter().all(is_in_doubt) {
            unconfirmed.extend(effects.extract_if(.., |one| is_in_doubt(one)));
            unbounded.retain(|family| *family != uneven);
        }
        let is_all_in_doubt = !effects.is_empty() && effects.iter().all(is_in_doubt);
        // For a law that predicts the held-out samples less well, its error on those.
        let left_there = over_noise.held_out.filter(|_| fails_on_held_out);
        let remainder = if is_more_missing && left_by_named > VerdictPolicy::in_use().noise_limited
        {
            let nrmse = self.evaluate(&named, predict)?.1.nrmse_fitted;
            Some(self.remainder(&named, false, [nrmse, left_by_named])?)
        } else if let Some(left) = left_there {
            Some(self.remainder(&named, true, [with.nrmse_held_out, left])?)
        } else {
            None
        };

        let (separating_test, separating_blocks) = match (verdict, &rivals) {
            (_, Some(rivals)) => {
                progress.at(0.9, "looking for a test that tells the candidates apart");
                let (text, blocks) = separating_test(rivals, self.trajectories, self.sought.law)?;
                (Some(text), blocks)
            }
            (Verdict::Found, None) if !unbounded.is_empty() => {
                verdict = Verdict::Ambiguous;
                (
                    Some(bounding_test(&unbounded, self.trajectories)),
                    Vec::new(),
                )
            }
            (Verdict::Found, None) if is_all_in_doubt => {
                verdict = Verdict::Ambiguous;
                (in_doubt.take(), Vec::new())
            }
            _ => (None, Vec::new()),
        };
        let mut warnings = warnings(
            self.recordings.iter().map(|(trajectory, _)| *trajectory),
            &model,
            left,
            (&without, &with),
            &on_target,
            &over_noise,
            noise_floor,
        );
        if is_insisted {
            warnings.push(
                "the model is written because the trace was told to adopt what it found: conditions held out in turn do not show that it is \
                 better than the law alone".to_owned(),
            );
        }
        if !left_out.differ() {
            warnings.push(
                "only one amplitude and one frequency were fitted: what the model does at others is unknown; record more of them".to_owned(),
            );
        }
        if selection.warms_along && solution.law.len() > 1 {
            warnings.push(
                "coefficients over amplitude explain the recordings, and so does a change with the temperature, which rose or fell along \
                 with the amplitude: record one amplitude at two temperatures".to_owned(),
            );
        }
        warnings.extend(in_doubt);
        let explainable = match is_more_missing {
            true => self.witness(&left_out, &model)?,
            false => explainable,
        };
        if let Some(witness) = explainable.filter(|one| one.counts()) {
            warnings.push(format!(
                "a general regressor predicts {:.0} % of the residual's variance from the motion, on conditions that it was not fitted to: \
                 the law lacks something that has no name here",
                100.0 * witness.share
            ));
        }
        let names = |held: bool| {
            let recordings = self.recordings.iter().enumerate();
            let some = recordings.filter(move |(index, _)| (*index >= self.fitted) == held);
            some.map(|(_, (trajectory, _))| trajectory.name.clone())
                .collect()
        };
        let result = TraceResult {
            recordings: names(false),
            held_out: names(true),
            noise_floor_nrmse: noise_floor,
            baseline: Baseline {
                law: self.sought.law.name().to_owned(),
                known: self.known(),
                nrmse_fitted: without.nrmse_fitted,
                nrmse_held_out: without.nrmse_held_out,
                nrmse_judged: Some(selection.baseline.score.nrmse()),
                staged: self.staged()?,
            },
            law: law_estimates(&model, &uncertainty),
            verdict,
            effects,
            unconfirmed,
            conditions: graded
                .iter()
                .flat_map(|graded| graded.conditions(&left_out))
                .collect(),
            remainder,
            explainable,
            elsewhere: left_out.differ().then(|| elsewhere(&in_turn)).flatten(),
            candidates: self.candidates(selection, &found)?,
            effects_rejected_by: effects_rejected_by
                .or((fails_on_held_out && verdict == Verdict::Unlisted).then_some(Rule::SaysLess)),
            table_rejected_by,
            separating_test,
            separating_blocks,
            held_out_differs: over_noise.differs_from_explained(&model, left).is_some(),
            depends_on: depends_on(&model, &residual_depends_on),
            correction: model.correction.as_ref().map(CorrectionSummary::of),
            warnings,
            guesses: Vec::new(),
            rig: self.sought.rig,
            noise_known: self.trajectories.iter().all(|one| one.noise_is_known),
            augmented: with,
            on_target: OnTarget {
                nrmse_held_out: on_target.nrmse_held_out,
            },
            adopted: !solution.is_alone() || model.correction.is_some(),
            rejected,
            operating_conditions: operating::conditions(&self.recordings),
        };
        let forces = self
            .recordings
            .iter()
            .zip(before.into_iter().zip(after))
            .map(|((_, roles), (before, after))| Forces {
                roles: roles.clone(),
                before,
                after,
            })
            .collect();
        Ok(Closed {
            result,
            baseline,
            model,
            forces,
            selection: selected,
        })
    }

    /// Fits the terms of `known` and the given ones to the samples picked, fewer than in the closing fit.
    pub(super) fn refit(
        &self,
        rows: &Rows,
        known: &Solution,
        picked: Picked,
    ) -> (Rows<'_>, Solution) {
        let nodes = rows.nodes().to_vec();
        let (all, law) = (self.trajectories, self.sought.law);
        let rows = Rows::along(&self.strides, all, law, nodes, Purpose::InTurn, picked);
        let rows = rows.with_nodes_seen();
        let solution = self.fit_near(&rows, known);
        (rows, solution)
    }

    /// The model from such a fit.
    pub(super) fn refit_model(&self, rows: &Rows, known: &Solution, picked: Picked) -> Model {
        self.refit(rows, known, picked).1.model()
    }

    /// The range of the recordings' motion.
    pub(super) fn extent(&self) -> &Extent {
        &self.extent
    }

    /// The families of the known effects.
    fn known(&self) -> Vec<String> {
        let known = self.sought.known.iter();
        let mut names: Vec<String> = known
            .map(|known| known.term.form.family().name().to_owned())
            .collect();
        names.dedup();
        names
    }

    /// The errors of eq 13 identified as in the paper, which has no other law.
    fn staged(&self) -> Result<Option<Errors>, ModelError> {
        if self.sought.law != BaseLaw::Mixed || !self.sought.known.is_empty() {
            return Ok(None);
        }
        let Some(law) = staged(&self.rows[0]) else {
            return Ok(None);
        };
        let model = Model {
            law,
            effects: Vec::new(),
            correction: None,
            controls: Vec::new(),
        };
        Ok(Some(self.evaluate(&model, predict)?.1))
    }

    /// The terms of `known` fitted to these rows.
    pub(super) fn fit_near(&self, rows: &Rows, known: &Solution) -> Solution {
        Problem::new(rows, &self.extent, &known.terms()).solve_near(known)
    }

    /// Fits the terms of `known` along another motion that is equally likely. This shows the effect of the motion's error on each
    /// parameter: a noisy displacement makes part of the law's force look like the effect's, however many samples there are.
    fn fit_moved(&self, rows: &Rows, known: &Solution) -> Solution {
        let moved = self.trajectories.iter().map(Trajectory::as_it_may_be);
        let moved: Vec<Trajectory> = moved.collect();
        let nodes = rows.nodes().to_vec();
        let rows = Rows::gather(
            &moved,
            self.sought.law,
            nodes,
            Purpose::Result.rows(),
            |which, sample| self.roles.is_open(which, sample),
        );
        self.fit_near(&rows, known)
    }

    /// The same without the terms that all of the data hold at 0.
    pub(super) fn fit_there(&self, rows: &Rows, known: &Solution) -> Solution {
        let mut solution = self.fit_near(rows, known);
        while let Some(index) = self.first_that_is_nothing(rows, &solution) {
            solution = self.fit_near(rows, &solution.without(index));
        }
        solution
    }

    fn first_that_is_nothing(&self, rows: &Rows, solution: &Solution) -> Option<usize> {
        let is_found = |value: &TermValue| !value.term.is_known;
        let is_refused = |value: &TermValue| is_found(value) && !value.is_admissible();
        let refused = solution.terms.iter().position(is_refused);
        if refused.is_some() || !solution.terms.iter().any(is_found) {
            return refused;
        }
        let basis = Basis::new(rows, &self.extent, &solution.terms()).around(solution);
        let columns = basis.columns(&solution.search, None);
        let nothing =
            basis.adds_nothing(&columns, &solution.linear(), TracePolicy::in_use().nothing);
        let uncertainty = LazyCell::new(|| Uncertainty::of(rows, &self.extent, solution));
        // With shapes, a size alone says little: it may be known only together with them. Without a bound it is not known at all.
        let may_be_0 = |index: usize, value: &TermValue| {
            let is_within = |(size, half): (&f64, &f64)| half.is_finite() && size.abs() <= *half;
            value.shapes.is_empty()
                && !value.sizes.is_empty()
                && (value.sizes.iter().zip(&uncertainty.terms[index].sizes)).all(is_within)
        };
        let mut terms = solution.terms.iter().zip(nothing).enumerate();
        terms
            .find(|&(index, (value, adds_nothing))| {
                is_found(value) && (adds_nothing || may_be_0(index, value))
            })
            .map(|(index, _)| index)
    }
}

/// The errors of a model on conditions that were left out of its fit.
fn elsewhere(in_turn: &[RelativeError]) -> Option<Elsewhere> {
    let most = RelativeError::mean(in_turn).most.sqrt();
    most.is_finite().then_some(Elsewhere {
        conditions: in_turn.len(),
        most,
    })
}

/// Whether a held-out recording only repeats a fitted one.
pub(super) fn brings_nothing_new(held: &Trajectory, fitted: &[Trajectory]) -> bool {
    held_roles(held, fitted)
        .iter()
        .all(|&role| role == Role::Fit)
}

/// A recording that begins with a fitted one is the same test, continued: only the rest was never fitted.
fn held_roles(held: &Trajectory, fitted: &[Trajectory]) -> Vec<Role> {
    let known = fitted
        .iter()
        .filter(|fitted| held.force.starts_with(&fitted.force))
        .map(Trajectory::len)
        .max()
        .unwrap_or(0);
    (0..held.len())
        .map(|sample| {
            if sample < known {
                Role::Fit
            } else {
                Role::HeldOut
            }
        })
        .collect()
}
