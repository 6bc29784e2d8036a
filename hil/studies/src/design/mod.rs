//! The reverse use: which density, in cycles of which amplitude, gives a stiffness and a loss factor.
//!
//! ```
//! use mesh_damper_studies::design::{Wanted, design};
//!
//! let design = design(&Wanted::new(4.0, 0.3)?)?;
//! for solution in &design.solutions {
//!     println!("{} g/cm³ at {} mm", solution.point.density, solution.point.amplitude);
//! }
//! # Ok::<(), mesh_damper_studies::design::DesignError>(())
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

/// What is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Wanted {
    /// Dynamic stiffness K*, kN/mm, above 0.
    pub stiffness: f64,
    /// Dynamic loss factor η*, above 0.
    pub loss_factor: f64,
    /// Of the excitation, Hz. The tables are of 1 Hz; elsewhere they are extrapolated by |v|^α.
    pub frequency: f64,
    /// The amplitudes that may be chosen from, mm; a single one when both are equal.
    pub amplitudes: (f64, f64),
    /// By what part of each figure a solution may miss it.
    pub tolerance: f64,
    /// Of the specimens that are chosen from.
    pub law: Source,
}

/// A field of [`Wanted`] that cannot be, or a rig that could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// The field, its value and its range.
    #[error("{value} is outside {low}…{high}")]
    OutOfRange {
        /// The field's name.
        field: &'static str,
        /// What it was.
        value: f64,
        /// The least that it may be.
        low: f64,
        /// The most.
        high: f64,
    },
    /// Amplitudes that fall.
    #[error("{0} mm is above {1} mm")]
    Amplitudes(f64, f64),
    /// The rig.
    #[error(transparent)]
    Rig(#[from] SetupError),
    /// The rig stopped on a limit.
    #[error("the rig tripped after {time:.2} s: {fault:?}")]
    Stopped {
        /// s since the start.
        time: f64,
        /// Why.
        fault: TripCause,
    },
}

impl Wanted {
    /// At 1 Hz, within 5 %, at any amplitude of the tables, by the tables.
    ///
    /// # Errors
    /// What is not positive.
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

/// A specimen and the cycle that it is in, with what it has there by eq 13.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Point {
    /// g/cm³
    pub density: f64,
    /// mm
    pub amplitude: f64,
    /// K, kN/mm.
    pub stiffness: f64,
    /// η, the loss factor.
    pub loss_factor: f64,
}

/// How far a solution has what is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Meets {
    /// Both figures, exactly.
    Both,
    /// Both within the tolerance: a near miss.
    WithinTolerance,
}

/// A density and amplitude that give what is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Solution {
    /// Where both figures are met, or, where they can be met within the tolerance only, are nearest.
    pub point: Point,
    /// Which of the two.
    pub meets: Meets,
    /// What the other set of coefficients gives there, by samples and eqs 3–7: nothing of it was used to find the point.
    pub by_other_law: Figures,
    /// The amplitudes about it at which this density keeps both within the tolerance, mm.
    pub amplitudes: (f64, f64),
}

/// What densities and amplitudes can give at all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reachable {
    /// Least and largest K, kN/mm.
    pub stiffness: (f64, f64),
    /// Least and largest η.
    pub loss_factor: (f64, f64),
    /// Least and largest η where K is the one wanted; `None` where it is nowhere.
    pub loss_factor_at_stiffness: Option<(f64, f64)>,
    /// Least and largest K where η is the one wanted, kN/mm.
    pub stiffness_at_loss_factor: Option<(f64, f64)>,
    /// Where K and η are nearest to those wanted, by the logarithms of their ratios.
    pub nearest: Point,
}

/// What a search came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Design {
    /// What was asked.
    pub wanted: Wanted,
    /// Every solution, by density; empty where none is within the tolerance.
    pub solutions: Vec<Solution>,
    /// What can be had.
    pub reachable: Reachable,
}

/// Every density of 2…4 g/cm³, with the amplitude where that is free, that gives what is wanted.
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
