//! A servo-hydraulic actuator in a closed position loop, working against a specimen.
//!
//! - Amplifier: u = gain·(command(t − dead_time) − x)/flow_velocity, clamped to ±1.
//! - Valve: s̈ + 2ζω·ṡ + ω²·s = ω²·u, |s| ≤ 1 (Merritt, Hydraulic Control Systems, 1967, ch. 7).
//! - Flow, as piston velocity: q = flow_velocity·s·√(1 − sgn(s)·P/force_limit), P the force of the load pressure.
//! - Oil column: Ṗ = oil_stiffness·(q − v − leakage·P), |P| ≤ force_limit.
//! - Piston: m·v̇ = P − friction(v) − specimen(x, v), with Stribeck friction (coulomb + (stiction − coulomb)/(1 +
//!   (v/stribeck)²))·sgn v + viscous·v. It sticks where the friction exceeds the other forces.
//!
//! One step is backward Euler in v, P and x, so that c·|v|^α with its infinite slope at v = 0 stops the piston instead of making it
//! rattle. The new v is the root of a monotone function, found by probing copies of the specimen. The copy at the root becomes the
//! specimen. Opening and throttling are those at the beginning of the step.

use std::collections::VecDeque;

use super::{InvalidField, not_negative, positive};
use crate::specimen::DamperForce;

/// Parameters of an actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoConfig {
    /// Gain of the position loop, 1/s.
    pub gain: f64,
    /// Dead time of the command, s.
    pub dead_time: f64,
    /// Natural frequency of the valve, Hz.
    pub valve_frequency: f64,
    /// Damping ratio of the valve.
    pub valve_damping: f64,
    /// Piston velocity at full opening without load, mm/s.
    pub flow_velocity: f64,
    /// Supply pressure times piston area, kN.
    pub force_limit: f64,
    /// Stiffness of the oil columns on both sides, kN/mm.
    pub oil_stiffness: f64,
    /// Leakage across the piston, mm/s of piston velocity per kN.
    pub leakage: f64,
    /// Mass of piston and grip, kg.
    pub mass: f64,
    /// Friction while moving, kN.
    pub coulomb: f64,
    /// Friction near standstill, kN.
    pub stiction: f64,
    /// Velocity at which the friction is midway between both, mm/s.
    pub stribeck: f64,
    /// Viscous friction, kN·s/mm.
    pub viscous: f64,
}

impl Default for ServoConfig {
    /// A 200 kN machine like the paper's, with a short, stiff cylinder on hydrostatic bearings: 24 Hz of position loop, an oil
    /// resonance at 650 Hz, 2 N of friction.
    fn default() -> Self {
        Self {
            gain: 150.0,
            dead_time: 1e-3,
            valve_frequency: 120.0,
            valve_damping: 0.8,
            flow_velocity: 150.0,
            force_limit: 200.0,
            oil_stiffness: 5000.0,
            leakage: 0.02,
            mass: 300.0,
            coulomb: 0.002,
            stiction: 0.003,
            stribeck: 1.0,
            viscous: 0.005,
        }
    }
}

/// Fault of an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ServoFault {
    /// No fault.
    #[default]
    None,
    /// The valve is centred and ignores commands: a broken wire, a relay that fell.
    Dead,
    /// The supply limits the piston velocity to this value, mm/s, 0 or more.
    Saturated(f64),
    /// Commands arrive later than the dead time by this number of steps.
    Lagging(usize),
}

/// Constants of a step, computed once from the configuration: one division per step would take a tenth of its time.
#[derive(Clone, Copy, Debug)]
struct Dynamics {
    /// Length of a step in s, and its inverse in 1/s.
    step: f64,
    rate: f64,
    /// Opening per mm of error.
    gain: f64,
    /// ω² and 2ζω of the valve, 1/s² and 1/s.
    valve_stiffness: f64,
    valve_damping: f64,
    /// Pressure force per mm/s of flow over a step, reduced by the leakage, kN·s/mm.
    oil: f64,
    /// 1/(1 + step·oil_stiffness·leakage).
    relief: f64,
    /// Mass over the step, kN·s/mm.
    inertia: f64,
    /// Resistance to the piston's velocity without the specimen, kN·s/mm.
    resistance: f64,
    /// 1/kN, s/mm.
    inverse_force_limit: f64,
    inverse_stribeck: f64,
}

