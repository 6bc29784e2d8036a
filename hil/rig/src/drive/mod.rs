//! Any motion for the rig to follow: one from a recording, or a band of frequencies with random phases.
//!
//! A [`Motion`] begins and ends at rest at 0. Ramps are added before and after a recorded motion, so that nothing of it is left
//! out. [`limits`] states its demands on actuator and rig before a run. A [`Feeder`] gives a rig its knots in time.

mod feeder;
pub mod limits;
mod random;
mod recorded;

pub use feeder::Feeder;
pub use random::RandomMotion;
pub use recorded::{Recorded, recorded};

use mesh_damper::rig::Knot;

/// Time from knot to knot, s, rounded to whole ticks: cubics between such knots follow 100 Hz within 4e-4 of its amplitude.
const KNOT_TIME: f64 = 1e-3;

/// The ticks at which a motion has its knots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    tick_rate: f64,
    knot_ticks: u32,
}

impl Grid {
    /// The grid for `tick_rate` Hz, 1…1e6: a knot every millisecond, or at every tick if ticks are longer.
    pub fn at(tick_rate: f64) -> Self {
        Self {
            tick_rate,
            knot_ticks: (KNOT_TIME * tick_rate).round().max(1.0) as u32,
        }
    }

    /// Tick rate, Hz.
    pub fn tick_rate(&self) -> f64 {
        self.tick_rate
    }

    /// Ticks from knot to knot.
    pub fn knot_ticks(&self) -> u32 {
        self.knot_ticks
    }

    /// Time from knot to knot, s.
    pub fn step(&self) -> f64 {
        f64::from(self.knot_ticks) / self.tick_rate
    }
}

/// Position of a motion: displacement, velocity and acceleration in mm, mm/s and mm/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Displacement, mm.
    pub displacement: f64,
    /// Velocity, mm/s.
    pub velocity: f64,
    /// Acceleration, mm/s².
    pub acceleration: f64,
}

/// Displacement in mm and velocity in mm/s at equal time steps, with a cubic from each to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    grid: Grid,
    /// At least two; the first and the last are at rest at 0.
    knots: Vec<[f64; 2]>,
    /// Number of knots of the ramps at both ends.
    ramps: [usize; 2],
}

impl Motion {
    /// `core` with the ramps to it and from it.
    fn new(
        grid: Grid,
        mut lead_in: Vec<[f64; 2]>,
        core: Vec<[f64; 2]>,
        lead_out: Vec<[f64; 2]>,
    ) -> Self {
        let ramps = [lead_in.len(), lead_out.len()];
        lead_in.extend(core);
        lead_in.extend(lead_out);
        Self {
            grid,
            knots: lead_in,
            ramps,
        }
    }

    /// The ticks of its knots.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Duration from rest to rest, s.
    pub fn duration(&self) -> f64 {
        (self.knots.len() - 1) as f64 * self.grid.step()
    }

    /// Durations of the ramps at its beginning and at its end, s.
    pub fn ramps(&self) -> [f64; 2] {
        self.ramps.map(|knots| knots as f64 * self.grid.step())
    }

    /// Its position `time` s after its start; at rest at 0 before and after it.
    pub fn at(&self, time: f64) -> Place {
        let knots = time / self.grid.step();
        let last = self.knots.len() - 1;
        if !(0.0..=last as f64).contains(&knots) {
            return Place::default();
        }
        let before = (knots as usize).min(last - 1);
        cubic(
            self.knots[before],
            self.knots[before + 1],
            self.grid.step(),
            knots - before as f64,
        )
    }

    /// The knots for a rig: those after the first, at which the rig stands when it starts.
    pub fn knots(&self) -> impl ExactSizeIterator<Item = Knot> {
        self.knots[1..]
            .iter()
            .map(|&[displacement, velocity]| Knot {
                displacement: displacement as f32,
                velocity: velocity as f32,
            })
    }

    /// RMS of the displacement without the ramps, mm.
    pub fn rms(&self) -> f64 {
        let core = &self.knots[self.ramps[0]..self.knots.len() - self.ramps[1]];
        let squares: f64 = core.iter().map(|[y, _]| y * y).sum();
        (squares / core.len() as f64).sqrt()
    }

    /// The largest displacement, velocity and acceleration of all knots in either direction.
    pub fn peaks(&self) -> Place {
        let mut peaks = Place::default();
        for pair in self.knots.windows(2) {
            for part in [0.0, 0.5, 1.0] {
                let at = cubic(pair[0], pair[1], self.grid.step(), part);
                peaks.displacement = peaks.displacement.max(at.displacement.abs());
                peaks.velocity = peaks.velocity.max(at.velocity.abs());
                peaks.acceleration = peaks.acceleration.max(at.acceleration.abs());
            }
        }
        peaks
    }
}

/// The cubic from one displacement and velocity to another `time` s later, at `part` of that time, 0…1.
fn cubic([y0, v0]: [f64; 2], [y1, v1]: [f64; 2], time: f64, part: f64) -> Place {
    let mean = (y1 - y0) / time;
    let bend = 3.0 * mean - 2.0 * v0 - v1;
    let twist = v0 + v1 - 2.0 * mean;
    Place {
        displacement: y0 + time * part * (v0 + part * (bend + part * twist)),
        velocity: v0 + part * (2.0 * bend + 3.0 * part * twist),
        acceleration: (2.0 * bend + 6.0 * part * twist) / time,
    }
}
