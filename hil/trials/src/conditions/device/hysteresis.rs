//! Hysteresis that does not depend on the rate.

use super::{Now, Part, substeps};

/// The hysteresis of Bouc and Wen, with the pinching and the loss of strength of Baber and Noori, and the asymmetric envelope that Ni
/// et al. found on wire ropes.
#[derive(Clone, Debug)]
pub struct BoucWen {
    /// Force at |z| = 1.
    pub force: f64,
    /// Displacement at which the first loading would reach it.
    pub slip: f64,
    /// β; γ is 1 − β. From ½ on, unloading is as stiff as loading, or stiffer.
    pub beta: f64,
    /// Exponent n.
    pub sharpness: f64,
    /// Depth 0…1, centre and width of the pinching, over z.
    pub pinch: [f64; 3],
    /// Relative loss of strength per dissipated energy.
    pub loss: f64,
    /// The envelope grows by exp(e1·y + e2·y²).
    pub envelope: [f64; 2],
    pub z: f64,
    pub dissipated: f64,
    pub y: f64,
}

impl BoucWen {
    fn rate(&self, z: f64, direction: f64) -> f64 {
        let [depth, centre, width] = self.pinch;
        let pinched = 1.0 - depth * (-((z * direction - centre) / width).powi(2)).exp();
        let shape = self.beta * (z * direction).signum() + 1.0 - self.beta;
        pinched * (1.0 - shape * z.abs().powf(self.sharpness)) / self.slip
    }
}

impl Part for BoucWen {
    fn force(&mut self, now: &Now) -> f64 {
        let moved = now.y - self.y;
        self.y = now.y;
        let count = substeps(moved, 0.02 * self.slip);
        let step = moved / f64::from(count);
        for _ in 0..count {
            let middle = self.z + 0.5 * step * self.rate(self.z, step.signum());
            self.z += step * self.rate(middle, step.signum());
        }
        self.dissipated += (self.z * moved).abs();
        let [e1, e2] = self.envelope;
        let envelope = (e1 * now.y + e2 * now.y.powi(2)).exp();
        self.force * envelope * self.z / (1.0 + self.loss * self.dissipated)
    }
}

/// A spring with a slider.
#[derive(Clone, Debug)]
pub struct Slider {
    pub stiffness: f64,
    /// Force at which it slips backwards and forwards.
    pub limits: [f64; 2],
    pub force: f64,
}

/// Sliders in parallel: the model of Masing, Iwan and Prandtl. With unequal limits its loops are asymmetric.
#[derive(Clone, Debug)]
pub struct Sliders {
    pub sliders: Vec<Slider>,
    pub y: f64,
}

impl Part for Sliders {
    fn force(&mut self, now: &Now) -> f64 {
        let moved = now.y - self.y;
        self.y = now.y;
        let sliders = self.sliders.iter_mut();
        sliders
            .map(|slider| {
                let [back, forth] = slider.limits;
                slider.force = (slider.force + slider.stiffness * moved).clamp(-back, forth);
                slider.force
            })
            .sum()
    }
}

/// A superelastic wire pair: martensite forms at a loading plateau and returns at a lower one, so that the loop is a flag.
#[derive(Clone, Debug)]
pub struct Superelastic {
    pub stiffness: f64,
    /// Force of the loading plateau, and of the unloading one.
    pub plateaus: [f64; 2],
    /// Slope of both plateaus.
    pub slope: f64,
    /// Transformed displacement.
    pub transformed: f64,
}

impl Part for Superelastic {
    fn force(&mut self, now: &Now) -> f64 {
        let x = now.y.abs();
        // On a plateau k·(x − t) = p + s·t.
        let at = |plateau: f64| (self.stiffness * x - plateau) / (self.stiffness + self.slope);
        let [loading, unloading] = self.plateaus.map(at);
        self.transformed = self.transformed.clamp(loading, unloading).max(0.0);
        self.stiffness * (x - self.transformed) * now.y.signum()
    }
}

/// Structural damping by Reid: a force proportional to the displacement, against the velocity.
#[derive(Clone, Debug)]
pub struct Structural {
    pub stiffness: f64,
}

impl Part for Structural {
    fn force(&mut self, now: &Now) -> f64 {
        let direction = if now.v == 0.0 { 0.0 } else { now.v.signum() };
        self.stiffness * now.y.abs() * direction
    }
}