impl Dynamics {
    fn new(c: &ServoConfig, step: f64) -> Self {
        let w = std::f64::consts::TAU * c.valve_frequency;
        let relief = 1.0 / (1.0 + step * c.oil_stiffness * c.leakage);
        let oil = step * c.oil_stiffness * relief;
        let inertia = c.mass * 1e-6 / step;
        Self {
            step,
            rate: 1.0 / step,
            gain: c.gain / c.flow_velocity,
            valve_stiffness: w * w,
            valve_damping: 2.0 * c.valve_damping * w,
            oil,
            relief,
            inertia,
            resistance: inertia + c.viscous + oil,
            inverse_force_limit: 1.0 / c.force_limit,
            inverse_stribeck: 1.0 / c.stribeck,
        }
    }
}

/// An actuator and its state.
#[derive(Clone, Debug)]
pub struct Servo<S> {
    config: ServoConfig,
    dynamics: Dynamics,
    specimen: S,
    trial: S,
    commands: VecDeque<f64>,
    dead_steps: usize,
    ticks: u64,
    opening: f64,
    opening_rate: f64,
    pressure_force: f64,
    displacement: f64,
    velocity: f64,
    /// dF/dv of the specimen in the last step, kN·s/mm.
    slope: f64,
    force: f64,
    /// Force in the step before.
    force_before: f64,
    /// May be set while running.
    pub fault: ServoFault,
}

/// The balance of forces on the piston is met within this many kN: an eighth of a 16-bit step over ±5 kN.
const BALANCE: f64 = 2e-5;
/// Enough to halve 1 m/s down to 1e-87 mm/s in the variable of [`velocity_of`].
const MOST_PROBES: usize = 60;

impl<S: DamperForce + Clone> Servo<S> {
    /// At rest at 0, with the specimen unloaded.
    ///
    /// # Errors
    /// A field that is negative, zero where zero is not allowed, or not finite.
    pub fn new(config: ServoConfig, step: f64, specimen: S) -> Result<Self, InvalidField> {
        positive("step", step)?;
        positive("gain", config.gain)?;
        not_negative("dead_time", config.dead_time)?;
        positive("valve_frequency", config.valve_frequency)?;
        positive("valve_damping", config.valve_damping)?;
        positive("flow_velocity", config.flow_velocity)?;
        positive("force_limit", config.force_limit)?;
        positive("oil_stiffness", config.oil_stiffness)?;
        not_negative("leakage", config.leakage)?;
        positive("mass", config.mass)?;
        not_negative("coulomb", config.coulomb)?;
        not_negative("stiction", config.stiction)?;
        positive("stribeck", config.stribeck)?;
        not_negative("viscous", config.viscous)?;
        let delay = (config.dead_time / step).round() as usize;
        Ok(Self {
            config,
            dynamics: Dynamics::new(&config, step),
            trial: specimen.clone(),
            specimen,
            commands: VecDeque::from(vec![0.0; delay]),
            dead_steps: delay,
            ticks: 0,
            opening: 0.0,
            opening_rate: 0.0,
            pressure_force: 0.0,
            displacement: 0.0,
            velocity: 0.0,
            slope: 0.0,
            force: 0.0,
            force_before: 0.0,
            fault: ServoFault::None,
        })
    }

    /// Advances by one step with `command` in mm. While not `enabled`, the valve is centred and ignores commands.
    pub fn advance(&mut self, command: f64, enabled: bool) {
        self.commands.push_back(command);
        let later = match self.fault {
            ServoFault::Lagging(steps) => steps,
            _ => 0,
        };
        let mut command = self.commands.front().copied().unwrap_or(command);
        while self.commands.len() > self.dead_steps + later {
            command = self.commands.pop_front().unwrap_or(command);
        }
        let d = &self.dynamics;
        let most = match self.fault {
            ServoFault::Dead => 0.0,
            ServoFault::Saturated(velocity) => velocity / self.config.flow_velocity,
            _ => 1.0,
        };
        let u = if enabled {
            (d.gain * (command - self.displacement)).clamp(-most, most)
        } else {
            0.0
        };
        let pull = d.valve_stiffness * (u - self.opening) - d.valve_damping * self.opening_rate;
        self.opening_rate += d.step * pull;
        self.opening += d.step * self.opening_rate;
        if self.opening.abs() > 1.0 {
            self.opening = self.opening.clamp(-1.0, 1.0);
            self.opening_rate = 0.0;
        }
        self.ticks += 1;
        self.move_piston();
    }

