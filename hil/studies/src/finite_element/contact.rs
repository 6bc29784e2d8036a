//! Frictionless contact with a rigid mandrel that the surface may leave.

use nalgebra::{Matrix2, Vector2, Vector3};

/// A rigid round mandrel around z, and the nodes that lie on it.
///
/// A node within the mandrel is pushed out along the radius by a pressure in proportion to its depth: a penalty, whose
/// stiffness is chosen so high that the depth does not count beside the material's own deformation.
#[derive(Clone, Debug)]
pub(super) struct Mandrel {
    /// mm
    pub radius: f64,
    /// Pressure over depth, MPa/mm.
    pub stiffness: f64,
    /// Nodes of the surface with the area that each stands for, mm².
    pub surface: Vec<(usize, f64)>,
    /// Whether a node may leave the mandrel; if not, it is pulled back as it is pushed out.
    pub separable: bool,
}

/// What a node in contact adds to the equations of its x and y.
pub(super) struct Push {
    /// The force that holds the node against the mandrel, N.
    pub force: Vector2<f64>,
    /// Its derivative, N/mm.
    pub tangent: Matrix2<f64>,
}

impl Mandrel {
    /// On the node that stands for `area` mm² and is at `position`, mm; `None` where it does not touch.
    pub fn push(&self, area: f64, position: &Vector3<f64>) -> Option<Push> {
        let across = position.xy();
        let distance = across.norm();
        let depth = self.radius - distance;
        // At the very axis there is no way out to choose; no solution is there.
        if (self.separable && depth <= 0.0) || distance == 0.0 {
            return None;
        }
        let normal = across / distance;
        let along = normal * normal.transpose();
        let stiffness = self.stiffness * area;
        Some(Push {
            force: normal * (-stiffness * depth),
            tangent: along * stiffness,
        })
    }
}
