//! The inverse problem: the density, and the amplitude of the cycles, for a required stiffness and loss factor.
//!
//! ```
//! use mesh_damper_paper::design::{Wanted, design};
//!
//! let design = design(&Wanted::new(4.0, 0.3)?)?;
//! for solution in &design.solutions {
//!     println!("{} g/cm³ at {} mm", solution.point.density, solution.point.amplitude);
//! }
//! # Ok::<(), mesh_damper_paper::design::DesignError>(())
//! ```

mod figures;
mod newton;
mod regions;
mod rig;
mod search;
mod source;

pub use figures::Figures;
pub use rig::{OnRig, on_rig};
pub use source::Source;

use mesh_damper::rig::TripCause;
use mesh_damper_reference::tables::AMPLITUDES;
use mesh_damper_rig::SetupError;
use serde::Serialize;

use search::{Search, amplitudes_about};

/// The requirements of a design.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Wanted {
    /// Dynamic stiffness K*, kN/mm, above 0.
    pub stiffness: f64,
    /// Dynamic loss factor η*, above 0.
    pub loss_factor: f64,
    /// Frequency of the excitation, Hz. The tables are for 1 Hz; elsewhere they are extrapolated by |v|^α.
    pub frequency: f64,
    /// Smallest and largest permitted amplitude, mm; equal for a single amplitude.
    pub amplitudes: (f64, f64),
    /// Largest miss of each figure in a solution, as a fraction of the required value.
    pub tolerance: f64,
    /// The source of the specimens' coefficients.
    pub law: Source,
}

/// An impossible field of [`Wanted`], or a rig that could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// The field, its value and its range.
    #[error("{value} is outside {low}…{high}")]
    OutOfRange {
        /// The field's name.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Its lower limit.
        low: f64,
        /// Its upper limit.
        high: f64,
    },
    /// Decreasing amplitudes.
    #[error("{0} mm is above {1} mm")]
    Amplitudes(f64, f64),
    /// The rig.
    #[error(transparent)]
    Rig(#[from] SetupError),
    /// The rig stopped at a limit.
    #[error("the rig tripped after {time:.2} s: {fault:?}")]
    Stopped {
        /// s since the start.
        time: f64,
        /// The reason.
        fault: TripCause,
    },
}

impl Wanted {
    /// At 1 Hz, within 5 %, at any amplitude of the tables, with the tables' coefficients.
    ///
    /// # Errors
    /// A value is not positive.
    pub fn new(stiffness: f64, loss_factor: f64) -> Result<Self, DesignError> {
        let wanted = Self {
            stiffness,
            loss_factor,
            frequency: 1.0,
            amplitudes: (AMPLITUDES[0], AMPLITUDES[4]),
            tolerance: 0.05,
            law: Source::Tables,
        };
        wanted.check()?;
        Ok(wanted)
    }

    fn check(&self) -> Result<(), DesignError> {
        let of_tables = (AMPLITUDES[0], AMPLITUDES[4]);
        for (field, value, (low, high)) in [
            ("stiffness", self.stiffness, (1e-6, 1e6)),
            ("loss-factor", self.loss_factor, (1e-6, 1e3)),
            ("frequency", self.frequency, (0.1, 100.0)),
            ("tolerance", self.tolerance, (1e-6, 0.5)),
            ("amplitude", self.amplitudes.0, of_tables),
            ("amplitude", self.amplitudes.1, of_tables),
        ] {
            if !(low..=high).contains(&value) {
                return Err(DesignError::OutOfRange {
                    field,
                    value,
                    low,
                    high,
                });
            }
        }
        if self.amplitudes.0 > self.amplitudes.1 {
            return Err(DesignError::Amplitudes(
                self.amplitudes.0,
                self.amplitudes.1,
            ));
        }
        Ok(())
    }
}

/// A specimen and its cycle, with their figures from eq 13.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Point {
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// Dynamic stiffness K, kN/mm.
    pub stiffness: f64,
    /// Loss factor η.
    pub loss_factor: f64,
}

/// How well a solution meets the requirements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Meets {
    /// Both figures are met exactly.
    Both,
    /// Both figures are within the tolerance: a near miss.
    WithinTolerance,
}

/// A density and amplitude that meet the requirements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Solution {
    /// The point at which both figures are met. If they are met only within the tolerance, the nearest point.
    pub point: Point,
    /// How well the point meets the requirements.
    pub meets: Meets,
    /// The figures at this point from the other set of coefficients, computed from samples and eqs 3–7. This set had no part in the
    /// search.
    pub by_other_law: Figures,
    /// Smallest and largest amplitude around the point at which this density keeps both figures within the tolerance, mm.
    pub amplitudes: (f64, f64),
}

/// The figures that the available densities and amplitudes can reach.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reachable {
    /// Smallest and largest K, kN/mm.
    pub stiffness: (f64, f64),
    /// Smallest and largest η.
    pub loss_factor: (f64, f64),
    /// Smallest and largest η at the required K; null if no point has it.
    pub loss_factor_at_stiffness: Option<(f64, f64)>,
    /// Smallest and largest K at the required η, kN/mm; null if no point has it.
    pub stiffness_at_loss_factor: Option<(f64, f64)>,
    /// The point at which K and η are nearest to the required values, by the logarithms of their ratios.
    pub nearest: Point,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Design {
    /// The requirements.
    pub wanted: Wanted,
    /// All solutions, by density; empty if no point is within the tolerance.
    pub solutions: Vec<Solution>,
    /// The figures that can be reached.
    pub reachable: Reachable,
}

/// Every density of 2…4 g/cm³, with the amplitude if that is free, that meets the requirements.
///
/// # Errors
/// The field of `wanted` that is out of range.
///
/// # Panics
/// Never: every amplitude of the tables is a motion.
pub fn design(wanted: &Wanted) -> Result<Design, DesignError> {
    wanted.check()?;
    let search = Search::new(wanted);
    let other = |point: &Point| {
        wanted
            .law
            .other()
            .coefficients(point.density, point.amplitude)
    };
    let solution = |(point, meets): (Point, Meets)| Solution {
        by_other_law: Figures::of_samples(&other(&point), point.amplitude, wanted.frequency)
            .expect("a cycle with motion"),
        amplitudes: amplitudes_about(wanted, &point),
        point,
        meets,
    };
    Ok(Design {
        wanted: *wanted,
        solutions: search.solutions().into_iter().map(solution).collect(),
        reachable: search.reachable(),
    })
}