    /// Displacement of the specimen, mm.
    pub fn displacement(&self) -> f64 {
        self.displacement
    }
    /// mm/s.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }
    /// Force of the specimen, kN.
    pub fn force(&self) -> f64 {
        self.force
    }
    /// s since the start.
    pub fn time(&self) -> f64 {
        self.ticks as f64 * self.dynamics.step
    }
    /// Time of a step, s.
    pub fn step(&self) -> f64 {
        self.dynamics.step
    }

    /// The specimen.
    pub fn specimen(&self) -> &S {
        &self.specimen
    }

    fn move_piston(&mut self) {
        let (c, d) = (&self.config, &self.dynamics);
        let throttling = 1.0 - self.opening.signum() * self.pressure_force * d.inverse_force_limit;
        let flow = c.flow_velocity * self.opening * throttling.max(0.0).sqrt();
        // P₁ = (P₀ + h·K·(q − v₁))/(1 + h·K·leakage) in m·(v₁ − v₀)/h = P₁ − friction − specimen.
        let undisturbed = self.pressure_force * d.relief + d.oil * flow;
        let drive = d.inertia * self.velocity + undisturbed;
        let dry = c.coulomb
            + (c.stiction - c.coulomb) / (1.0 + (self.velocity * d.inverse_stribeck).powi(2));

        let velocity = self.balance(drive, dry);

        let pressure = undisturbed - self.dynamics.oil * velocity;
        self.pressure_force = pressure.clamp(-self.config.force_limit, self.config.force_limit);
        self.displacement += self.dynamics.step * velocity;
        self.velocity = velocity;
        std::mem::swap(&mut self.specimen, &mut self.trial);
    }

    /// The v at which resistance·v + dry·sgn v + specimen(v) = drive; leaves the specimen at that v in `trial`.
    fn balance(&mut self, drive: f64, dry: f64) -> f64 {
        let resistance = self.dynamics.resistance;
        // Starts at the v for a force that continues as before, then uses Newton's rule with the last slope.
        let expected = 2.0 * self.force - self.force_before;
        self.force_before = self.force;
        let friction = if self.velocity == 0.0 {
            0.0
        } else {
            dry.copysign(self.velocity)
        };
        let mut velocity = (drive - friction - expected) / resistance;
        let mut excess = self.probe(velocity, drive, dry);
        if excess.abs() <= BALANCE {
            return velocity;
        }
        let first = (velocity, excess, self.force);
        velocity -= excess / (resistance + self.slope);
        excess = self.probe(velocity, drive, dry);
        if velocity != first.0 {
            self.slope = ((self.force - first.2) / (velocity - first.0)).clamp(0.0, 1e3);
        }
        if excess.abs() <= BALANCE {
            return velocity;
        }
        // The function rises at least as fast as `resistance`, so this far on the other side it has changed sign.
        let mut near = (root_of(velocity), excess);
        velocity -= excess * (1.0 + 1e-6) / resistance;
        excess = self.probe(velocity, drive, dry);
        let mut far = (root_of(velocity), excess);
        if near.0 * far.0 < 0.0 {
            velocity = 0.0;
            excess = self.probe(velocity, drive, dry);
            if excess * far.1 < 0.0 {
                near = far;
            }
            far = (velocity, excess);
        }
        for _ in 0..MOST_PROBES {
            if excess.abs() <= BALANCE || near.0 == far.0 {
                break;
            }
            let root = (near.0 * far.1 - far.0 * near.1) / (far.1 - near.1);
            velocity = velocity_of(root);
            excess = self.probe(velocity, drive, dry);
            // Illinois rule: halve the weight of an end that stays twice.
            if excess * far.1 < 0.0 {
                near = far;
            } else {
                near.1 *= 0.5;
            }
            far = (root, excess);
        }
        velocity
    }

    /// Excess of the left side at velocity `v`; the specimen's force there goes to `force`.
    fn probe(&mut self, v: f64, drive: f64, dry: f64) -> f64 {
        let d = &self.dynamics;
        self.trial.clone_from(&self.specimen);
        self.force = self.trial.force(
            self.ticks as f64 * d.step,
            self.displacement + d.step * v,
            v,
            (v - self.velocity) * d.rate,
            d.step,
        );
        // At standstill dry friction balances the other forces, up to its level.
        let rest = d.resistance * v + self.force - drive;
        if v == 0.0 {
            rest - rest.clamp(-dry, dry)
        } else {
            rest + dry * v.signum()
        }
    }
}

/// In the fifth root of the velocity, |v|^α is nearly straight through 0, so that secants converge.
fn root_of(velocity: f64) -> f64 {
    velocity.abs().powf(0.2).copysign(velocity)
}

fn velocity_of(root: f64) -> f64 {
    root.powi(5)
}
