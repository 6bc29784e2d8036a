//! Smooth courses that the tables may follow at no cost: what a force over displacement and velocity mostly is.
//!
//! A table that is only asked to be smooth knows little between two blocks of a test and nothing beyond them. One that
//! follows a few products of a function of displacement and one of speed does, and the table proper is left with the rest.

use mesh_damper::effects::correction::{
    CELLS, DISPLACEMENTS, MEMORIES, MEMORY_CELLS, SPEEDS, part_of_speed,
};

use crate::correction::Remembered;

/// What the tables may follow.
#[derive(Clone, Debug)]
pub(crate) struct Trend {
    /// Values in the cells of T, and in those of U after them.
    pub cells: Vec<(usize, f64)>,
    /// What it is, if it is a course.
    product: Option<Product>,
}

/// A function of displacement times one of what the table is over beside it.
#[derive(Clone, Copy, Debug)]
struct Product {
    over: Over,
    /// Which [`OVER_DISPLACEMENT`].
    displacement: usize,
    along: Along,
    /// Which [`OVER_DIRECTION`].
    back: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Over {
    Table,
    Memory,
    /// Which [`SIDES`].
    Side(usize),
}

#[derive(Clone, Copy, Debug)]
enum Along {
    Speed(fn(f64) -> f64),
    /// [`GROWING`] over this part of the largest speed.
    Growing(f64),
    /// Which [`FADING`], over this part of the largest speed.
    Fading(usize, f64),
    Memory(fn(f64) -> f64),
}

/// Functions of displacement over its largest value.
const OVER_DISPLACEMENT: [fn(f64) -> f64; 6] = [
    |_| 1.0,
    |u| u,
    f64::abs,
    |u| u * u,
    |u| u * u.abs(),
    |u| u * u * u,
];

/// Functions of speed over its largest value,
const OVER_SPEED: [fn(f64) -> f64; 4] = [|_| 1.0, f64::sqrt, |w| w, |w| w * w];

/// and of speed over a width: friction that grows from rest,
const GROWING: fn(f64) -> f64 = f64::tanh;
/// the widths to begin with, of the largest speed,
const FIRST_GROWING: [f64; 2] = [0.002, 0.006];
/// and their range;
const GROWING_WIDTHS: [f64; 2] = [5e-4, 0.05];
/// friction that fades: the curves that are in use for Stribeck's (Armstrong-Hélouvry, Dupont and Canudas de Wit 1994),
const FADING: [fn(f64) -> f64; 4] = [
    |w| (-w).exp(),
    |w| (-w * w).exp(),
    |w| 1.0 / (1.0 + w),
    |w| 1.0 / (1.0 + w * w),
];
/// which to begin with over which widths,
const FIRST_FADING: [(usize, f64); 6] =
    [(0, 0.03), (0, 0.1), (0, 0.3), (1, 0.03), (1, 0.1), (1, 0.3)];
/// and their range.
const FADING_WIDTHS: [f64; 2] = [0.01, 1.0];

/// Functions of where z stands in its range: some of what grows from its least value, some of what is lost at its middle.
const OVER_MEMORY: [fn(f64) -> f64; 5] = [
    |z| z,
    |z| z * z,
    |z| z - 0.5,
    |z| (z - 0.5).abs(),
    |z| (z - 0.5).powi(2),
];

/// Whether a force is the same or the opposite on the way back.
const OVER_DIRECTION: [[f64; 2]; 2] = [[1.0, 1.0], [1.0, -1.0]];

/// The first cell of each side that U may have, forwards and back.
pub(super) const SIDES: [[usize; 2]; 2] = [
    [CELLS, CELLS + MEMORY_CELLS / 2],
    [CELLS + SPEEDS, CELLS + MEMORY_CELLS / 2 + SPEEDS],
];

/// What tables may be over beside what is remembered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Displacement,
    /// Speed and direction.
    Velocity,
}

/// Every trend of T that eq 13 has not, or those that are not over a variable.
pub(super) fn of_table(without: Option<Variable>) -> Vec<Trend> {
    products(without, Over::Table, &over_speed())
}

/// The same of U; none where it is a line over displacement, which is for what no trend is like.
pub(super) fn of_memory(of: Remembered, without: Option<Variable>) -> Vec<Trend> {
    match of {
        Remembered::Place => Vec::new(),
        Remembered::Sides { .. } => {
            let sides = 0..SIDES.len();
            let sides = sides.map(|side| products(without, Over::Side(side), &over_speed()));
            sides.flatten().collect()
        }
        _ => products(without, Over::Memory, &OVER_MEMORY.map(Along::Memory)),
    }
}

