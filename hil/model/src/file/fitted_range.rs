//! The operating range of a model.

use serde::{Deserialize, Serialize};

/// Range of motion that a model was fitted on. Outside it the model extrapolates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FittedRange {
    /// Smallest and largest displacement, mm.
    pub displacement: [f64; 2],
    /// Smallest and largest velocity, mm/s.
    pub velocity: [f64; 2],
}

impl FittedRange {
    /// The range of a motion with `displacement` in mm and `velocity` in mm/s; `None` for an empty motion.
    pub fn of<'a>(
        displacement: impl IntoIterator<Item = &'a f64>,
        velocity: impl IntoIterator<Item = &'a f64>,
    ) -> Option<Self> {
        Some(Self {
            displacement: range(displacement)?,
            velocity: range(velocity)?,
        })
    }

    /// How far a displacement in mm or a velocity in mm/s is beyond these ranges, as a fraction of the larger end; 0 inside.
    pub fn beyond(&self, displacement: f64, velocity: f64) -> f64 {
        let [y, v] = self.exceeded_in(&Self {
            displacement: [displacement; 2],
            velocity: [velocity; 2],
        });
        y.max(v)
    }

    /// How far a motion's displacement and velocity exceed these ranges, each as a fraction of the larger end; 0 inside.
    pub fn exceeded_in(&self, motion: &Self) -> [f64; 2] {
        let beyond = |own: [f64; 2], other: [f64; 2]| {
            let reach = own[0].abs().max(own[1].abs());
            let excess = (own[0] - other[0]).max(other[1] - own[1]).max(0.0);
            if excess > 0.0 { excess / reach } else { 0.0 }
        };
        [
            beyond(self.displacement, motion.displacement),
            beyond(self.velocity, motion.velocity),
        ]
    }
}

fn range<'a>(values: impl IntoIterator<Item = &'a f64>) -> Option<[f64; 2]> {
    values.into_iter().fold(None, |range, &value| {
        let [low, high] = range.unwrap_or([value, value]);
        Some([value.min(low), value.max(high)])
    })
}
