//! Smooth functions that a table may follow without a penalty: typical forces over displacement and velocity.
//!
//! A table that is only smooth knows little between two blocks of a test and nothing beyond them. A table that follows a few
//! products of a function of displacement and a function of speed knows more. Its cells then hold only the rest.

use mesh_damper::effects::residual_table::{CELLS, DISPLACEMENTS, NODES, part_of_speed};
use mesh_damper_model::correction::Remembered;

/// A function that a table may follow.
#[derive(Clone, Debug)]
pub(crate) struct Trend {
    /// Values in the cells.
    pub cells: Vec<(usize, f64)>,
    /// Its product form, if it has one.
    product: Option<Product>,
}

/// A function of displacement times a function of the table's other variable.
#[derive(Clone, Copy, Debug)]
struct Product {
    over: Over,
    /// Index into [`OVER_DISPLACEMENT`].
    displacement: usize,
    along: Along,
    /// Index into [`OVER_DIRECTION`].
    back: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Over {
    Displacement,
    /// Index into [`SIDES`].
    Side(usize),
}

#[derive(Clone, Copy, Debug)]
enum Along {
    /// The same everywhere.
    Nothing,
    Speed(fn(f64) -> f64),
    /// [`GROWING`] over this fraction of the largest speed.
    Growing(f64),
    /// Index into [`FADING`], over this fraction of the largest speed.
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
const OVER_SPEED: [fn(f64) -> f64; 3] = [f64::sqrt, |w| w, |w| w * w];

/// and of speed over a width: friction that grows from rest;
const GROWING: fn(f64) -> f64 = f64::tanh;
mesh_damper_recording::numbers! {
    /// The widths of the trends that a residual table may follow.
    TrendPolicy {
        /// Widths that are tried first for friction that grows from rest, as fractions of the largest speed.
        first_growing: [f64; 2] = [0.002, 0.006], Tuned("the blind trial");
        /// The smallest and the largest width of friction that grows from rest, as fractions of the largest speed.
        growing_widths: [f64; 2] = [5e-4, 0.05], Tuned("the blind trial");
        /// Widths that are tried first for friction that fades with speed, as fractions of the largest speed.
        first_fading: [f64; 3] = [0.03, 0.1, 0.3], Tuned("the blind trial");
        /// The smallest and the largest width of friction that fades with speed, as fractions of the largest speed.
        fading_widths: [f64; 2] = [0.01, 1.0], Tuned("the blind trial");
    }
}

/// friction that fades: the usual Stribeck curves (Armstrong-Hélouvry, Dupont and Canudas de Wit 1994),
const FADING: [fn(f64) -> f64; 4] = [
    |w| (-w).exp(),
    |w| (-w * w).exp(),
    |w| 1.0 / (1.0 + w),
    |w| 1.0 / (1.0 + w * w),
];
/// and those of them that a search begins with.
const FIRST_FADING: [usize; 2] = [0, 1];

/// Functions of the place of the quantity within its range, in place of speed: some grow from its lowest value, some are lost at
/// its middle.
const OVER_MEMORY: [fn(f64) -> f64; 5] = [
    |z| z,
    |z| z * z,
    |z| z - 0.5,
    |z| (z - 0.5).abs(),
    |z| (z - 0.5).powi(2),
];

/// Whether a force is the same or opposite on the way back.
const OVER_DIRECTION: [[f64; 2]; 2] = [[1.0, 1.0], [1.0, -1.0]];

/// The first cell of each side, forwards and back.
pub(super) const SIDES: [[usize; 2]; 2] = [[0, CELLS / 2], [NODES, CELLS / 2 + NODES]];

/// The variable of a table in addition to the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Displacement,
    /// Speed and direction.
    Velocity,
}

/// Every trend that eq 13 does not contain, or the trends that are not over a variable. A line over displacement has no trends: it
/// is for forces that resemble no trend.
pub(super) fn trends(of: Option<Remembered>, without: Option<Variable>) -> Vec<Trend> {
    match of {
        None => products(without, Over::Displacement, &over_speed()),
        Some(Remembered::Place) => Vec::new(),
        Some(Remembered::Sides { .. }) => {
            let sides = 0..SIDES.len();
            let sides = sides.map(|side| products(without, Over::Side(side), &over_speed()));
            sides.flatten().collect()
        }
        Some(_) => {
            let memories = OVER_MEMORY.map(Along::Memory).into_iter();
            let along: Vec<Along> = [Along::Nothing].into_iter().chain(memories).collect();
            products(without, Over::Displacement, &along)
        }
    }
}

fn over_speed() -> Vec<Along> {
    let powers = OVER_SPEED.map(Along::Speed);
    let growing = TrendPolicy::in_use().first_growing.map(Along::Growing);
    let fading = FIRST_FADING.into_iter().flat_map(|curve| {
        let widths = TrendPolicy::in_use().first_fading.into_iter();
        widths.map(move |width| Along::Fading(curve, width))
    });
    let all = [Along::Nothing].into_iter().chain(powers);
    all.chain(growing).chain(fading).collect()
}

fn products(without: Option<Variable>, over: Over, along: &[Along]) -> Vec<Trend> {
    let displacements = match over {
        // The displacement decides the side.
        Over::Side(_) => 1,
        Over::Displacement => OVER_DISPLACEMENT.len(),
    };
    let mut trends = Vec::new();
    for displacement in 0..displacements {
        for &along in along {
            for back in 0..OVER_DIRECTION.len() {
                let is_known = matches!(
                    (over, displacement, along, back),
                    // y and y³.
                    (Over::Displacement, 1 | 5, Along::Nothing, 0)
                );
                let is_allowed = match without {
                    None => true,
                    Some(Variable::Displacement) => displacement == 0 && over == Over::Displacement,
                    Some(Variable::Velocity) => {
                        back == 0 && matches!(along, Along::Nothing | Along::Memory(_))
                    }
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
    /// These values, without a product form.
    pub fn of(cells: Vec<(usize, f64)>) -> Self {
        Self {
            cells,
            product: None,
        }
    }

    /// Whether it is over the quantity in place of speed.
    pub fn is_over_memory(&self) -> bool {
        let product = self.product.as_ref();
        product.is_some_and(|product| match product.over {
            Over::Side(_) => true,
            Over::Displacement => matches!(product.along, Along::Memory(_)),
        })
    }

    /// The same function over a width that is `factor` times as small or as large, or with another kind of fading; empty without a
    /// width.
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
            for node in 0..NODES {
                let part = match self.along {
                    Along::Memory(_) => node as f64 / (NODES - 1) as f64,
                    _ => part_of_speed(node),
                };
                if let Over::Side(side) = self.over {
                    add(SIDES[side][way] + node, 1.0, part);
                    continue;
                }
                for place in 0..DISPLACEMENTS {
                    let u = 2.0 * place as f64 / (DISPLACEMENTS - 1) as f64 - 1.0;
                    add((way * NODES + node) * DISPLACEMENTS + place, u, part);
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
    /// Its value at a fraction of the largest speed, or of the range of the quantity in its place.
    fn at(self, part: f64) -> f64 {
        match self {
            Self::Nothing => 1.0,
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
            Self::Nothing | Self::Speed(_) | Self::Memory(_) => Vec::new(),
            Self::Growing(width) => scaled(width, TrendPolicy::in_use().growing_widths)
                .map(Self::Growing)
                .collect(),
            Self::Fading(curve, width) => {
                let widths = scaled(width, TrendPolicy::in_use().fading_widths);
                let widths = widths.map(|width| Self::Fading(curve, width));
                let curves = (0..FADING.len()).filter(|other| *other != curve);
                widths
                    .chain(curves.map(|other| Self::Fading(other, width)))
                    .collect()
            }
        }
    }
}
