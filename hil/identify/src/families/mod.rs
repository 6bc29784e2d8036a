//! How each family of effects enters a fit: one file per family, and one line in the list here.
//!
//! The crate defines the effects. This module adds the parts that identification needs: the linear parameters, the searched ones,
//! and the starts of the search.

use std::collections::BTreeMap;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::LazyLock;

use mesh_damper::effects::{Equations, LawForce};
use mesh_damper::error::ConfigError;
use mesh_damper_model::Family;
use mesh_damper_model::predict::motion_at;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::Stride;
use mesh_damper_tables::control::ControlChannel;

use crate::shape::{Extent, Shape};
use crate::solution::Deflection;
use crate::term::TermValue;

/// Makes the module of each family in the list, and the list of all their forms.
macro_rules! families {
    ($($module:ident,)+) => {
        $(pub mod $module;)+

        fn listed() -> Vec<Form> {
            [$(&$module::FORMS[..]),+].concat()
        }
    };
}

families! {
    offset,
    asymmetry,
    hardening,
    load_friction,
    directional,
    viscous,
    inertia,
    stop,
    stick_slip,
    relaxation,
    yielding,
    control_input,
    backlash,
    degradation,
    drift,
    temperature,
    delay,
    gap,
    compliance,
    periodic,
}

/// The control input of a form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// Its index among those of a recording.
    pub place: usize,
    /// Whether it acts with a delay. Only an input that changes within a recording can show that.
    pub is_late: bool,
}

/// How the force depends on a form's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// It adds this number of forces, each proportional to a size.
    Adds(usize),
    /// It scales the mixed damping law, with this number of sizes.
    Scales(usize),
    /// It changes the motion that all other terms see, or the readings of all forces.
    Moves,
}

/// The moment at which a law is scaled.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// mm.
    pub displacement: f64,
    /// Sign of the velocity; 0 at rest.
    pub direction: f64,
    /// Since the test began.
    pub cycles: f64,
    /// °C.
    pub temperature: f64,
    /// Temperature at which the law holds, °C.
    pub reference: f64,
}

/// Step of a finite difference with respect to a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Fraction of the shape.
    Part(f64),
    /// A tick to either side.
    Tick,
}

/// The change of a recording's motion by a form that [`Entry::Moves`], from its shape and the deflection of the specimen; returns
/// the delay of the force in ticks.
pub(crate) type Moving = fn(&mut Trajectory, f64, Option<&Deflection>) -> Option<usize>;

/// The readings of forces in kN by a form that [`Entry::Moves`], at every sample, for a tick in s and its shape.
pub(crate) type Showing = fn(&mut [f64], f64, f64);

/// A motion, and the samples at which a force along it is computed.
pub(crate) struct Path<'a> {
    pub motion: &'a Trajectory,
    pub strides: &'a [Stride],
}

/// A force in kN at every sample of a path; 0 at the samples that it passes over.
type UnitForce = Result<Vec<f64>, ConfigError>;

/// Such forces for shapes, one for each size.
pub(crate) type UnitForces = fn(&[f64], &Path) -> Result<Vec<Vec<f64>>, ConfigError>;

/// A form in which an effect is fitted. Most families have one.
pub struct FormSpec {
    /// Its name.
    pub name: &'static str,
    /// The name of its family.
    pub family: &'static str,
    /// How the force depends on its parameters.
    pub entry: Entry,
    /// The names of its shapes: positive numbers that are searched on a logarithmic scale.
    pub shape_names: &'static [&'static str],
    /// Whether a negative size would be a source of energy or a wall that pulls.
    pub size_is_positive: bool,
    /// Whether some of its sizes may be 0: missing elements.
    pub elements_may_miss: bool,
    /// The largest number of terms of this form in one model.
    pub most: usize,
    /// Whether it may be in a model together with another form of its family.
    pub stands_with_siblings: bool,
    /// Families of effects that this form contains, or becomes at the end of its shapes. One of them is simpler and preferred if it
    /// does equally well.
    pub special_cases: &'static [&'static str],
    /// Whether it is tried only in place of one of those.
    pub refines: bool,
    /// Forms of one family with the same word are elements of one effect.
    pub effect: &'static str,
    /// 0 for a form that is tried first; 1 for one that is tried if a simpler form of its family is not enough.
    pub rank: u8,
    /// Smallest and largest size that scales the law: the crate's range.
    pub scale_range: [f64; 2],
    /// Ranges and starts of its shapes.
    pub shapes: fn(&Extent) -> Vec<Shape>,
    /// The forces in kN with each size 1 and these shapes along a path.
    pub(crate) unit_forces: UnitForces,
    /// Relative change of the law's elastic and damping force for these sizes and shapes.
    pub gains: fn(&[f64], &[f64], &Moment) -> [f64; 2],
    /// Its change of the motion.
    pub(crate) moves: Moving,
    /// Its readings of all forces; such a form leaves the motion unchanged.
    pub(crate) shows: Option<Showing>,
    /// The control input that it depends on.
    pub input: Option<Input>,
    /// Whether its forces follow the clock, not the motion.
    pub follows_clock: bool,
    /// Whether its motion depends on the force behind it.
    pub gives_way: bool,
    /// Step of the derivative with respect to its shapes.
    pub step: Step,
    /// The parameters of its elements by their names in [`mesh_damper_model::parameter_unit`], each element with its size.
    pub elements: fn(&TermValue) -> Vec<Element>,
    /// The shape with this name from the parameters of an element: the inverse of [`FormSpec::elements`].
    pub shape_of: fn(&BTreeMap<&str, f64>, &str) -> Option<f64>,
}

