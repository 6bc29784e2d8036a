//! How each family of effects enters a fit: a file a family, and its line in the list here.
//!
//! What an effect is stands in the crate. Here stands only what identification needs: what is linear in it, what is searched, and
//! where the search starts.

use std::collections::BTreeMap;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::LazyLock;

use mesh_damper::effects::{Equations, LawForce};
use mesh_damper::error::ConfigError;
use mesh_damper_model::Family;
use mesh_damper_model::predict::motion_at;
use mesh_damper_recording::ControlChannel;
use mesh_damper_recording::trajectory::Trajectory;

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

/// The control input that a form sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// Its place among those of a recording.
    pub place: usize,
    /// Whether it acts late, of which only one that changes within a recording says anything.
    pub is_late: bool,
}

/// How the force depends on a form's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// It adds so many forces, each proportional to a size.
    Adds(usize),
    /// It scales the mixed damping law, by so many sizes.
    Scales(usize),
    /// It changes the motion that all else is given, or what is shown of all forces.
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

/// Step of a difference that stands for a derivative by a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Part of the shape.
    Part(f64),
    /// A tick to either side.
    Tick,
}

/// What a form that [`Entry::Moves`] does to a recording's motion, with its shape and with how the specimen gives way in all; how
/// many ticks late the force then is.
pub(crate) type Moving = fn(&mut Trajectory, f64, Option<&Deflection>) -> Option<usize>;

/// What a form that [`Entry::Moves`] makes of the forces in kN behind it, at every sample of a tick in s, with its shape.
pub(crate) type Showing = fn(&mut [f64], f64, f64);

/// Forces in kN at every sample, one for each size, of shapes and a motion.
pub type UnitForces = fn(&[f64], &Trajectory) -> Result<Vec<Vec<f64>>, ConfigError>;

/// A form in which an effect is fitted. Most families have one.
pub struct FormSpec {
    /// Its name.
    pub name: &'static str,
    /// The family it is of, by name.
    pub family: &'static str,
    /// How the force depends on its parameters.
    pub entry: Entry,
    /// The names of its shapes: positive numbers that are searched on a logarithmic scale.
    pub shape_names: &'static [&'static str],
    /// Whether a negative size would be a source of energy, or a mass or a wall that pulls.
    pub size_is_positive: bool,
    /// Of its sizes some may be 0: elements that are not there.
    pub elements_may_miss: bool,
    /// How many terms of this form one model may have.
    pub most: usize,
    /// Whether it may stand beside another form of its family.
    pub stands_with_siblings: bool,
    /// Families of effects that this one is at an end of its shapes, or has all of: one of them is simpler where it does as well.
    pub special_cases: &'static [&'static str],
    /// It is tried only in the place of one of those.
    pub refines: bool,
    /// Forms of one family with the same word are elements of one effect.
    pub effect: &'static str,
    /// 0 for what is tried first; 1 for forms that are tried where a simpler one of their family is not enough.
    pub rank: u8,
    /// Least and largest size that scales the law: as far as the crate takes them.
    pub scale_range: [f64; 2],
    /// Ranges and starts of its shapes.
    pub shapes: fn(&Extent) -> Vec<Shape>,
    /// The forces in kN with each size 1 and these shapes at every sample.
    pub unit_forces: UnitForces,
    /// What the law's elastic and damping force gain for these sizes and shapes, as parts of them.
    pub gains: fn(&[f64], &[f64], &Moment) -> [f64; 2],
    /// What it does to the motion.
    pub(crate) moves: Moving,
    /// What it shows of all forces; such a form leaves the motion as it is.
    pub(crate) shows: Option<Showing>,
    /// The control input that it sees.
    pub input: Option<Input>,
    /// Its forces follow the clock, and not the motion.
    pub follows_clock: bool,
    /// Its motion depends on the force behind it.
    pub gives_way: bool,
    /// Of the derivative by its shapes.
    pub step: Step,
    /// The parameters of its elements by the names of [`mesh_damper_model::parameter_unit`], each with the size it has.
    pub elements: fn(&TermValue) -> Vec<Element>,
    /// The shape with this name of the parameters of an element: [`FormSpec::elements`] read the other way round.
    pub shape_of: fn(&BTreeMap<&str, f64>, &str) -> Option<f64>,
}

/// Parameters by name, and the size that stands for them.
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
        // It is positive where a parameter may have either sign.
        shape_of: |element, name| Some(element.get(name)?.abs()),
    };
}

/// One of the forms. Two are the same where their names are.
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

    /// Its place in [`Form::all`].
    pub fn place(self) -> usize {
        let mut all = Self::all();
        all.position(|form| form == self).unwrap_or(usize::MAX)
    }

    /// The family it is of.
    ///
    /// # Panics
    /// Never: a test holds every form against the crate's list.
    pub fn family(self) -> Family {
        Family::named(self.family).expect("the family stands in the crate's list")
    }

    /// Whether both may not stand in one model.
    pub fn excludes(self, other: Self) -> bool {
        self != other && self.family == other.family && !self.stands_with_siblings
    }

    /// Whether each of its sizes is of an element of its own.
    pub(crate) fn is_several(self) -> bool {
        self.sizes() > 1 && !self.effect.is_empty()
    }

    /// Whether `trajectories` have what it depends on.
    pub fn is_seen_in(self, trajectories: &[Trajectory]) -> bool {
        let has_temperature = trajectories.iter().any(|t| t.temperature.is_some());
        let has_input = self.input.is_none_or(|input| {
            let channels = trajectories.iter().map(|t| t.controls.get(input.place));
            let all: Option<Vec<&ControlChannel>> = channels.collect();
            all.is_some_and(|all| !input.is_late || all.iter().any(|each| each.changes()))
        });
        has_input && (has_temperature || !self.family().depends_on_temperature())
    }

    /// How many sizes it has.
    pub(crate) fn sizes(self) -> usize {
        match self.entry {
            Entry::Adds(count) | Entry::Scales(count) => count,
            Entry::Moves => 0,
        }
    }

    /// How many parameters of it are searched.
    pub(crate) fn searched(self) -> usize {
        self.scales() + self.shape_names.len()
    }

    /// How many of these are sizes, which come before the shapes.
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

/// The force of `effect` at every sample, from rest.
fn run<E: Equations<f64>>(effect: &E, motion: &Trajectory) -> Vec<f64> {
    let mut state = E::AT_REST;
    // What effects see is made sample by sample: all of it takes as much memory as the trajectories.
    (0..motion.len())
        .map(|sample| motion_at(motion, sample).clamped())
        .map(|motion| effect.force(&mut state, &motion, LawForce::default()))
        .collect()
}

/// The only element of a form, with its parameters.
fn one(parameters: Vec<(&'static str, f64)>) -> Vec<Element> {
    vec![(0, parameters)]
}

#[cfg(test)]
mod tests {
    use mesh_damper::effects::DESCRIPTIONS;

    use super::*;
    use crate::term::{Term, added_effects};

    /// The name of the effect that a model file has where this form was found.
    fn effect_of(form: Form) -> &'static str {
        let reference = 20.0;
        let value = TermValue {
            term: Term {
                form,
                reference,
                is_known: false,
            },
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
}
