//! The residual table: a correction fitted to the residual of a law when no listed effect explains it.
//!
//! The table of [`mesh_damper::effects::residual_table`] is linear in its cells. So it is fitted by least squares together with the
//! coefficients of eq 13. It follows a few trends, and is as smooth around them as the error in left-out data permits. The first
//! table is over speed; a table over a memory replaces it only if that clearly reduces the error.

pub(crate) mod cholesky;
pub(crate) mod design;
pub(crate) mod edges;
pub(crate) mod gram;
pub(crate) mod growth;
mod hat;
pub(crate) mod memory;
pub(crate) mod search;
pub(crate) mod settle;
pub(crate) mod system;
pub(crate) mod trend;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::passivity::damping_beside_table;
use mesh_damper_model::correction::{CorrectionTable, MemoryAxis, Remembered};
use mesh_damper_model::{MAX_EFFECTS, Model, ModelError};
use mesh_damper_recording::trajectory::Trajectory;

use super::beyond_noise::beyond_noise;
use design::{Coefficients, Design, Reach, Recalled};
use gram::{GramRows, Solved, TableForm};
use search::{Memorable, momentary, promising, remembering};
use settle::{settle, settled};
use trend::{Trend, Variable};

mesh_damper_recording::numbers! {
    /// When a residual table is used.
    CorrectionPolicy {
        /// A residual table is used if it reduces the error beyond the noise to at most this fraction of the error without it.
        worthwhile: f64 = 0.85, Tuned("the blind trial");
        /// A residual table has a memory if that reduces the error beyond the noise to at most this fraction of the error without memory.
        /// Among many memories one looks better by chance.
        remembered: f64 = 0.75, Tuned("the blind trial");
        /// A residual table depends on a variable if the error is more than this many times as large without that variable.
        needed: f64 = 1.7, Tuned("the blind trial");
    }
}

/// Counts of the largest cell. Derived: below what 16 bits hold.
const FULL: f64 = 32_000.0;

/// The structure of a correction, before its cells are solved for.
#[derive(Clone, Debug)]
pub struct Choice {
    reach: Reach,
    trends: Vec<Trend>,
    /// The smoothness of the table around the trends, if there is a table.
    table: Option<f64>,
    memory: Option<MemoryAxis>,
    /// Whether the table is changed where it would drive a motion.
    is_passive: bool,
}

impl Choice {
    /// Whether it remembers how long a test has run, whatever the motion was.
    pub fn goes_on_with_time(&self) -> bool {
        self.memory
            .is_some_and(|memory| memory::goes_on_with_time(memory.of))
    }

    fn form(&self) -> TableForm<'_> {
        TableForm {
            trends: &self.trends,
            table: self.table,
        }
    }

    /// The same for other samples, with the memory at each of their rows; `None` if that never changes there.
    fn over(&self, design: &Design) -> Option<(Self, Option<Recalled>)> {
        let recalled = match self.memory {
            Some(memory) => Some(design.recall(memory.of)?),
            None => None,
        };
        let choice = Self {
            reach: design.reach,
            memory: recalled.as_ref().map(Recalled::axis),
            ..self.clone()
        };
        Some((choice, recalled))
    }
}

/// A choice and its result.
#[derive(Clone)]
struct Fitted {
    choice: Choice,
    solved: Solved,
}

/// `model` with a correction and with eq 13 fitted again, as far as that predicts clearly better than `model` with eq 13 fitted again
/// alone: the best correction without a memory, and the best with one. Each is given as far as it is passive and, if that is not all of it,
/// as it was fitted: a table over displacement and velocity that stands for a memory predicts a motion like those it was fitted to, but
/// would drive others, so that firmware takes it only from who insists.
///
/// The fit uses the samples that `included(trajectory, sample)` picks. The trends, the smoothness around them and the memory are
/// chosen by the error in the fit and by the error in blocks left out of the fit one at a time, each with an amplitude that another
/// block has too. A memory of how long a test has run is accepted only if `is_seen(with, without)` holds for the model with it and
/// the best model without it. The choices are returned too.
///
/// # Errors
/// A model that the crate refuses.
pub fn fit(
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
    is_seen: impl Fn(&Model, &Model) -> Result<bool, ModelError>,
) -> Result<Vec<(Model, Choice)>, ModelError> {
    let Some(design) = Design::new(trajectories, model, included)? else {
        return Ok(Vec::new());
    };
    let start = Coefficients::of(model);
    let Some(alone) = settle(&design, &start, TableForm::NONE, None) else {
        return Ok(Vec::new());
    };
    let Some(plain) = momentary(&design, &alone) else {
        return Ok(Vec::new());
    };
    let tick = tick_of(trajectories);
    let completed = |Fitted { choice, solved }: Fitted| -> Result<Vec<_>, ModelError> {
        if solved.error > CorrectionPolicy::in_use().worthwhile * alone.error {
            return Ok(Vec::new());
        }
        let free = (corrected(model, &solved, &choice, tick)?, choice);
        if free.1.memory.is_some_and(stays) {
            return Ok(vec![free]);
        }
        let choice = Choice {
            is_passive: true,
            ..free.1.clone()
        };
        let passive = (corrected(model, &solved, &choice, tick)?, choice);
        Ok(match passive.0 == free.0 {
            true => vec![passive],
            false => vec![passive, free],
        })
    };
    let mut found = completed(plain.clone())?;
    // If the error is near the noise without a memory, a memory cannot reduce it much.
    let may_remember = CorrectionPolicy::in_use().remembered * plain.solved.error
        > beyond_noise(0.0, design.noise());
    if !may_remember {
        return Ok(found);
    }
    let mut kinds = promising(&design, &plain);
    let best_of = |kinds: &[Memorable]| {
        let remembered = remembering(&design, &plain, kinds).map(completed);
        Ok(remembered.transpose()?.unwrap_or_default())
    };
    let best: Vec<(Model, Choice)> = best_of(&kinds)?;
    let Some(over_time) = best.last().filter(|(_, choice)| choice.goes_on_with_time()) else {
        found.extend(best);
        return Ok(found);
    };
    kinds.retain(|kind| !memory::goes_on_with_time(kind.recalled.of));
    let of_motion = best_of(&kinds)?;
    let without = of_motion.last().or(found.last());
    let is_over_time = is_seen(&over_time.0, without.map_or(model, |(without, _)| without))?;
    found.extend(if is_over_time { best } else { of_motion });
    Ok(found)
}