/// A size, and the parameters by name that belong to it.
pub type Element = (usize, Vec<(&'static str, f64)>);

impl FormSpec {
    /// A form with one size, no shape, and a size of either sign.
    const PLAIN: Self = Self {
        name: "",
        family: "",
        entry: Entry::Adds(1),
        shape_names: &[],
        size_is_positive: false,
        elements_may_miss: false,
        most: 1,
        stands_with_siblings: false,
        special_cases: &[],
        refines: false,
        effect: "",
        rank: 0,
        scale_range: [-1.0, 1.0],
        shapes: |_| Vec::new(),
        unit_forces: |_, _| Ok(Vec::new()),
        gains: |_, _, _| [0.0; 2],
        moves: |_, _, _| None,
        shows: None,
        input: None,
        follows_clock: false,
        gives_way: false,
        step: Step::Part(1e-4),
        elements: |_| Vec::new(),
        // It is positive even if a parameter may have either sign.
        shape_of: |element, name| Some(element.get(name)?.abs()),
    };
}

/// One of the forms. Forms are equal if their names are.
#[derive(Clone, Copy)]
pub struct Form(&'static FormSpec);

static ALL: LazyLock<Vec<Form>> = LazyLock::new(|| {
    let mut all = listed();
    all.sort_by_key(|form| form.rank);
    all
});

impl Form {
    /// Every form, the simplest first.
    pub fn all() -> impl Iterator<Item = Self> {
        ALL.iter().copied()
    }

    /// The form with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|form| form.name == name)
    }

    /// Whether a law with its effect has to be run at every sample: the effect follows a clock, or changes the motion or the readings,
    /// for which it may hold earlier samples.
    pub fn counts_ticks(self) -> bool {
        self.follows_clock || self.entry == Entry::Moves
    }

    /// Its index in [`Form::all`].
    pub fn place(self) -> usize {
        let mut all = Self::all();
        all.position(|form| form == self).unwrap_or(usize::MAX)
    }

    /// Its family.
    ///
    /// # Panics
    /// Never: a test checks every form against the crate's list.
    pub fn family(self) -> Family {
        Family::named(self.family).expect("the family stands in the crate's list")
    }

    /// Whether the two may not be in one model.
    pub fn excludes(self, other: Self) -> bool {
        self != other && self.family == other.family && !self.stands_with_siblings
    }

    /// Whether each of its sizes belongs to a separate element.
    pub(crate) fn is_several(self) -> bool {
        self.sizes() > 1 && !self.effect.is_empty()
    }

    /// Whether `trajectories` contain the quantity that it depends on.
    pub fn is_seen_in(self, trajectories: &[Trajectory]) -> bool {
        let has_temperature = trajectories.iter().any(|t| t.temperature.is_some());
        let has_input = self.input.is_none_or(|input| {
            let channels = trajectories.iter().map(|t| t.controls.get(input.place));
            let all: Option<Vec<&ControlChannel>> = channels.collect();
            all.is_some_and(|all| !input.is_late || all.iter().any(|each| each.changes()))
        });
        has_input && (has_temperature || !self.family().depends_on_temperature())
    }

    /// The number of its sizes.
    pub(crate) fn sizes(self) -> usize {
        match self.entry {
            Entry::Adds(count) | Entry::Scales(count) => count,
            Entry::Moves => 0,
        }
    }

    /// The number of its searched parameters.
    pub(crate) fn searched(self) -> usize {
        self.scales() + self.shape_names.len()
    }

    /// The number of these that are sizes; they come before the shapes.
    pub(crate) fn scales(self) -> usize {
        match self.entry {
            Entry::Scales(count) => count,
            _ => 0,
        }
    }
}

impl std::ops::Deref for Form {
    type Target = FormSpec;

    fn deref(&self) -> &FormSpec {
        self.0
    }
}

impl PartialEq for Form {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Form {}

impl Hash for Form {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

impl fmt::Debug for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// The force of `effect` along a path, from rest, kN; 0 at the samples that the path passes over.
fn run<E: Equations<f64> + Copy>(effect: Result<E, ConfigError>, path: &Path) -> UnitForce {
    let effect = effect?;
    run_at(|_| Ok(effect), path)
}

/// The same for an effect that depends on the tick, `of` a tick in s.
fn run_at<E: Equations<f64>>(
    of: impl Fn(f64) -> Result<E, ConfigError>,
    &Path { motion, strides }: &Path,
) -> UnitForce {
    let mut state = E::AT_REST;
    let mut forces = vec![0.0; motion.len()];
    // The inputs of effects are computed sample by sample: all of them would take as much memory as the trajectories.
    for stride in strides {
        let effect = of(stride.step as f64 * motion.tick)?;
        for sample in stride.visits() {
            let motion = motion_at(motion, sample).clamped();
            forces[sample] = effect.force(&mut state, &motion, LawForce::default());
        }
    }
    Ok(forces)
}

/// The only element of a form, with its parameters.
fn one(parameters: Vec<(&'static str, f64)>) -> Vec<Element> {
    vec![(0, parameters)]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::Arc;

    use mesh_damper::effects::DESCRIPTIONS;

    use mesh_damper_recording::trajectory::strides::strides;

    use super::*;
    use crate::term::{Term, added_effects};

    /// The name in a model file of the effect that this form finds.
    fn effect_of(form: Form) -> &'static str {
        let reference = 20.0;
        let value = TermValue {
            term: Term::sought(form, reference),
            sizes: vec![0.1; form.sizes()],
            shapes: vec![1.0; form.shape_names.len()],
        };
        let added = added_effects(&[value]);
        assert_eq!(added.len(), 1, "{form:?}");
        let effect = added[0].effect::<f64>(0.1, || form.name.into()).unwrap();
        effect.description().name
    }

    #[test]
    fn every_effect_of_the_crate_has_a_form_and_every_form_its_effect() {
        let found: Vec<&str> = Form::all().map(effect_of).collect();
        for effect in DESCRIPTIONS {
            assert!(found.contains(&effect.name), "{}", effect.name);
        }
        for (place, form) in Form::all().enumerate() {
            assert_eq!(form.place(), place);
            let names = form.shape_names.iter().all(|name| {
                let mut effects = form.family().effects();
                effects.any(|effect| effect.parameters.iter().any(|p| p.name == *name))
            });
            assert!(names, "{form:?}");
        }
    }

    /// A slow sine and a fast one, and ramps with a pause at each turn.
    fn motions() -> [Trajectory; 2] {
        let sine = |frequency: f64, samples: i32| {
            (0..samples).map(move |n| 0.5 * (TAU * frequency * 5e-4 * f64::from(n)).sin())
        };
        let sines: Vec<f64> = sine(0.5, 8000).chain(sine(40.0, 1000)).collect();
        let ramp =
            |n: i32| 0.5 * f64::from((n % 2000 - 1000).abs() - 500).clamp(-450.0, 450.0) / 450.0;
        let ramps: Vec<f64> = (500..8500).map(ramp).collect();
        [sines, ramps].map(|displacement| {
            let force = displacement.clone();
            let mut motion = Trajectory::new("motion", 5e-4, &displacement, force, None, None);
            // It jumps within a step of the slow sine, and as the ramp turns.
            let current = (0..displacement.len()).map(|n| if n < 4011 { 0.2 } else { 1.0 });
            motion.controls = Arc::new(vec![ControlChannel {
                name: "current_A".into(),
                values: current.collect(),
            }]);
            motion
        })
    }

    /// Where a motion is fastest, a step is a tenth of the amplitude: half of the limit of Bouc and Wen, which is integrated.
    #[test]
    fn forces_with_a_memory_are_those_of_every_sample() {
        for motion in &motions() {
            let few = strides(std::slice::from_ref(motion), 100, |_, _| true).remove(0);
            let each = Stride::each(motion.len());
            let visits = || few.iter().flat_map(Stride::visits);
            assert!(visits().count() < motion.len() / 4);
            for (name, shapes) in [
                ("yielding", &[0.05, 0.4][..]),
                ("relaxation", &[0.02]),
                ("jenkins", &[0.03]),
                ("iwan", &[0.2]),
                ("bouc_wen", &[0.1, 2.0]),
                ("hardening_friction", &[0.4, 1.0, 0.3]),
                ("backlash", &[0.05, 0.1]),
                ("degradation", &[0.3]),
                ("weakening", &[0.05, 0.5, 0.1]),
                ("late_spring", &[0.02]),
            ] {
                let form = Form::named(name).unwrap();
                let [coarse, fine] = [&few, &each]
                    .map(|strides| (form.unit_forces)(shapes, &Path { motion, strides }).unwrap());
                for (coarse, fine) in coarse.iter().zip(&fine) {
                    let largest = fine.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
                    for sample in visits() {
                        let off = (coarse[sample] - fine[sample]).abs();
                        assert!(
                            off <= 0.02 * largest,
                            "{name} at {sample}: {off} of {largest}"
                        );
                    }
                }
            }
        }
    }
}
