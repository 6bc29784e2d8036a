//! The paper's other method: finite elements, eqs 8–12, with which it compares the law.
//!
//! A ring of linear hexahedra (`element`) of Mooney–Rivlin material (`material`) with relaxing shear (`relaxation`) is bonded to a
//! rigid fixture, which moves it across a rigid, frictionless mandrel (`ring`, `contact`). Strains are finite and relative to the
//! undeformed ring (total Lagrange): 0.5 mm is a tenth of the wall. There the ring is half as stiff again as at first, which a
//! linear model would miss.
//!
//! # Gaps in the paper
//!
//! - D1 = 0.35, printed under "MPa", and eq 8's D ([`VolumetricReading`]). The program that the paper used asks for an
//!   incompressibility parameter D1 with W = (J − 1)²/D1, and [`RingModel::new`] uses that.
//! - The signs of C01 ([`SignReading`]). With positive ones, the densities 2.5 and 3.5 g/cm³ become the stiffest of all.
//! - Eq 10 leaves out C11, which Table 4 has; here it counts. Its **b** is a tensor of second order, not of fourth.
//! - Whether the stiffnesses of Table 4 are the instantaneous or the long-term ones ([`TABLE_5`]): only the instantaneous ones are
//!   possible.
//! - The cycle of the sine that its loops show. With a bore that leaves its mandrel, nearly half of the stiffness is lost from the
//!   first cycle to the third, as [`Bore`] explains.
//!
//! # Errors
//!
//! | of | in the ring's force |
//! |---|---|
//! | the mesh of [`RingModel::new`] | 1 % (1.6 % bonded) |
//! | the mandrel's finite stiffness | 0.3 % |
//! | 64 steps a cycle | 0.1 % |

mod body;
mod contact;
mod drive;
mod element;
mod equations;
mod material;
mod mesh;
mod published;
mod relaxation;
mod ring;
#[cfg(test)]
mod tests;

pub use drive::{ForceLoop, StaticCurve};
pub use material::MooneyRivlin;
pub use published::{Reading, SignReading, TABLE_5, VolumetricReading};
pub use relaxation::Prony;
pub use ring::{Bore, Divisions, RingModel};

/// The reason why a model gives no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FiniteElementError {
    /// Table 4 does not have this density, g/cm³.
    #[error("the paper gives no constants at {0} g/cm³")]
    NoConstants(f64),
    /// An element turned inside out.
    #[error("an element turned inside out")]
    Inverted,
    /// The tangent is not positive definite.
    #[error("the ring is unstable there: its stiffness is not positive definite")]
    Unstable,
    /// No equilibrium after the most Newton steps.
    #[error("no equilibrium was found")]
    NotConverged,
    /// The loop still changes after the most cycles.
    #[error("the loop did not become steady")]
    NotSteady,
    /// The equations do not fit into memory.
    #[error("the mesh is too fine for this machine's memory")]
    TooLarge,
}
