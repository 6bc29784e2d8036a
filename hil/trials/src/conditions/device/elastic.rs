//! Springs, stops and masses.

use super::{Now, Part};

/// A polynomial spring: k1·y + k3·y³.
#[derive(Clone, Debug)]
pub struct Spring {
    pub k1: f64,
    pub k3: f64,
}

impl Part for Spring {
    fn force(&mut self, now: &Now) -> f64 {
        let y = now.y;
        y * (self.k1 + y * y * self.k3)
    }
}

/// A closed gas volume behind a piston: p·Vⁿ is constant, with the volume 1 − share·y.
#[derive(Clone, Debug)]
pub struct GasSpring {
    /// Force of the static pressure.
    pub force: f64,
    /// Part of the volume that displacement 1 displaces.
    pub share: f64,
    /// Polytropic exponent, 1 to 1.4.
    pub exponent: f64,
}

impl Part for GasSpring {
    fn force(&mut self, now: &Now) -> f64 {
        self.force * ((1.0 - self.share * now.y).powf(-self.exponent) - 1.0)
    }
}

/// Stops behind a gap on each side, with the damping of Hunt and Crossley: force k·x·(1 + d·x') at depth x.
#[derive(Clone, Debug)]
pub struct Stops {
    pub stiffness: f64,
    /// Gap on the negative and on the positive side; infinite without a stop.
    pub gaps: [f64; 2],
    pub damping: f64,
}

impl Part for Stops {
    fn force(&mut self, now: &Now) -> f64 {
        let into = |depth: f64, speed: f64| {
            let pushed = depth.max(0.0) * (1.0 + self.damping * speed);
            // It does not stick.
            self.stiffness * pushed.max(0.0)
        };
        into(now.y - self.gaps[1], now.v) - into(-now.y - self.gaps[0], -now.v)
    }
}

/// A rocking block: it turns at a force, after elastic give, and then loses stiffness as its weight leans over.
#[derive(Clone, Debug)]
pub struct Rocking {
    /// Force at which it lifts off.
    pub force: f64,
    /// Displacement at which half of it is reached.
    pub give: f64,
    /// Loss of force per displacement.
    pub lean: f64,
}

impl Part for Rocking {
    fn force(&mut self, now: &Now) -> f64 {
        self.force * (now.y / self.give).tanh() - self.lean * now.y
    }
}

/// An inerter, or a fixture between load cell and specimen.
#[derive(Clone, Debug)]
pub struct Mass {
    pub mass: f64,
}

impl Part for Mass {
    fn force(&mut self, now: &Now) -> f64 {
        self.mass * now.a
    }
}
