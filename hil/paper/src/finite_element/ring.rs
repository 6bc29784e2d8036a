//! The ring on its mandrel, as in the paper's Figure 4.

use nalgebra::Vector3;
use serde::Serialize;

use super::FiniteElementError;
use super::body::Body;
use super::contact::Mandrel;
use super::drive::{Drive, DrivenSine, ForceLoop, StaticCurve};
use super::material::MooneyRivlin;
use super::mesh::Mesh;
use super::published::{Reading, SignReading, TABLE_5, VolumetricReading};

/// Radius of the bore and of the mandrel, mm.
const INNER_RADIUS: f64 = 6.0;

/// Radius of the outer surface, mm.
const OUTER_RADIUS: f64 = 11.0;

/// Half the height, mm.
const HALF_HEIGHT: f64 = 7.5;

/// Nodes within this distance of a surface, mm, are on it.
const ON_SURFACE: f64 = 1e-9;

/// The mandrel's pressure over depth as a multiple of the wall's: of the material's modulus over its thickness. The penetration of
/// the nodes then changes the force by 0.3 %.
const MANDREL_STIFFNESS: f64 = 1000.0;

/// The contact between bore and mandrel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Bore {
    /// Frictionless, and free to leave the mandrel, as in the paper. Only the motion presses the bore on, and 1.16 % of the
    /// instantaneous stiffness remains, so the bore creeps away from the mandrel over about twenty cycles, until it hardly touches
    /// it. Such a loop belongs to one cycle counted from rest. It is never the steady loop of a test.
    Separable,
    /// Frictionless, and never off the mandrel, as if the ring were pressed on to it. This simplification has a steady loop.
    Gliding,
    /// Bonded to it.
    Bonded,
}

/// The fineness of the mesh of a quarter of the ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Divisions {
    /// Elements around half of the circumference, ≥ 1.
    pub around: usize,
    /// Elements through the wall, ≥ 1.
    pub through: usize,
    /// Elements along half of the height, ≥ 1.
    pub along: usize,
}

impl Divisions {
    /// `n` through the wall, and as many around and along as give elements with similar edges.
    pub const fn through_wall(n: usize) -> Self {
        Self {
            around: 4 * n,
            through: n,
            along: n,
        }
    }
}

/// A finite-element model of the ring: a rigid fixture, bonded to the outer surface, moves it across a rigid mandrel.
///
/// By symmetry, a quarter represents the whole: half of the circumference and half of the height. Inertia is neglected: at 1 Hz it
/// is a ten-thousandth of a newton.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RingModel {
    /// Density, g/cm³, one of those in Table 4.
    pub density: f64,
    /// The reading of Table 4.
    pub reading: Reading,
    /// The mesh of the quarter.
    pub divisions: Divisions,
    /// The contact between bore and mandrel.
    pub bore: Bore,
    /// Number of time steps in a cycle, ≥ 4.
    pub steps: usize,
}

impl RingModel {
    /// The model of `density` g/cm³ that corresponds to the paper's: the module explains these readings and this mesh.
    pub fn new(density: f64) -> Self {
        Self {
            density,
            reading: Reading {
                volumetric: VolumetricReading::Incompressibility,
                sign: SignReading::AsPrinted,
            },
            divisions: Divisions::through_wall(3),
            bore: Bore::Separable,
            steps: 64,
        }
    }

    /// The force of a sudden compression to `largest` mm in `points` equal steps, from Table 4 alone, without relaxation.
    ///
    /// # Errors
    /// The density is not in Table 4, or no equilibrium is found.
    pub fn static_curve(
        &self,
        largest: f64,
        points: usize,
    ) -> Result<StaticCurve, FiniteElementError> {
        self.drive()?.static_curve(largest, points)
    }

