//! A yielding branch and a dashpot whose strength follows a control input, for each input that a recording may have; and a spring in
//! the place of the branch.

use mesh_damper::effects::{CONTROLS, ControlInput, Yielding};
use mesh_damper::error::ConfigError;
use mesh_damper_recording::trajectory::Trajectory;

use super::yielding::stretch_and_rate;
use super::{Element, Entry, Form, FormSpec, Input, run};
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};
use crate::term::TermValue;

/// Number of starting values of the saturation of a control input. Convention: one below and one above the largest input.
const SATURATION_STARTS: usize = 2;

/// Number of starting values of the lag of a control input. Convention: each is some seven times the one before: a fit goes on from
/// there.
const LAG_STARTS: usize = 4;

/// Yield stretch in mm and rate in mm/s with which the branch is a spring: the ends of the crate's ranges.
const SPRING: [f64; 2] = [mesh_damper::limits::DISPLACEMENT, 1e-9];

/// For each input: a spring and a dashpot; a branch that yields, immediate and proportional, delayed, with a strength that saturates,
/// and both.
pub const FORMS: [Form; 5 * CONTROLS] = {
    const AT_ONCE: [Form; CONTROLS] = each::<false, false>();
    const LATE: [Form; CONTROLS] = each::<true, false>();
    const BENT: [Form; CONTROLS] = each::<false, true>();
    const BOTH: [Form; CONTROLS] = each::<true, true>();
    let mut all = [AT_ONCE[0]; 5 * CONTROLS];
    let mut place = 0;
    while place < CONTROLS {
        all[5 * place] = SPRINGS[place];
        all[5 * place + 1] = AT_ONCE[place];
        all[5 * place + 2] = LATE[place];
        all[5 * place + 3] = BENT[place];
        all[5 * place + 4] = BOTH[place];
        place += 1;
    }
    all
};

const fn each<const LATE: bool, const BENT: bool>() -> [Form; CONTROLS] {
    [
        Form(&Controlled::<0, LATE, BENT>::FORM),
        Form(&Controlled::<1, LATE, BENT>::FORM),
        Form(&Controlled::<2, LATE, BENT>::FORM),
        Form(&Controlled::<3, LATE, BENT>::FORM),
    ]
}

const SPRINGS: [Form; CONTROLS] = [
    Form(&ControlledSpring::<0>::FORM),
    Form(&ControlledSpring::<1>::FORM),
    Form(&ControlledSpring::<2>::FORM),
    Form(&ControlledSpring::<3>::FORM),
];

/// A spring and a dashpot, scaled by the input at `PLACE`.
struct ControlledSpring<const PLACE: usize>;

impl<const PLACE: usize> ControlledSpring<PLACE> {
    const FORM: FormSpec = FormSpec {
        name: SPRING_NAMES[PLACE],
        family: "control_input",
        entry: Entry::Adds(2),
        size_is_positive: true,
        elements_may_miss: true,
        input: Some(Input {
            place: PLACE,
            is_late: false,
        }),
        unit_forces: |_, motion| forces_of::<PLACE>(SPRING, [None; 2], motion),
        elements: |value| elements_of::<PLACE>(value, SPRING, [None; 2]),
        ..FormSpec::PLAIN
    };
}

/// Scaled by the input at `PLACE`, optionally delayed and saturating.
struct Controlled<const PLACE: usize, const LATE: bool, const BENT: bool>;

impl<const PLACE: usize, const LATE: bool, const BENT: bool> Controlled<PLACE, LATE, BENT> {
    const FORM: FormSpec = FormSpec {
        name: NAMES[2 * LATE as usize + BENT as usize][PLACE],
        family: "control_input",
        entry: Entry::Adds(2),
        shape_names: match (LATE, BENT) {
            (false, false) => &["yield_stretch", "rate"],
            (true, false) => &["yield_stretch", "rate", "lag"],
            (false, true) => &["yield_stretch", "rate", "saturation"],
            (true, true) => &["yield_stretch", "rate", "lag", "saturation"],
        },
        size_is_positive: true,
        elements_may_miss: true,
        refines: LATE || BENT,
        special_cases: if LATE || BENT {
            &["control_input"]
        } else {
            &[]
        },
        rank: if LATE || BENT { 2 } else { 0 },
        input: Some(Input {
            place: PLACE,
            is_late: LATE,
        }),
        shapes: Self::shapes,
        unit_forces: Self::unit_forces,
        elements: Self::elements,
        ..FormSpec::PLAIN
    };