fn over_speed() -> Vec<Along> {
    let growing = FIRST_GROWING.map(Along::Growing);
    let fading = FIRST_FADING.map(|(curve, width)| Along::Fading(curve, width));
    let powers = OVER_SPEED.map(Along::Speed).into_iter();
    powers.chain(growing).chain(fading).collect()
}

fn products(without: Option<Variable>, over: Over, along: &[Along]) -> Vec<Trend> {
    let displacements = match over {
        // Which side it is is the displacement.
        Over::Side(_) => 1,
        _ => OVER_DISPLACEMENT.len(),
    };
    let mut trends = Vec::new();
    for displacement in 0..displacements {
        for (j, &along) in along.iter().enumerate() {
            for back in 0..OVER_DIRECTION.len() {
                // y and y³ are in eq 13.
                let is_known =
                    over == Over::Table && j + back == 0 && matches!(displacement, 1 | 5);
                let is_allowed = match without {
                    None => true,
                    Some(Variable::Displacement) => {
                        displacement == 0 && !matches!(over, Over::Side(_))
                    }
                    Some(Variable::Velocity) => back == 0 && (j == 0 || over == Over::Memory),
                };
                if !is_known && is_allowed {
                    let product = Product {
                        over,
                        displacement,
                        along,
                        back,
                    };
                    trends.push(product.trend());
                }
            }
        }
    }
    trends
}

impl Trend {
    /// These values, which are no course.
    pub fn of(cells: Vec<(usize, f64)>) -> Self {
        Self {
            cells,
            product: None,
        }
    }

    /// The same over a width that is `factor` times as small or as large, or fading in another way; none without a width.
    pub fn near(&self, factor: f64) -> Vec<Self> {
        let Some(product) = self.product else {
            return Vec::new();
        };
        let others = product.along.near(factor).into_iter();
        let others = others.map(|along| Product { along, ..product });
        others.map(Product::trend).collect()
    }
}

impl Product {
    fn trend(self) -> Trend {
        let mut cells = Vec::new();
        for (way, sign) in OVER_DIRECTION[self.back].iter().enumerate() {
            let mut add = |cell: usize, u: f64, part: f64| {
                let value = sign * OVER_DISPLACEMENT[self.displacement](u) * self.along.at(part);
                cells.push((cell, value));
            };
            let (first, nodes) = match self.over {
                Over::Table => (0, SPEEDS),
                Over::Memory => (CELLS, MEMORIES),
                Over::Side(side) => {
                    for node in 0..SPEEDS {
                        add(SIDES[side][way] + node, 1.0, part_of_speed(node));
                    }
                    continue;
                }
            };
            for node in 0..nodes {
                let part = match self.over {
                    Over::Memory => node as f64 / (MEMORIES - 1) as f64,
                    _ => part_of_speed(node),
                };
                for place in 0..DISPLACEMENTS {
                    let u = 2.0 * place as f64 / (DISPLACEMENTS - 1) as f64 - 1.0;
                    let row = way * nodes + node;
                    add(first + row * DISPLACEMENTS + place, u, part);
                }
            }
        }
        Trend {
            cells,
            product: Some(self),
        }
    }
}

impl Along {
    /// At a part of the largest speed, or of z's range.
    fn at(self, part: f64) -> f64 {
        match self {
            Self::Speed(function) | Self::Memory(function) => function(part),
            Self::Growing(width) => GROWING(part / width),
            Self::Fading(curve, width) => FADING[curve](part / width),
        }
    }

    fn near(self, factor: f64) -> Vec<Self> {
        let scaled = |width: f64, [least, most]: [f64; 2]| {
            let widths = [width / factor, width * factor].into_iter();
            widths.filter(move |width| (least..=most).contains(width))
        };
        match self {
            Self::Speed(_) | Self::Memory(_) => Vec::new(),
            Self::Growing(width) => scaled(width, GROWING_WIDTHS).map(Self::Growing).collect(),
            Self::Fading(curve, width) => {
                let widths = scaled(width, FADING_WIDTHS);
                let widths = widths.map(|width| Self::Fading(curve, width));
                let curves = (0..FADING.len()).filter(|other| *other != curve);
                widths
                    .chain(curves.map(|other| Self::Fading(other, width)))
                    .collect()
            }
        }
    }
}