    /// The loop of cycle `cycle`, from 1, at `amplitude` mm and `frequency` Hz from rest.
    ///
    /// # Errors
    /// As [`RingModel::static_curve`].
    pub fn loop_of_cycle(
        &self,
        amplitude: f64,
        frequency: f64,
        cycle: usize,
    ) -> Result<ForceLoop, FiniteElementError> {
        let drive = self.drive()?;
        let mut cycles = drive.cycles(TABLE_5, self.motion(amplitude, frequency));
        for _ in 1..cycle {
            cycles.next()?;
        }
        cycles.next()
    }

    /// The loop at `amplitude` mm and `frequency` Hz once it repeats itself.
    ///
    /// # Errors
    /// As [`RingModel::static_curve`]; or the loop does not become steady within eight cycles, as with a bore that leaves its
    /// mandrel.
    pub fn steady_loop(
        &self,
        amplitude: f64,
        frequency: f64,
    ) -> Result<ForceLoop, FiniteElementError> {
        self.drive()?
            .cycles(TABLE_5, self.motion(amplitude, frequency))
            .steady()
    }

    fn motion(&self, amplitude: f64, frequency: f64) -> DrivenSine {
        DrivenSine {
            amplitude,
            frequency,
            steps: self.steps,
        }
    }

    /// The material, as [`Reading::material`] has it.
    ///
    /// # Errors
    /// The density is not in Table 4.
    pub fn material(&self) -> Result<MooneyRivlin, FiniteElementError> {
        self.reading
            .material(self.density)
            .ok_or(FiniteElementError::NoConstants(self.density))
    }

    pub(super) fn drive(&self) -> Result<Drive, FiniteElementError> {
        self.drive_on(MANDREL_STIFFNESS)
    }

    /// The quarter on a mandrel of `mandrel_stiffness` times the wall's stiffness; its outer surface moves along y.
    pub(super) fn drive_on(&self, mandrel_stiffness: f64) -> Result<Drive, FiniteElementError> {
        let Divisions {
            around,
            through,
            along,
        } = self.divisions;
        let material = self.material()?;
        let mesh = Mesh::of_ring(
            INNER_RADIUS,
            OUTER_RADIUS,
            HALF_HEIGHT,
            [around, through, along],
        );
        let outer: Vec<usize> = mesh
            .nodes_where(|at| is_at(at.xy().norm(), OUTER_RADIUS))
            .collect();
        let mut prescribed: Vec<usize> = outer
            .iter()
            .flat_map(|node| 3 * node..3 * node + 3)
            .collect();
        prescribed.extend(mesh.nodes_where(|at| is_at(at.x, 0.0)).map(|node| 3 * node));
        prescribed.extend(
            mesh.nodes_where(|at| is_at(at.z, 0.0))
                .map(|node| 3 * node + 2),
        );
        let mandrel = match self.bore {
            Bore::Separable | Bore::Gliding => {
                let modulus = material.bulk_modulus() + 4.0 / 3.0 * material.shear_modulus();
                Some(Mandrel {
                    radius: INNER_RADIUS,
                    stiffness: mandrel_stiffness * modulus / (OUTER_RADIUS - INNER_RADIUS),
                    separable: self.bore == Bore::Separable,
                    surface: mesh.areas(is_on_bore),
                })
            }
            Bore::Bonded => {
                let bore = mesh.nodes_where(is_on_bore);
                prescribed.extend(bore.flat_map(|node| 3 * node..3 * node + 3));
                None
            }
        };
        Ok(Drive {
            body: Body::new(mesh, material, mandrel, prescribed)?,
            moved: outer.into_iter().map(|node| 3 * node + 1).collect(),
            // Four quarters, and a kilonewton to a thousand newtons.
            force_scale: 4e-3,
        })
    }
}

/// Whether a place of the undeformed ring is on its bore.
pub(super) fn is_on_bore(at: &Vector3<f64>) -> bool {
    is_at(at.xy().norm(), INNER_RADIUS)
}

fn is_at(value: f64, place: f64) -> bool {
    (value - place).abs() < ON_SURFACE
}
