//! Laws within the ranges that their constructors give, their ends included.

use mesh_damper::effects::{AugmentedLaw, EffectParameters};
use mesh_damper::law::Law;

use crate::feed::Feed;

/// Most effects of a law, as in the image.
pub const EFFECTS: usize = 8;

/// A law with any of the effects that add a force, and the stages, for a tick of `tick` s.
pub fn law(feed: &mut Feed<'_>, tick: f64) -> AugmentedLaw<f32, EFFECTS> {
    let (k1, k3) = (feed.either(1e-6, 1e9), feed.either(1e-6, 1e9));
    let (c, alpha) = (feed.between(1e-6, 1e9), feed.part());
    let eq_13 = Law::new(k1 as f32, k3 as f32, c as f32, alpha as f32);
    let mut law = AugmentedLaw::new(eq_13.expect("all are in range"));
    for _ in 0..feed.byte() % 9 {
        // One that is there already, or an end that f32 rounds outwards, is refused.
        if let Ok(effect) = parameters(feed, tick).effect()
            && let Ok(more) = law.clone().with(effect)
        {
            law = more;
        }
    }
    law
}

fn parameters(feed: &mut Feed<'_>, tick: f64) -> EffectParameters<f32> {
    let coefficient = |feed: &mut Feed<'_>| feed.either(1e-6, 1e9) as f32;
    let length = |feed: &mut Feed<'_>| feed.between(1e-9, 1e4) as f32;
    match feed.byte() % 16 {
        0 => EffectParameters::Offset {
            force: coefficient(feed),
        },
        1 => EffectParameters::Asymmetry {
            k2: coefficient(feed),
        },
        2 => EffectParameters::Hardening {
            k5: coefficient(feed),
        },
        3 => EffectParameters::StickSlip(
            (0..1 + feed.byte() % 6)
                .map(|_| (coefficient(feed), length(feed)))
                .collect(),
        ),
        4 => EffectParameters::Viscous {
            c1: coefficient(feed),
        },
        5 => EffectParameters::Relaxation {
            branches: (0..1 + feed.byte() % 3)
                .map(|_| (coefficient(feed), feed.between(1e-6, 1e6) as f32))
                .collect(),
            tick: tick as f32,
        },
        6 => EffectParameters::Inertia {
            mass: feed.either(1e-6, 1e6) as f32,
        },
        7 => EffectParameters::LoadFriction {
            load: feed.between(1e-6, 1e6) as f32,
        },
        8 => EffectParameters::Drift {
            stiffness: coefficient(feed),
            cycles: feed.between(0.1, 1e9) as f32,
            elastic_change: feed.between(1e-6, 1e3) as f32 - 1.0,
            damping_change: feed.between(1e-6, 1e3) as f32 - 1.0,
        },
        9 => EffectParameters::Temperature {
            beta: feed.either(1e-6, 1.0) as f32,
            beta_damping: feed.either(1e-6, 1.0) as f32,
            reference: feed.either(1e-3, 273.0) as f32,
        },
        10 => EffectParameters::Stop(
            [
                (feed.between(1e-9, 1e9) as f32, length(feed)),
                (feed.between(1e-9, 1e9) as f32, -length(feed)),
            ]
            .into_iter()
            .collect(),
        ),
        11 => EffectParameters::BoucWen {
            stiffness: coefficient(feed),
            slip_limit: length(feed),
            sharpness: feed.between(0.5, 8.0) as f32,
        },
        12 => EffectParameters::Periodic {
            tones: (0..1 + feed.byte() % 3)
                .map(|_| {
                    let frequency = feed.between(1e-6, 0.499 / tick);
                    (coefficient(feed), frequency, feed.either(1e-3, 1e3))
                })
                .collect(),
            tick,
        },
        13 => EffectParameters::Gap {
            half_width: length(feed),
            damps_inside: feed.byte().is_multiple_of(2),
        },
        14 => EffectParameters::Compliance {
            stiffness: feed.between(1e-3, 1e9) as f32,
            tick: tick as f32,
        },
        _ => EffectParameters::Delay {
            time: (255.0 * tick * feed.part()) as f32,
            tick: tick as f32,
        },
    }
}