/// `model` with the correction of an earlier choice, fitted to other samples; without a correction if the samples do not determine
/// it. It is over the range of these samples: a fit without the largest motion knows nothing of that.
///
/// # Errors
/// A model that the crate refuses.
pub fn refit(
    choice: &Choice,
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
) -> Result<Model, ModelError> {
    let design = Design::new(trajectories, model, included)?;
    let solved = design.and_then(|design| {
        let (choice, recalled) = choice.over(&design)?;
        let start = Coefficients::of(model);
        let solved = settled(&design, &start, choice.form(), recalled.as_ref())?;
        Some((choice, solved))
    });
    match solved {
        Some((choice, solved)) => corrected(model, &solved, &choice, tick_of(trajectories)),
        None => Ok(model.clone()),
    }
}

/// The variables that the correction of a choice depends on, by their names in `trace.json`: each variable without which the
/// samples that `included` picks are explained clearly worse, and the memory.
///
/// # Errors
/// A model that the crate refuses.
pub fn depends_on(
    choice: &Choice,
    trajectories: &[Trajectory],
    model: &Model,
    included: impl Fn(usize, usize) -> bool,
) -> Result<Vec<&'static str>, ModelError> {
    let mut names = Vec::new();
    let design = Design::new(trajectories, model, included)?;
    let over = design
        .as_ref()
        .and_then(|design| Some((design, choice.over(design)?)));
    if let Some((design, (choice, recalled))) = &over {
        let at = Coefficients::of(model);
        let rows = GramRows::over(design, &at, recalled.as_ref());
        let of = recalled.as_ref().map(|recalled| recalled.of);
        let error_of = |form: TableForm| Some(rows.sums(form)?.cross_validated(form)?.error);
        let along_trends = |without: Option<Variable>| {
            let (error, _) = growth::grown(&rows, &trend::trends(of, without))?;
            Some(error)
        };
        let least = |errors: [Option<f64>; 2]| {
            let errors = errors.into_iter().flatten();
            errors.fold(f64::INFINITY, f64::min)
        };
        let all = least([along_trends(None), error_of(choice.form())]);
        for (name, variable) in [
            ("displacement", Variable::Displacement),
            ("velocity", Variable::Velocity),
        ] {
            let hats = hat::hats_without(variable, of);
            let table = TableForm {
                trends: &hats,
                ..TableForm::NONE
            };
            if least([along_trends(Some(variable)), error_of(table)])
                > CorrectionPolicy::in_use().needed * all
            {
                names.push(name);
            }
        }
    }
    let of = choice.memory.map(|memory| memory.of.is_of());
    names.extend(of.filter(|name| !names.contains(name)));
    Ok(names)
}

/// Whether a table over this memory cannot be made passive: without the friction that it shares with the law it predicts far worse.
fn stays(axis: MemoryAxis) -> bool {
    matches!(
        axis.of,
        Remembered::Lag { .. } | Remembered::Travel { .. } | Remembered::Largest
    )
}

/// A tick at which the model's effects were fitted, s.
fn tick_of(trajectories: &[Trajectory]) -> f64 {
    trajectories.first().map_or(1e-3, |first| first.tick)
}

/// The model with the table rounded to what the crate stores and, for a passive choice, changed where it would drive a motion at any
/// amplitude of the law.
fn corrected(
    model: &Model,
    solved: &Solved,
    choice: &Choice,
    tick: f64,
) -> Result<Model, ModelError> {
    let largest = solved
        .cells
        .iter()
        .fold(0.0_f64, |most, cell| most.max(cell.abs()));
    let unit = (largest / FULL).max(f64::MIN_POSITIVE.sqrt());
    let counts = solved.cells.iter().map(|cell| (cell / unit).round() as i16);
    let mut table = CorrectionTable {
        reach: choice.reach.displacement,
        speed: choice.reach.speed,
        unit,
        cells: counts.collect(),
        memory: choice.memory,
    };
    let mut model = Model {
        law: solved.coefficients.nodes(model),
        effects: model.effects.clone(),
        controls: model.controls.clone(),
        correction: None,
    };
    let built = table
        .build::<f64>(tick)
        .map_err(|error| ModelError::Refused {
            place: "correction".into(),
            error,
        })?;
    let laws = model
        .law
        .iter()
        .map(|node| model.augmented(node.amplitude, tick));
    let laws: Vec<AugmentedLaw<f64, MAX_EFFECTS>> = laws.collect::<Result<_, _>>()?;
    // Between two nodes the logarithm of c*v^alpha is concave, so that it is least at a node.
    let damping = |speed| {
        let each = laws.iter().map(|law| damping_beside_table(law, speed));
        each.fold(f64::INFINITY, f64::min)
    };
    if choice.is_passive {
        table.cells = built.passive(damping).cells().to_vec();
    }
    model.correction = Some(table);
    Ok(model)
}
