//! The benchmark's oscillator, integrated separately: it shares no code with the crate.

/// Steps between two samples of a record: as in the benchmark, at 15 kHz.
pub const OVERSAMPLING: usize = 20;

/// m·y″ + c·y′ + k·y + z = u, z′ = α·y′ − β·(γ·|y′|·|z|^(ν−1)·z + δ·y′·|z|^ν), in m, N and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct System {
    /// m, kg
    pub mass: f64,
    /// c, N·s/m
    pub damping: f64,
    /// k, N/m
    pub stiffness: f64,
    /// α, N/m
    pub alpha: f64,
    /// β, 1/m for ν = 1
    pub beta: f64,
    /// γ
    pub gamma: f64,
    /// δ
    pub delta: f64,
    /// ν
    pub nu: f64,
}

impl System {
    /// Noël and Schoukens (2016), Hysteretic benchmark with a dynamic nonlinearity, Table 1.
    pub const BENCHMARK: Self = Self {
        mass: 2.0,
        damping: 10.0,
        stiffness: 5e4,
        alpha: 5e4,
        beta: 1e3,
        gamma: 0.8,
        delta: -1.1,
        nu: 1.0,
    };

    /// Rates of displacement, velocity and z under a force of `u` N.
    fn rates(&self, [y, v, z]: [f64; 3], u: f64) -> [f64; 3] {
        let size = z.abs().powf(self.nu);
        let hysteresis = self.gamma * v.abs() * size * z.signum() + self.delta * v * size;
        [
            v,
            (u - self.damping * v - self.stiffness * y - z) / self.mass,
            self.alpha * v - self.beta * hysteresis,
        ]
    }

    /// One step of `step` s by the classical Runge–Kutta method, under a force of `u` N at its start, middle and end.
    pub fn step(&self, state: [f64; 3], [start, middle, end]: [f64; 3], step: f64) -> [f64; 3] {
        let after = |rates: [f64; 3], part: f64| {
            [0, 1, 2].map(|index| state[index] + part * step * rates[index])
        };
        let first = self.rates(state, start);
        let second = self.rates(after(first, 0.5), middle);
        let third = self.rates(after(second, 0.5), middle);
        let fourth = self.rates(after(third, 1.0), end);
        [0, 1, 2].map(|index| {
            let sum = first[index] + 2.0 * (second[index] + third[index]) + fourth[index];
            state[index] + step / 6.0 * sum
        })
    }

    /// Displacement in m at `count` samples, `tick` s apart, from rest, under a force of `u(time)` N at every half step, given by
    /// its number.
    pub fn displacements(&self, tick: f64, count: usize, u: impl Fn(usize) -> f64) -> Vec<f64> {
        let step = tick / OVERSAMPLING as f64;
        let mut state = [0.0; 3];
        (0..count)
            .map(|sample| {
                let now = state[0];
                for index in sample * OVERSAMPLING..(sample + 1) * OVERSAMPLING {
                    let force = [0, 1, 2].map(|half| u(2 * index + half));
                    state = self.step(state, force, step);
                }
                now
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With ν = 1 and a displacement that only grows, z = α/(β(γ + δ))·(1 − e^(−β(γ + δ)·y)).
    #[test]
    fn a_branch_of_the_hysteresis_is_the_closed_form() {
        let system = System::BENCHMARK;
        let bend = system.beta * (system.gamma + system.delta);
        let (mut z, step, velocity) = (0.0, 1e-5, 0.1);
        for index in 0..1000 {
            let rate = |z: f64| system.rates([0.0, velocity, z], 0.0)[2];
            z += step * rate(z + 0.5 * step * rate(z));
            let y = velocity * step * f64::from(index + 1);
            let expected = system.alpha / bend * (1.0 - (-bend * y).exp());
            assert!(
                (z - expected).abs() < 1e-4 * expected,
                "{y}: {z} {expected}"
            );
        }
    }

    /// Without hysteresis it is a linear oscillator: from rest under a constant force.
    #[test]
    fn a_step_of_force_swings_as_the_closed_form() {
        let system = System {
            alpha: 0.0,
            ..System::BENCHMARK
        };
        let tick = 1.0 / 750.0;
        let found = system.displacements(tick, 300, |_| 50.0);
        let omega = (system.stiffness / system.mass).sqrt();
        let zeta = 0.5 * system.damping / (system.mass * omega);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        for (index, y) in found.iter().enumerate() {
            let time = tick * index as f64;
            let (sin, cos) = (damped * time).sin_cos();
            let swing = cos + zeta * omega / damped * sin;
            let expected = 1e-3 * (1.0 - (-zeta * omega * time).exp() * swing);
            assert!((y - expected).abs() < 1e-10, "{time}: {y} {expected}");
        }
    }
}
