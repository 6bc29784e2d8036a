//! Coefficients of the mixed damping law over mesh density and amplitude.
//!
//! The grid holds one [`Law`] for each pair of a density (g/cm³) and a cycle amplitude (mm). Between grid nodes each coefficient is
//! interpolated linearly in both directions. Outside the grid the coefficient is that of the nearest edge, and the result says so.

mod smoothed;

use core::fmt;

use crate::error::ConfigError;
use crate::law::Law;
use crate::real::in_range;

pub use smoothed::SMOOTHED;

/// Smallest and largest density of a node, g/cm³: from a loose roll to beyond solid steel.
pub const DENSITY_RANGE: (f64, f64) = (0.01, 20.0);
/// Smallest and largest amplitude of a node, mm.
pub const AMPLITUDE_RANGE: (f64, f64) = (1e-6, 1e4);

/// Tables 6–9 of the paper: 304 wire of 0.3 mm, crisscross angle 60°, ring of outer diameter 22 mm, inner diameter 12 mm,
/// height 15 mm, at 1 Hz. Amplitudes 0.05…0.25 mm, densities 2.0…4.0 g/cm³.
///
/// The last row of Table 7 is scattered over the page; from left to right it reads 9.4, 34.9, 4.7, 8.1, 18.5. The paper prints k3
/// in kN and c in kN·s/mm; they are in kN/mm³ and kN·(s/mm)^α.
pub static PAPER: Table<5, 5> = Table {
    densities: Nodes {
        values: [2.0, 2.5, 3.0, 3.5, 4.0],
        count: 5,
    },
    amplitudes: Nodes {
        values: [0.05, 0.10, 0.15, 0.20, 0.25],
        count: 5,
    },
    // One row per amplitude.
    cells: [
        [
            Law::from_valid(0.3365, 86.7, 0.0235, 0.4014),
            Law::from_valid(0.2235, 151.1, 0.0694, 0.5571),
            Law::from_valid(1.5273, 131.9, 0.1397, 0.4429),
            Law::from_valid(4.3051, 185.9, 0.1436, 0.4187),
            Law::from_valid(7.5503, 160.9, 0.1107, 0.2569),
        ],
        [
            Law::from_valid(0.2823, 24.2, 0.0409, 0.4441),
            Law::from_valid(0.3538, 105.4, 0.0899, 0.4797),
            Law::from_valid(1.0539, 10.5, 0.1114, 0.3969),
            Law::from_valid(2.5246, 125.6, 0.1359, 0.3370),
            Law::from_valid(8.3948, 180.5, 0.2937, 0.3279),
        ],
        [
            Law::from_valid(0.2957, 11.9, 0.0446, 0.3930),
            Law::from_valid(0.2490, 54.0, 0.1339, 0.4461),
            Law::from_valid(0.7007, 10.1, 0.1252, 0.3820),
            Law::from_valid(2.1466, 46.5, 0.1452, 0.3516),
            Law::from_valid(8.8699, 5.2, 0.4147, 0.2053),
        ],
        [
            Law::from_valid(0.4368, 11.2, 0.0657, 0.3736),
            Law::from_valid(0.5272, 39.6, 0.1657, 0.4304),
            Law::from_valid(0.5333, 7.4, 0.1219, 0.3869),
            Law::from_valid(1.7452, 21.5, 0.1320, 0.3143),
            Law::from_valid(8.9133, 15.7, 0.5329, 0.1806),
        ],
        [
            Law::from_valid(0.6376, 9.4, 0.0899, 0.3724),
            Law::from_valid(0.9585, 34.9, 0.2247, 0.2722),
            Law::from_valid(0.4655, 4.7, 0.1263, 0.3941),
            Law::from_valid(1.2470, 8.1, 0.1280, 0.2484),
            Law::from_valid(9.3548, 18.5, 0.6592, 0.1581),
        ],
    ],
};

/// Position of a value relative to the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Placement {
    /// Below the first node, or NaN: the first node's coefficients are used.
    Below,
    /// Between the first node and the last, both included.
    Inside,
    /// Above the last node: the last node's coefficients are used.
    Above,
}

/// The law at one density and amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// The interpolated law, or that of the nearest edge.
    pub law: Law<f32>,
    /// Position of the density.
    pub density: Placement,
    /// Position of the amplitude.
    pub amplitude: Placement,
}

