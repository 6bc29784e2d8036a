//! Laws within the ranges that their constructors accept, including the ends of the ranges.

use mesh_damper::effects::{AugmentedLaw, DESCRIPTIONS, Effect};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;

use crate::feed::Feed;

/// Largest number of effects of a law, as in the image.
pub const EFFECTS: usize = 8;

/// A law with any effects that add a force, and any stages, for a tick of `tick` s.
pub fn law(feed: &mut Feed<'_>, tick: f64) -> AugmentedLaw<f32, EFFECTS> {
    let (k1, k3) = (feed.either(1e-6, 1e9), feed.either(1e-6, 1e9));
    let (c, alpha) = (feed.between(1e-6, 1e9), feed.part());
    let eq_13 = Law::new(k1 as f32, k3 as f32, c as f32, alpha as f32);
    let mut law = AugmentedLaw::new(eq_13.expect("all are in range"));
    for _ in 0..feed.byte() % 9 {
        // A second effect of the same kind is refused, and so is an end of the range that f32 rounds outwards.
        if let Ok(effect) = effect(feed, tick)
            && let Ok(more) = law.clone().with(effect)
        {
            law = more;
        }
    }
    law
}

/// Any effect of the crate with any number of elements, each parameter anywhere in its range.
fn effect(feed: &mut Feed<'_>, tick: f64) -> Result<Effect<f32>, ConfigError> {
    let description = &DESCRIPTIONS[usize::from(feed.byte()) % DESCRIPTIONS.len()];
    let elements = 1 + usize::from(feed.byte()) % description.most;
    let mut parameters = Vec::new();
    for _ in 0..elements {
        for parameter in description.parameters {
            let [low, high] = parameter.range;
            let least = 1e-9 * high;
            parameters.push(match parameter.unit {
                _ if parameter.name == "input" => f64::from(feed.byte() % 4),
                // A tone must be slower than half of the tick rate.
                "Hz" => feed.between(low, 0.499 / tick),
                _ if low < 0.0 => feed.either(least, high).max(low),
                _ => feed.between(low.max(least), high),
            });
        }
    }
    Effect::from_parameters(description.number, &parameters, tick)
}