    fn shapes(extent: &Extent) -> Vec<Shape> {
        let policy = ShapePolicy::in_use();
        let mut shapes = stretch_and_rate(extent).to_vec();
        if LATE {
            shapes.push(Shape::spread(
                policy.shortest_lag * extent.tick,
                policy.longest_lag * extent.duration,
                LAG_STARTS,
            ));
        }
        if BENT {
            let largest = extent.inputs[PLACE];
            let [least, most] = policy.saturation;
            shapes.push(Shape::spread(
                least * largest,
                most * largest,
                SATURATION_STARTS,
            ));
        }
        shapes
    }

    /// Lag and saturation among `shapes`, if present.
    fn further(shapes: &[f64]) -> [Option<f64>; 2] {
        let lag = LATE.then(|| shapes[2]);
        let saturation = BENT.then(|| shapes[2 + usize::from(LATE)]);
        [lag, saturation]
    }

    fn unit_forces(shapes: &[f64], motion: &Trajectory) -> Result<Vec<Vec<f64>>, ConfigError> {
        forces_of::<PLACE>([shapes[0], shapes[1]], Self::further(shapes), motion)
    }

    fn elements(value: &TermValue) -> Vec<Element> {
        let branch = [value.shape(0), value.shape(1)];
        elements_of::<PLACE>(value, branch, Self::further(&value.shapes))
    }
}

/// The force of the branch with a stiffness of 1 and that of the dashpot with a viscosity of 1.
fn forces_of<const PLACE: usize>(
    [yield_stretch, rate]: [f64; 2],
    [lag, saturation]: [Option<f64>; 2],
    motion: &Trajectory,
) -> Result<Vec<Vec<f64>>, ConfigError> {
    let of = |stiffness: f64, viscosity: f64| {
        let branch = Yielding::new(stiffness, yield_stretch, rate, 0.0, motion.tick)?;
        let mut effect = ControlInput::new(PLACE, branch, viscosity)?;
        if let Some(lag) = lag {
            effect = effect.with_lag(lag, motion.tick)?;
        }
        if let Some(saturation) = saturation {
            effect = effect.with_saturation(saturation)?;
        }
        Ok(run(&effect, motion))
    };
    Ok(vec![of(1.0, 0.0)?, of(0.0, 1.0)?])
}

fn elements_of<const PLACE: usize>(
    value: &TermValue,
    [yield_stretch, rate]: [f64; 2],
    [lag, saturation]: [Option<f64>; 2],
) -> Vec<Element> {
    let mut parameters = vec![
        ("stiffness", value.size(0)),
        ("yield_stretch", yield_stretch),
        ("rate", rate),
        ("viscosity", value.size(1)),
    ];
    parameters.extend(lag.map(|lag| ("lag", lag)));
    parameters.extend(saturation.map(|saturation| ("saturation", saturation)));
    parameters.push(("input", PLACE as f64));
    super::one(parameters)
}

const SPRING_NAMES: [&str; CONTROLS] = [
    "controlled_spring",
    "controlled_spring_2",
    "controlled_spring_3",
    "controlled_spring_4",
];

/// In the order of delay and saturation, and then of the places.
const NAMES: [[&str; CONTROLS]; 4] = [
    [
        "control_input",
        "control_input_2",
        "control_input_3",
        "control_input_4",
    ],
    [
        "saturating_input",
        "saturating_input_2",
        "saturating_input_3",
        "saturating_input_4",
    ],
    ["late_input", "late_input_2", "late_input_3", "late_input_4"],
    [
        "late_saturating_input",
        "late_saturating_input_2",
        "late_saturating_input_3",
        "late_saturating_input_4",
    ],
];
