//! A yielding branch and a dashpot whose strength follows a control input, for each input that a recording may have; and a spring in
//! the place of the branch.

use mesh_damper::effects::{CONTROLS, ControlInput, Yielding};
use mesh_damper::error::ConfigError;

use super::yielding::stretch_and_rate;
use super::{Element, Entry, Form, FormSpec, Input, Path, run_at};
use crate::shape::ShapePolicy;
use crate::shape::{Extent, Shape};
use crate::term::TermValue;

/// Number of starting values of the saturation of a control input. Convention: one below and one above the largest input.
const SATURATION_STARTS: usize = 2;

/// Number of starting values of the lag of a control input. Convention: each is some seven times the one before: a fit goes on from
/// there.
const LAG_STARTS: usize = 4;

/// Yield stretch in mm and rate in mm/s with which the branch is a spring: the ends of the crate's ranges.
const SPRING_BRANCH: [f64; 2] = [mesh_damper::limits::DISPLACEMENT, 1e-9];

/// With or without each of: a spring, a lag, a saturation.
const KINDS: usize = 8;

/// For each input a spring and a dashpot, and a branch that yields and a dashpot: immediate and proportional, delayed, with a strength
/// that saturates, and both.
pub const FORMS: [Form; KINDS * CONTROLS] = {
    const ALL: [[Form; CONTROLS]; KINDS] = [
        each::<true, false, false>(),
        each::<false, false, false>(),
        each::<true, true, false>(),
        each::<true, false, true>(),
        each::<true, true, true>(),
        each::<false, true, false>(),
        each::<false, false, true>(),
        each::<false, true, true>(),
    ];
    let mut all = [ALL[0][0]; KINDS * CONTROLS];
    let mut number = 0;
    while number < all.len() {
        all[number] = ALL[number % KINDS][number / KINDS];
        number += 1;
    }
    all
};

const fn each<const SPRING: bool, const LATE: bool, const BENT: bool>() -> [Form; CONTROLS] {
    [
        Form(&Controlled::<0, SPRING, LATE, BENT>::FORM),
        Form(&Controlled::<1, SPRING, LATE, BENT>::FORM),
        Form(&Controlled::<2, SPRING, LATE, BENT>::FORM),
        Form(&Controlled::<3, SPRING, LATE, BENT>::FORM),
    ]
}

/// Scaled by the input at `PLACE`, optionally with a spring in the place of the branch, delayed and saturating.
struct Controlled<const PLACE: usize, const SPRING: bool, const LATE: bool, const BENT: bool>;

impl<const PLACE: usize, const SPRING: bool, const LATE: bool, const BENT: bool>
    Controlled<PLACE, SPRING, LATE, BENT>
{
    const FORM: FormSpec = FormSpec {
        name: NAMES[SPRING as usize][2 * LATE as usize + BENT as usize][PLACE],
        family: "control_input",
        entry: Entry::Adds(2),
        shape_names: match (SPRING, LATE, BENT) {
            (false, false, false) => &["yield_stretch", "rate"],
            (false, true, false) => &["yield_stretch", "rate", "lag"],
            (false, false, true) => &["yield_stretch", "rate", "saturation"],
            (false, true, true) => &["yield_stretch", "rate", "lag", "saturation"],
            (true, false, false) => &[],
            (true, true, false) => &["lag"],
            (true, false, true) => &["saturation"],
            (true, true, true) => &["lag", "saturation"],
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
        let mut shapes = match SPRING {
            true => Vec::new(),
            false => stretch_and_rate(extent).to_vec(),
        };
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

    /// Yield stretch and rate, and the lag and the saturation if present.
    fn named(shapes: &[f64]) -> ([f64; 2], Option<f64>, Option<f64>) {
        let (branch, rest) = match SPRING {
            true => (SPRING_BRANCH, shapes),
            false => ([shapes[0], shapes[1]], &shapes[2..]),
        };
        let saturation = BENT.then(|| rest[usize::from(LATE)]);
        (branch, LATE.then(|| rest[0]), saturation)
    }

    fn unit_forces(shapes: &[f64], path: &Path) -> Result<Vec<Vec<f64>>, ConfigError> {
        let ([yield_stretch, rate], lag, saturation) = Self::named(shapes);
        let of = |stiffness: f64, viscosity: f64, tick: f64| {
            let branch = Yielding::new(stiffness, yield_stretch, rate, 0.0, tick)?;
            let mut effect = ControlInput::new(PLACE, branch, viscosity)?;
            if let Some(lag) = lag {
                effect = effect.with_lag(lag, tick)?;
            }
            match saturation {
                Some(saturation) => effect.with_saturation(saturation),
                None => Ok(effect),
            }
        };
        let sizes = [(1.0, 0.0), (0.0, 1.0)].into_iter();
        let each =
            sizes.map(|(stiffness, viscosity)| run_at(|tick| of(stiffness, viscosity, tick), path));
        each.collect()
    }

    fn elements(value: &TermValue) -> Vec<Element> {
        let ([yield_stretch, rate], lag, saturation) = Self::named(&value.shapes);
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
}

/// Without and with a spring, in the order of delay and saturation, and then of the places.
const NAMES: [[[&str; CONTROLS]; 4]; 2] = [
    [
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
    ],
    [
        [
            "controlled_spring",
            "controlled_spring_2",
            "controlled_spring_3",
            "controlled_spring_4",
        ],
        [
            "saturating_spring",
            "saturating_spring_2",
            "saturating_spring_3",
            "saturating_spring_4",
        ],
        [
            "late_spring",
            "late_spring_2",
            "late_spring_3",
            "late_spring_4",
        ],
        [
            "late_saturating_spring",
            "late_saturating_spring_2",
            "late_saturating_spring_3",
            "late_saturating_spring_4",
        ],
    ],
];
