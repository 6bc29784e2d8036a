//! Tables 4 and 5, and their ambiguities.

use serde::Serialize;

use super::material::MooneyRivlin;
use super::relaxation::Prony;

/// Table 4: density in g/cm³, then C10, C01 and C11 in MPa.
const TABLE_4: [[f64; 4]; 5] = [
    [2.0, 1.9, -0.5, 31.0],
    [2.5, 60.0, -54.0, 100.0],
    [3.0, 4.0, -0.1, 60.0],
    [3.5, 60.0, -54.0, 90.0],
    [4.0, 40.0, -14.0, 36.0],
];

/// Table 4, D1, the same for every density; printed under "MPa".
const D1: f64 = 0.35;

/// Table 5, read as fractions of the instantaneous shear modulus and seconds. The fractions add up to 0.9884, so 1.16 % of the
/// instantaneous stiffness remains. They cannot be fractions of a long-term modulus, which would make the instantaneous one 86
/// times Table 4's.
pub const TABLE_5: Prony = Prony {
    shares: [0.5548, 0.4336],
    times: [0.4, 0.2],
};

/// The interpretation of D1 = 0.35.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum VolumetricReading {
    /// Eq 8's D, in MPa as in Table 4: a bulk modulus of 0.7 MPa.
    Equation8,
    /// The program's incompressibility parameter, W = (J − 1)²/D1, in 1/MPa: a bulk modulus of 5.7 MPa.
    Incompressibility,
    /// Poisson's ratio in the undeformed state. With the other two readings, the ratio is negative at 2.5, 3.5 and 4.0 g/cm³.
    PoissonRatio,
}

/// The sign of C01, which Table 4 prints as negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SignReading {
    /// Negative: C01 makes the material softer.
    AsPrinted,
    /// Positive: the same values without their sign.
    Positive,
}

/// A reading of Table 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reading {
    /// The interpretation of D1.
    pub volumetric: VolumetricReading,
    /// The sign of C01.
    pub sign: SignReading,
}

impl VolumetricReading {
    /// In words for a reader.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Equation8 => "eq 8's D, MPa",
            Self::Incompressibility => "the program's D1, 1/MPa",
            Self::PoissonRatio => "Poisson's ratio",
        }
    }
}

impl SignReading {
    /// In words for a reader.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::AsPrinted => "as printed, negative",
            Self::Positive => "positive",
        }
    }
}

impl Reading {
    /// Every reading that is tried.
    pub const ALL: [Self; 6] = {
        use SignReading::{AsPrinted, Positive};
        use VolumetricReading::{Equation8, Incompressibility, PoissonRatio};
        [
            Self {
                volumetric: Equation8,
                sign: AsPrinted,
            },
            Self {
                volumetric: Incompressibility,
                sign: AsPrinted,
            },
            Self {
                volumetric: PoissonRatio,
                sign: AsPrinted,
            },
            Self {
                volumetric: Equation8,
                sign: Positive,
            },
            Self {
                volumetric: Incompressibility,
                sign: Positive,
            },
            Self {
                volumetric: PoissonRatio,
                sign: Positive,
            },
        ]
    };

    /// The material of `density` g/cm³; `None` for a density that is not in Table 4.
    pub fn material(self, density: f64) -> Option<MooneyRivlin> {
        let &[_, c10, c01, c11] = TABLE_4.iter().find(|row| row[0] == density)?;
        let c01 = match self.sign {
            SignReading::AsPrinted => c01,
            SignReading::Positive => c01.abs(),
        };
        let d = match self.volumetric {
            VolumetricReading::Equation8 => D1,
            VolumetricReading::Incompressibility => 1.0 / D1,
            VolumetricReading::PoissonRatio => {
                let shear = 2.0 * (c10 + c01);
                shear * (1.0 + D1) / (3.0 * (1.0 - 2.0 * D1))
            }
        };
        Some(MooneyRivlin { c10, c01, c11, d })
    }
}
