//! Sums over a cycle from which its statistics come: 64 samples are enough, as they are of whole cycles.

/// Sums over one cycle's samples of displacement y, law's force f and residual r.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CycleSums {
    samples: f32,
    yy: f32,
    yf: f32,
    yyyf: f32,
    yr: f32,
    yyyr: f32,
}

/// What of a cycle's residual is in phase with displacement, parts of the law's force in phase with it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct InPhase {
    /// First harmonic of the residual.
    pub(super) stiffness: f32,
    /// Third.
    pub(super) third: f32,
    /// Third of the law's force.
    pub(super) law_third: f32,
    /// Amplitude of the displacement's first harmonic, mm.
    pub(super) amplitude: f32,
    /// Amplitude of the law's force in phase with displacement, kN.
    pub(super) force: f32,
}

impl CycleSums {
    /// One sample: mm, kN, kN.
    #[inline]
    pub(super) fn add(&mut self, y: f32, law: f32, residual: f32) {
        let yy = y * y;
        let yr = y * residual;
        self.samples += 1.0;
        self.yy += yy;
        let yf = y * law;
        self.yf += yf;
        self.yyyf += yy * yf;
        self.yr += yr;
        self.yyyr += yy * yr;
    }

    /// With s = y/A and A² = 2·Σy²/n: Σr·s over Σf·s, and Σr·sin 3φ over the same with sin 3φ = 3·s − 4·s³. None where
    /// nothing moved or the law has no force.
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