impl Lookup {
    /// Whether density or amplitude lie outside the grid, so that the law is that of the nearest edge.
    pub fn clamped(&self) -> bool {
        self.density != Placement::Inside || self.amplitude != Placement::Inside
    }
}

/// Up to `N` increasing nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Nodes<const N: usize> {
    values: [f32; N],
    count: usize,
}

/// Two neighbouring nodes, and the position between them as a part of their distance.
struct Between {
    lower: usize,
    upper: usize,
    part: f32,
    placement: Placement,
}

impl<const N: usize> Nodes<N> {
    fn new(
        field: &'static str,
        nodes: &[f64],
        (low, high): (f64, f64),
    ) -> Result<Self, ConfigError> {
        if nodes.is_empty() {
            return Err(ConfigError::Empty(field));
        }
        if nodes.len() > N {
            return Err(ConfigError::Full { field, capacity: N });
        }
        let mut values = [0.0; N];
        let mut last = 0.0;
        for (value, &node) in values.iter_mut().zip(nodes) {
            *value = in_range(field, node, low, high)? as f32;
            if *value <= last {
                return Err(ConfigError::NotIncreasing(field));
            }
            last = *value;
        }
        Ok(Self {
            values,
            count: nodes.len(),
        })
    }

    fn used(&self) -> impl Iterator<Item = f32> + '_ {
        self.values.iter().take(self.count).copied()
    }

    fn locate(&self, value: f32) -> Between {
        let (mut lower, mut upper) = (0, 0);
        let (mut below, mut above) = (0.0, 0.0);
        for (index, node) in self.used().enumerate() {
            if index == 0 || value >= node {
                (lower, below) = (index, node);
            }
            (upper, above) = (index, node);
            if node > value {
                break;
            }
        }
        let placement = if value > above {
            Placement::Above
        } else if value >= below {
            Placement::Inside
        } else {
            Placement::Below
        };
        let part = match placement {
            Placement::Inside if above > below => (value - below) / (above - below),
            _ => 0.0,
        };
        Between {
            lower,
            upper,
            part,
            placement,
        }
    }
}

/// A grid of laws over at most `D` densities and `A` amplitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<const D: usize, const A: usize> {
    densities: Nodes<D>,
    amplitudes: Nodes<A>,
    cells: [[Law<f32>; D]; A],
}

impl<const D: usize, const A: usize> Table<D, A> {
    /// The law at `density` g/cm³ and cycle `amplitude` mm.
    pub fn lookup(&self, density: f32, amplitude: f32) -> Lookup {
        let d = self.densities.locate(density);
        let a = self.amplitudes.locate(amplitude);
        let row = |index| between(self.cell(d.lower, index), self.cell(d.upper, index), d.part);
        Lookup {
            law: between(row(a.lower), row(a.upper), a.part),
            density: d.placement,
            amplitude: a.placement,
        }
    }

    /// The densities of the nodes, g/cm³.
    pub fn densities(&self) -> impl Iterator<Item = f32> + '_ {
        self.densities.used()
    }

    /// The amplitudes of the nodes, mm.
    pub fn amplitudes(&self) -> impl Iterator<Item = f32> + '_ {
        self.amplitudes.used()
    }

    fn cell(&self, density: usize, amplitude: usize) -> Law<f32> {
        match self.cells.get(amplitude).and_then(|row| row.get(density)) {
            Some(law) => *law,
            None => NO_FORCE,
        }
    }
}

const NO_FORCE: Law<f32> = Law::from_valid(0.0, 0.0, 0.0, 0.0);

/// Interpolates every coefficient at `part` (0…1) between `a` and `b`, which leaves each in its range.
fn between(a: Law<f32>, b: Law<f32>, part: f32) -> Law<f32> {
    let mix = |a: f32, b: f32| a + (b - a) * part;
    Law::from_valid(
        mix(a.k1(), b.k1()),
        mix(a.k3(), b.k3()),
        mix(a.c(), b.c()),
        mix(a.alpha(), b.alpha()),
    )
}

