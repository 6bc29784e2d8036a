//! Dry friction.

use super::{Now, Part, substeps};

/// The friction of LuGre, with the Stribeck curve.
#[derive(Clone, Debug)]
pub struct LuGre {
    /// Coulomb friction.
    pub sliding: f64,
    /// Friction at rest.
    pub resting: f64,
    /// Stribeck's speed.
    pub speed: f64,
    /// Stiffness of the bristles.
    pub bristles: f64,
    /// Force of the bristles.
    pub force: f64,
}

impl Part for LuGre {
    fn force(&mut self, now: &Now) -> f64 {
        let limit =
            self.sliding + (self.resting - self.sliding) * (-(now.v / self.speed).powi(2)).exp();
        // The exact solution at constant speed.
        let kept = (-self.bristles * now.v.abs() * now.dt / limit).exp();
        let end = if now.v == 0.0 {
            0.0
        } else {
            limit.copysign(now.v)
        };
        self.force = end + (self.force - end) * kept;
        self.force
    }
}

/// Friction over an elastic contact whose normal load depends on the displacement.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Friction at displacement 0.
    pub friction: f64,
    /// Stiffness of the contact.
    pub stiffness: f64,
    /// Gain of the normal load by |y|, as of a wedge, and by y, as of a leaf spring.
    pub load: [f64; 2],
    /// Height and wave number of a wave of the sliding surface.
    pub wave: [f64; 2],
    pub force: f64,
    pub y: f64,
}

impl Contact {
    fn limit(&self, y: f64) -> f64 {
        let load = 1.0 + self.load[0] * y.abs() + self.load[1] * y;
        let [height, number] = self.wave;
        // A contact does not pull.
        self.friction * (load + height * (number * y).sin()).max(0.0)
    }
}

impl Part for Contact {
    fn force(&mut self, now: &Now) -> f64 {
        let moved = now.y - self.y;
        let count = substeps(self.stiffness * moved, 0.1 * self.friction);
        for step in 1..=count {
            let part = moved / f64::from(count);
            let limit = self.limit(self.y + part * f64::from(step));
            self.force = (self.force + self.stiffness * part).clamp(-limit, limit);
        }
        self.y = now.y;
        self.force
    }
}
