//! Sums over a cycle for its statistics. 32 samples are enough, because the sums are over whole cycles.

/// Sums over one cycle's samples of displacement y, velocity v, force f of the law as given, residual r of the measured force, and
/// share s: the force of the running law minus f.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CycleSums {
    samples: f32,
    yy: f32,
    yf: f32,
    yyyf: f32,
    yr: f32,
    yyyr: f32,
    ff: f32,
    rr: f32,
    vf: f32,
    s: f32,
    vs: f32,
}

/// One sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Displacement, mm.
    pub(super) displacement: f32,
    /// Velocity, mm/s.
    pub(super) velocity: f32,
    /// Measured force, kN.
    pub(super) measured: f32,
    /// Force of the law as given, kN.
    pub(super) given: f32,
    /// Force of the running law minus that, kN.
    pub(super) share: f32,
}

/// Parts of a cycle's residual in phase with displacement, relative to the law's force in phase with it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct InPhase {
    /// First harmonic of the residual.
    pub(super) stiffness: f32,
    /// Third harmonic of the residual.
    pub(super) third: f32,
    /// Third harmonic of the law's force.
    pub(super) law_third: f32,
    /// Amplitude of the displacement's first harmonic, mm.
    pub(super) amplitude: f32,
    /// Amplitude of the law's force in phase with displacement, kN.
    pub(super) force: f32,
}

impl CycleSums {
    /// Adds one sample.
    #[inline]
    pub(super) fn add(&mut self, sample: &Sample) {
        let (y, v, f, s) = (
            sample.displacement,
            sample.velocity,
            sample.given,
            sample.share,
        );
        let r = sample.measured - f;
        let yy = y * y;
        let yf = y * f;
        let yr = y * r;
        self.samples += 1.0;
        self.yy += yy;
        self.yf += yf;
        self.yyyf += yy * yf;
        self.yr += yr;
        self.yyyr += yy * yr;
        self.ff += f * f;
        self.rr += r * r;
        self.vf += v * f;
        self.s += s;
        self.vs += v * s;
    }

    /// RMS of the residual divided by that of the law's force; 0 if the quotient does not exist.
    pub(super) fn residual(&self) -> f32 {
        let ratio = crate::real::square_root(self.rr / self.ff);
        if ratio.is_finite() { ratio } else { 0.0 }
    }

    /// Energy of the law as given, as a part of that of the running law: Σv·f divided by Σv·(f + s).
    pub(super) fn given_energy(&self) -> f32 {
        if self.vs == 0.0 {
            1.0
        } else {
            self.vf / (self.vf + self.vs)
        }
    }

    /// Mean of the share, kN.
    pub(super) fn mean_share(&self) -> f32 {
        self.s / self.samples
    }

    /// With s = y/A and A² = 2·Σy²/n: Σr·s divided by Σf·s, and Σr·sin 3φ divided by the same, with sin 3φ = 3·s − 4·s³. `None`
    /// without motion, or if the law has no force.
    pub(super) fn in_phase(&self) -> Option<InPhase> {
        let square = 2.0 * self.yy / self.samples;
        if !(square > f32::MIN_POSITIVE && self.yf > f32::MIN_POSITIVE) {
            return None;
        }
        let amplitude = crate::real::square_root(square);
        let third = |first: f32, cubic: f32| (3.0 * first - 4.0 * cubic / square) / self.yf;
        Some(InPhase {
            stiffness: self.yr / self.yf,
            third: third(self.yr, self.yyyr),
            law_third: third(self.yf, self.yyyf),
            amplitude,
            force: 2.0 * self.yf / (self.samples * amplitude),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F = 2·y + 0.5·v of the law as given, plus 0.1·(y + 0.4) + 0.05·v, over a circle about y = 0.2.
    #[test]
    fn they_are_of_the_law_as_it_was_given() {
        let mut sums = CycleSums::default();
        for look in 0..32u16 {
            let phase = core::f32::consts::TAU * f32::from(look) / 32.0;
            let (y, v) = (0.2 + libm::sinf(phase), libm::cosf(phase));
            let given = 2.0 * y + 0.5 * v;
            sums.add(&Sample {
                displacement: y,
                velocity: v,
                measured: 0.9 * given,
                given,
                share: 0.1 * (y + 0.4) + 0.05 * v,
            });
        }
        assert!((sums.residual() - 0.1).abs() < 1e-6);
        assert!((sums.given_energy() - 0.5 / 0.55).abs() < 1e-6);
        assert!((sums.mean_share() - 0.06).abs() < 1e-6);
        assert_eq!(CycleSums::default().residual(), 0.0);
    }
}
