//! Rubber and other materials with relaxation.

use super::{Now, Part};

/// A spring with a dashpot.
#[derive(Clone, Debug)]
pub struct Branch {
    pub stiffness: f64,
    /// Relaxation time.
    pub time: f64,
    pub force: f64,
}

impl Branch {
    /// Exact at constant speed.
    fn advance(&mut self, now: &Now, time: f64) -> f64 {
        let kept = (-now.dt / time).exp();
        self.force = self.force * kept + self.stiffness * time * (1.0 - kept) * now.v;
        self.force
    }
}

/// Maxwell branches in parallel: one makes Zener's solid; many with stiffness τ^−α make a spring-pot of exponent α.
#[derive(Clone, Debug)]
pub struct Maxwell {
    pub branches: Vec<Branch>,
}

impl Part for Maxwell {
    fn force(&mut self, now: &Now) -> f64 {
        let branches = self.branches.iter_mut();
        branches
            .map(|branch| branch.advance(now, branch.time))
            .sum()
    }
}

/// Branches that relax faster while the material is sheared, and recover slowly: the Payne effect by Lion and Kardelky.
#[derive(Clone, Debug)]
pub struct Payne {
    pub branches: Vec<Branch>,
    /// How much faster they relax, per intensity of the motion.
    pub softening: f64,
    /// Time of recovery.
    pub recovery: f64,
    /// The mean speed over the time of recovery.
    pub intensity: f64,
}

impl Part for Payne {
    fn force(&mut self, now: &Now) -> f64 {
        let kept = (-now.dt / self.recovery).exp();
        self.intensity = now.v.abs() + (self.intensity - now.v.abs()) * kept;
        let faster = 1.0 + self.softening * self.intensity;
        let branches = self.branches.iter_mut();
        branches
            .map(|branch| branch.advance(now, branch.time / faster))
            .sum()
    }
}

/// The friction of filled rubber by Berg: from each turning point it approaches its largest force over a distance.
#[derive(Clone, Debug)]
pub struct Berg {
    /// Largest force.
    pub most: f64,
    /// Displacement for half of it, from rest.
    pub half: f64,
    /// Displacement and force of the last turning point.
    pub turned: [f64; 2],
    pub direction: f64,
    pub y: f64,
    pub force: f64,
}

impl Part for Berg {
    fn force(&mut self, now: &Now) -> f64 {
        let moved = now.y - self.y;
        if moved == 0.0 {
            return self.force;
        }
        if moved.signum() != self.direction {
            self.direction = moved.signum();
            self.turned = [self.y, self.force];
        }
        self.y = now.y;
        let [from, start] = self.turned;
        let way = (now.y - from).abs();
        let ahead = self.direction * self.most - start;
        let distance = self.half * (1.0 - self.direction * start / self.most) + way;
        self.force = if distance > 0.0 {
            start + ahead * way / distance
        } else {
            start
        };
        self.force
    }
}
