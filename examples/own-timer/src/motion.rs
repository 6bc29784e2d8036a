//! The motion: sines of two amplitudes and two frequencies. The test that runs this firmware also reads this file.

/// A run of cycles of one sine.
pub struct Sine {
    /// mm.
    pub amplitude: f64,
    /// Hz.
    pub frequency: f64,
}

/// The sines in order, with ramps between them.
pub const SINES: [Sine; 3] = [
    Sine {
        amplitude: 0.1,
        frequency: 5.0,
    },
    Sine {
        amplitude: 0.2,
        frequency: 5.0,
    },
    Sine {
        amplitude: 0.1,
        frequency: 10.0,
    },
];

/// Cycles of each sine, and of each ramp.
pub const CYCLES: u32 = 3;
/// Cycles of the ramp before each sine and after it.
pub const RAMP_CYCLES: u32 = 1;
