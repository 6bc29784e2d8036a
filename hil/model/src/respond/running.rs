//! Amplitude and cycles of a motion while it runs. A model with coefficients over amplitude, or with a change over cycles, needs
//! them at every step.

/// A turn counts after the motion has come back by this fraction of its last amplitude. This excludes ripples.
const TURN: f64 = 0.1;

/// The state of the motion so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Running {
    /// Half the distance between the last two turns, mm; `None` before there are two.
    amplitude: Option<f64>,
    /// Completed half cycles.
    halves: u32,
    /// Duration of the last half cycle, s.
    half_period: Option<f64>,
    /// Displacement of the last turn, mm.
    turn: f64,
    /// The farthest displacement from there since, mm, and the time since then, s.
    farthest: f64,
    since_farthest: f64,
    /// Time since the last turn, s.
    since_turn: f64,
    begun: bool,
}

impl Running {
    /// One step of `step` s to `displacement` mm. Returns the amplitude in mm of the half cycle that ends here, if one does: half
    /// the distance from the last turn to the new one.
    pub fn update(&mut self, displacement: f64, step: f64) -> Option<f64> {
        if !self.begun {
            *self = Self {
                begun: true,
                turn: displacement,
                farthest: displacement,
                ..Self::default()
            };
            return None;
        }
        self.since_turn += step;
        self.since_farthest += step;
        let way = self.farthest - self.turn;
        let goes_on = way == 0.0 || (displacement - self.farthest) * way > 0.0;
        if goes_on {
            if displacement != self.farthest {
                self.farthest = displacement;
                self.since_farthest = 0.0;
            }
            return None;
        }
        let amplitude = 0.5 * way.abs();
        let size = self.amplitude.map_or(amplitude, |last| last.min(amplitude));
        if (displacement - self.farthest).abs() <= TURN * size {
            return None;
        }
        self.amplitude = Some(amplitude);
        self.halves += 1;
        self.half_period = Some(self.since_turn - self.since_farthest);
        self.turn = self.farthest;
        self.since_turn = self.since_farthest;
        self.farthest = displacement;
        self.since_farthest = 0.0;
        Some(amplitude)
    }

    /// Cycles since the motion began. The fraction assumes that a half cycle takes as long as the one before, and waits if it takes
    /// longer.
    pub fn cycles(&self) -> f64 {
        let part = self
            .half_period
            .filter(|&period| period > 0.0)
            .map_or(0.0, |period| (self.since_turn / period).min(1.0));
        0.5 * (f64::from(self.halves) + part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_sine_that_grows_has_its_amplitude_and_its_cycles() {
        let step = 1e-3;
        let mut running = Running::default();
        let mut ends = Vec::new();
        let mut last = 0.0;
        for index in 0..5000 {
            let time = step * f64::from(index);
            let size = 0.1 + 0.02 * time;
            ends.extend(running.update(size * (TAU * 2.0 * time).sin(), step));
            assert!(running.cycles() >= last);
            last = running.cycles();
        }
        // Ten cycles: the first half from rest to the first turn, then halves from turn to turn.
        assert_eq!(ends.len(), 20);
        assert!((ends[19] - 0.2).abs() < 0.01, "{}", ends[19]);
        // A quarter of a cycle is counted as a half.
        assert!((last - 10.25).abs() < 0.01, "{last}");
    }

    #[test]
    fn rest_and_ripples_are_no_cycles() {
        let mut running = Running::default();
        for index in 0..1000 {
            let time = 1e-3 * f64::from(index);
            let ripple = 0.005 * (TAU * 100.0 * time).sin();
            running.update((TAU * time).sin() + ripple, 1e-3);
        }
        assert!(running.cycles() < 1.6, "{}", running.cycles());
        let mut still = Running::default();
        for _ in 0..100 {
            assert_eq!(still.update(0.3, 1e-3), None);
        }
        assert_eq!(still.cycles(), 0.0);
    }
}