/// A grid that was rejected.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum TableError {
    /// The nodes: `densities` or `amplitudes`.
    Nodes(ConfigError),
    /// A coefficient of a cell.
    Cell {
        /// Index of the cell's density.
        density: usize,
        /// Index of the cell's amplitude.
        amplitude: usize,
        /// The coefficient and its error.
        error: ConfigError,
    },
    /// The grid has no such cell.
    NoSuchCell {
        /// Index of the density.
        density: usize,
        /// Index of the amplitude.
        amplitude: usize,
    },
    /// The cell was given twice.
    Twice {
        /// Index of the cell's density.
        density: usize,
        /// Index of the cell's amplitude.
        amplitude: usize,
    },
    /// The cell was not given.
    Missing {
        /// Index of the cell's density.
        density: usize,
        /// Index of the cell's amplitude.
        amplitude: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nodes(error) => error.fmt(f),
            Self::Cell {
                density,
                amplitude,
                error,
            } => write!(
                f,
                "cell of density {density} and amplitude {amplitude}: {error}"
            ),
            Self::NoSuchCell { density, amplitude } => {
                write!(
                    f,
                    "no cell of density {density} and amplitude {amplitude} in the grid"
                )
            }
            Self::Twice { density, amplitude } => {
                write!(
                    f,
                    "cell of density {density} and amplitude {amplitude} is given twice"
                )
            }
            Self::Missing { density, amplitude } => {
                write!(
                    f,
                    "cell of density {density} and amplitude {amplitude} is not given"
                )
            }
        }
    }
}

impl core::error::Error for TableError {}

/// Builds a [`Table`] from nodes and cells.
#[derive(Clone, Debug)]
pub struct TableBuilder<const D: usize, const A: usize> {
    table: Table<D, A>,
    given: [[bool; D]; A],
}

impl<const D: usize, const A: usize> TableBuilder<D, A> {
    /// A grid without cells.
    ///
    /// * `densities`: g/cm³, 1 to `D` of them, strictly increasing within [`DENSITY_RANGE`]
    /// * `amplitudes`: mm, 1 to `A` of them, strictly increasing within [`AMPLITUDE_RANGE`]
    ///
    /// # Errors
    /// [`TableError::Nodes`], naming `densities` or `amplitudes`. Nodes that are equal in f32 do not increase.
    pub fn new(densities: &[f64], amplitudes: &[f64]) -> Result<Self, TableError> {
        Ok(Self {
            table: Table {
                densities: Nodes::new("densities", densities, DENSITY_RANGE)
                    .map_err(TableError::Nodes)?,
                amplitudes: Nodes::new("amplitudes", amplitudes, AMPLITUDE_RANGE)
                    .map_err(TableError::Nodes)?,
                cells: [[NO_FORCE; D]; A],
            },
            given: [[false; D]; A],
        })
    }

    /// Sets the coefficients `[k1, k3, c, alpha]` of the cell at these indices, with the units and ranges of [`Law::new`].
    ///
    /// # Errors
    /// [`TableError::Cell`] with the coefficient's name, [`TableError::NoSuchCell`], [`TableError::Twice`].
    pub fn cell(
        mut self,
        density: usize,
        amplitude: usize,
        coefficients: [f64; 4],
    ) -> Result<Self, TableError> {
        let [k1, k3, c, alpha] = coefficients;
        let law = Law::new(k1, k3, c, alpha).map_err(|error| TableError::Cell {
            density,
            amplitude,
            error,
        })?;
        let inside =
            density < self.table.densities.count && amplitude < self.table.amplitudes.count;
        let cell = self
            .table
            .cells
            .get_mut(amplitude)
            .and_then(|row| row.get_mut(density));
        let given = self
            .given
            .get_mut(amplitude)
            .and_then(|row| row.get_mut(density));
        match (cell, given) {
            (Some(_), Some(true)) => Err(TableError::Twice { density, amplitude }),
            (Some(cell), Some(given)) if inside => {
                *cell = law.cast();
                *given = true;
                Ok(self)
            }
            _ => Err(TableError::NoSuchCell { density, amplitude }),
        }
    }

    /// Returns the table, once every cell is set.
    ///
    /// # Errors
    /// [`TableError::Missing`] with the first missing cell.
    pub fn build(self) -> Result<Table<D, A>, TableError> {
        for (amplitude, row) in self
            .given
            .iter()
            .enumerate()
            .take(self.table.amplitudes.count)
        {
            for (density, given) in row.iter().enumerate().take(self.table.densities.count) {
                if !given {
                    return Err(TableError::Missing { density, amplitude });
                }
            }
        }
        Ok(self.table)
    }
}
