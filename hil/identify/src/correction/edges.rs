//! Possible contacts: the edges of zones of displacement at which friction and damping change.

use mesh_damper_model::correction::Remembered;

use super::design::{Coefficients, Design};
use super::gram::{GramRows, TableForm};
use super::trend::Trend;

mesh_damper_recording::numbers! {
    /// Where something may touch, as an edge in a residual table.
    EdgesPolicy {
        /// To find edges beyond which something touches, the range of the displacement is divided into this many zones, each with
        /// its own friction and damping.
        zones: usize = 40, Tuned("the blind trial");
    }
}

/// Contacts on one side, and on both, placed so that friction and damping of the zones beyond eq 13 are most alike within each
/// part.
pub(super) fn likely_sides(design: &Design, at: &Coefficients) -> Option<[Vec<Remembered>; 2]> {
    let (zones, power) = design.zones(EdgesPolicy::in_use().zones);
    let of_zones = (0..2 * EdgesPolicy::in_use().zones).map(|cell| Trend::of(vec![(cell, 1.0)]));
    let trends: Vec<Trend> = of_zones.collect();
    let form = TableForm {
        trends: &trends,
        ..TableForm::NONE
    };
    let rows = GramRows::over(design, at, Some(&zones));
    let cells = rows.solved(form)?.cells;
    let (friction, damping) =
        cells[..2 * EdgesPolicy::in_use().zones].split_at(EdgesPolicy::in_use().zones);

    // Σ w·(x − mean)² over the zones of one part.
    let unlike = |from: usize, to: usize| -> f64 {
        let one = |values: &[f64], power: &[f64]| {
            let (values, power) = (&values[from..to], &power[from..to]);
            let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
                let weighted = values
                    .iter()
                    .zip(power)
                    .map(|(value, power)| power * of(*value));
                weighted.sum()
            };
            sum(&|value| value * value) - sum(&|value| value).powi(2) / sum(&|_| 1.0).max(1e-12)
        };
        one(friction, &power[0]) + one(damping, &power[1])
    };
    let edge = |zone: usize| {
        (2.0 * zone as f64 / EdgesPolicy::in_use().zones as f64 - 1.0) * design.reach.displacement
    };
    let pair = |below: usize, above: usize| {
        let left =
            unlike(0, below) + unlike(below, above) + unlike(above, EdgesPolicy::in_use().zones);
        let sides = Remembered::Sides {
            below: edge(below),
            above: edge(above),
        };
        (left, sides)
    };
    let best = |pairs: &mut dyn Iterator<Item = (usize, usize)>| {
        let pairs = pairs.map(|(below, above)| pair(below, above));
        let best = pairs.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, sides)| sides)
    };
    let mut one = (1..EdgesPolicy::in_use().zones).map(|above| (0, above));
    let mut as_far = (EdgesPolicy::in_use().zones / 2 + 1..EdgesPolicy::in_use().zones)
        .map(|above| (EdgesPolicy::in_use().zones - above, above));
    let mut two = (1..EdgesPolicy::in_use().zones).flat_map(|below| {
        (below + 1..EdgesPolicy::in_use().zones).map(move |above| (below, above))
    });
    let both = [best(&mut as_far), best(&mut two)];
    Some([
        best(&mut one).into_iter().collect(),
        both.into_iter().flatten().collect(),
    ])
}
