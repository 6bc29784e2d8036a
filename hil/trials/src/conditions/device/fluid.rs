//! Oil and air.

use super::{Now, Part, substeps};

/// c·|v|^α·sgn v.
#[derive(Clone, Debug)]
pub struct PowerDamper {
    pub c: f64,
    pub alpha: f64,
}

impl Part for PowerDamper {
    fn force(&mut self, now: &Now) -> f64 {
        if now.v == 0.0 {
            return 0.0;
        }
        self.c * now.v.abs().powf(self.alpha) * now.v.signum()
    }
}

/// A shock absorber whose valves open at a speed, with other rates in compression than in extension.
#[derive(Clone, Debug)]
pub struct BlowOff {
    /// Rate of the closed valve in extension and in compression.
    pub closed: [f64; 2],
    /// Rate of the open valve.
    pub open: [f64; 2],
    /// Speed at which the valve opens.
    pub knee: [f64; 2],
}

impl Part for BlowOff {
    fn force(&mut self, now: &Now) -> f64 {
        let side = usize::from(now.v > 0.0);
        let (closed, open, knee) = (self.closed[side], self.open[side], self.knee[side]);
        open * now.v + (closed - open) * knee * (now.v / knee).tanh()
    }
}

/// An orifice, c1·x' + c2·x'·|x'|, in series with the stiffness of its mounting or of its oil column.
#[derive(Clone, Debug)]
pub struct SeriesOrifice {
    pub stiffness: f64,
    pub linear: f64,
    pub quadratic: f64,
    pub force: f64,
}

impl SeriesOrifice {
    fn flow(&self, force: f64) -> f64 {
        let (b, a) = (self.linear, self.quadratic);
        let speed = (-b + (b * b + 4.0 * a * force.abs()).sqrt()) / (2.0 * a);
        speed.copysign(force)
    }
}

impl Part for SeriesOrifice {
    fn force(&mut self, now: &Now) -> f64 {
        // A tenth of the shortest time constant keeps the explicit midpoint rule stable and accurate.
        let count = substeps(now.dt, 0.1 * self.linear / self.stiffness);
        let dt = now.dt / f64::from(count);
        for _ in 0..count {
            let rate = |force| self.stiffness * (now.v - self.flow(force));
            let middle = self.force + 0.5 * dt * rate(self.force);
            self.force += dt * rate(middle);
        }
        self.force
    }
}

/// An air spring whose volume exchanges air with a reservoir through a leak: slow motions are isothermal and soft. The control
/// input is the supply pressure.
#[derive(Clone, Debug)]
pub struct AirChamber {
    /// Force of the static pressure.
    pub force: f64,
    /// Part of the volume that displacement 1 displaces.
    pub share: f64,
    /// Polytropic exponent.
    pub exponent: f64,
    /// Time constant of the leak.
    pub time: f64,
    /// Force without supply, over that at control input 1.
    pub idle: f64,
    /// Pressure over the static one.
    pub pressure: f64,
    pub volume: f64,
}

impl Part for AirChamber {
    fn force(&mut self, now: &Now) -> f64 {
        let volume = 1.0 - self.share * now.y;
        self.pressure *= (self.volume / volume).powf(self.exponent);
        self.volume = volume;
        self.pressure = 1.0 + (self.pressure - 1.0) * (-now.dt / self.time).exp();
        let supply = self.idle + (1.0 - self.idle) * now.control;
        self.force * supply * (self.pressure - 1.0)
    }
}

/// The fluid in the inertia track of a hydraulic mount: a mass behind the stiffness of its chamber, with turbulent losses.
#[derive(Clone, Debug)]
pub struct InertiaTrack {
    pub stiffness: f64,
    pub mass: f64,
    pub linear: f64,
    pub quadratic: f64,
    pub place: f64,
    pub speed: f64,
}

impl Part for InertiaTrack {
    fn force(&mut self, now: &Now) -> f64 {
        // A fiftieth of a radian of its own resonance keeps the semi-implicit steps accurate to a per cent.
        let count = substeps(now.dt * (self.stiffness / self.mass).sqrt(), 0.02);
        let dt = now.dt / f64::from(count);
        let start = now.y - now.v * now.dt;
        for step in 1..=count {
            let y = start + now.v * dt * f64::from(step);
            let pull = self.stiffness * (y - self.place);
            let loss = self.linear + self.quadratic * self.speed.abs();
            self.speed = (self.speed + dt * pull / self.mass) / (1.0 + dt * loss / self.mass);
            self.place += dt * self.speed;
        }
        self.stiffness * (now.y - self.place)
    }
}

/// A damper whose oil warms by its own losses and becomes thinner: force c·|v|^α / (1 + thinning·T).
#[derive(Clone, Debug)]
pub struct Warming {
    pub c: f64,
    pub alpha: f64,
    pub thinning: f64,
    /// Time constant of cooling.
    pub time: f64,
    pub temperature: f64,
}

impl Part for Warming {
    fn force(&mut self, now: &Now) -> f64 {
        let resistance = self.c / (1.0 + self.thinning * self.temperature);
        let force = PowerDamper {
            c: resistance,
            alpha: self.alpha,
        }
        .force(now);
        self.temperature += now.dt * (force * now.v - self.temperature / self.time);
        force
    }
}

/// A magnetorheological damper by Kwok et al.: a yield force that follows tanh(v + lead·y), whose size a current sets.
#[derive(Clone, Debug)]
pub struct TanhYield {
    pub force: f64,
    /// Speed at which most of it is reached.
    pub speed: f64,
    /// Width of the loop over velocity.
    pub lead: f64,
}

impl Part for TanhYield {
    fn force(&mut self, now: &Now) -> f64 {
        self.force * ((now.v + self.lead * now.y) / self.speed).tanh()
    }
}

/// A part whose force a control input sets: by idle + gain·i / (1 + i/saturation).
#[derive(Clone, Debug)]
pub struct Set {
    pub part: Box<dyn Part>,
    pub idle: f64,
    pub gain: f64,
    /// Control input at which half of the largest gain is reached.
    pub saturation: f64,
}

impl Part for Set {
    fn force(&mut self, now: &Now) -> f64 {
        let gained = self.gain * now.control / (1.0 + now.control / self.saturation);
        (self.idle + gained) * self.part.force(now)
    }
}
