//! Frictionless contact with a rigid mandrel, which the surface may leave.

use nalgebra::{Matrix2, Vector2, Vector3};

/// A rigid round mandrel around z, and the nodes on its surface.
///
/// A pressure proportional to its depth pushes a node within the mandrel out along the radius. This is a penalty; its stiffness is
/// chosen high enough that the depth is negligible compared to the material's deformation.
#[derive(Clone, Debug)]
pub(super) struct Mandrel {
    /// mm
    pub radius: f64,
    /// Pressure over depth, MPa/mm.
    pub stiffness: f64,
    /// Nodes of the surface with the area that each stands for, mm².
    pub surface: Vec<(usize, f64)>,
    /// Whether a node may leave the mandrel; if not, it is pulled back in the same way.
    pub separable: bool,
}

/// The contribution of a node in contact to the equations of its x and y.
pub(super) struct Push {
    /// The force that holds the node against the mandrel, N.
    pub force: Vector2<f64>,
    /// Its derivative, N/mm.
    pub tangent: Matrix2<f64>,
}

impl Mandrel {
    /// For the node that represents `area` mm² and is at `position`, mm; `None` without contact.
    pub fn push(&self, area: f64, position: &Vector3<f64>) -> Option<Push> {
        let across = position.xy();
        let distance = across.norm();
        let depth = self.radius - distance;
        // On the axis itself the direction is undefined; no solution is there.
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
