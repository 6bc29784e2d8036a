//! Stiffness and loss factor of a recording, computed as the paper characterizes specimens: eqs 1 and 2 for a load–unload curve,
//! eqs 3–7 for cycles.
//!
//! ```
//! use mesh_damper_characterize::static_test;
//! use mesh_damper_recording::Recording;
//!
//! // To 0.5 mm and back in 100 s: 2 kN/mm, and 0.05 kN of friction.
//! let time: Vec<f64> = (0..=200).map(|i| f64::from(i) * 0.5).collect();
//! let x: Vec<f64> = time.iter().map(|t| 0.5 - 0.01 * (t - 50.0).abs()).collect();
//! let friction = |t: f64| if t <= 50.0 { 0.05 } else { -0.05 };
//! let force = time.iter().zip(&x).map(|(&t, x)| 2.0 * x + friction(t)).collect();
//! let test = static_test(&Recording::new("press", time, x, force)?)?;
//! assert_eq!(test.cycles.len(), 1);
//! # Ok::<(), mesh_damper_output::error::InputError>(())
//! ```

#![forbid(unsafe_code)]

mod branches;
mod dynamic;
mod harmonics;
mod quasistatic;

pub use dynamic::{
    DynamicBlock, DynamicCycle, DynamicTest, Figures, dynamic_test, dynamic_test_on,
};
pub use quasistatic::{StaticCycle, StaticTest, static_test};

use serde::Serialize;

/// Mean and scatter of a figure over cycles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spread {
    /// Mean over the cycles.
    pub mean: f64,
    /// Standard deviation from cycle to cycle; null for a single cycle.
    pub deviation: Option<f64>,
}

fn spread(values: &[f64]) -> Spread {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Spread {
        mean,
        deviation: (values.len() > 1).then(|| (square / (count - 1.0)).sqrt()),
    }
}
