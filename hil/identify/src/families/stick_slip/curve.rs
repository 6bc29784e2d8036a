//! Hardening friction along its two curves.
//!
//! Its slope depends on its stretch alone, so that the stretch over the way is one curve away from 0 and one back. A fit computes both once
//! for its shapes and goes along them, in the place of two powers and an exponential a step.

use mesh_damper_model::predict::motion_at;

use super::super::Path;

/// Steps of a curve. Convention: cubics between them are far nearer to it than the steps of a recording.
const STEPS: usize = 256;

/// z over the way w of dz/dw = 1 + rise·zⁿ from 0 to 1.
struct Curve {
    step: f64,
    stretch: Vec<f64>,
    slope: Vec<f64>,
}

impl Curve {
    fn of(rise: f64, sharpness: f64) -> Self {
        let slope = |z: f64| 1.0 + rise * z.powf(sharpness);
        // With z = t², because the slope of the bluntest one changes steeply next to 0.
        let density = |t: f64| 2.0 * t / slope(t * t);
        let simpson = |n: usize| {
            let [from, to] = [n, n + 1].map(|n| n as f64 / STEPS as f64);
            (density(from) + 4.0 * density(0.5 * (from + to)) + density(to)) / (6.0 * STEPS as f64)
        };
        let step = (0..STEPS).map(simpson).sum::<f64>() / STEPS as f64;
        let mut stretch = vec![0.0];
        for _ in 0..STEPS {
            let z = stretch[stretch.len() - 1];
            let a = slope(z);
            let b = slope(z + 0.5 * step * a);
            let c = slope(z + 0.5 * step * b);
            let d = slope(z + step * c);
            stretch.push(z + step * (a + 2.0 * (b + c) + d) / 6.0);
        }
        // Next to 0 the bluntest one is not followed exactly.
        stretch[STEPS] = 1.0;
        Self {
            step,
            slope: stretch.iter().map(|&z| slope(z)).collect(),
            stretch,
        }
    }

    fn longest(&self) -> f64 {
        self.step * STEPS as f64
    }

    /// The stretch after a way of at least 0; 1 beyond the end.
    fn at(&self, way: f64) -> f64 {
        let place = way / self.step;
        let cell = place as usize;
        if cell >= STEPS {
            return 1.0;
        }
        let part = place - cell as f64;
        let rest = 1.0 - part;
        let [z0, z1] = [self.stretch[cell], self.stretch[cell + 1]];
        let [s0, s1] = [self.slope[cell], self.slope[cell + 1]].map(|slope| slope * self.step);
        rest * rest * ((1.0 + 2.0 * part) * z0 + part * s0)
            + part * part * ((1.0 + 2.0 * rest) * z1 - rest * s1)
    }

    /// The way to a stretch of 0 to 1, by bisection: the motion may turn at every sample, so that errors would add up.
    fn way_to(&self, stretch: f64) -> f64 {
        if stretch >= 1.0 {
            return self.longest();
        }
        let after = self.stretch.partition_point(|&z| z <= stretch);
        let cell = after.clamp(1, STEPS) - 1;
        let [mut low, mut high] = [cell, cell + 1].map(|cell| self.step * cell as f64);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.at(middle) < stretch {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// Where the stretch is on a curve.
#[derive(Clone, Copy)]
struct Place {
    is_upwards: bool,
    is_away: bool,
    way: f64,
}

/// The stretch in mm along a path, with this limit in mm; 0 at the samples that the path passes over.
pub(super) fn stretched(
    limit: f64,
    sharpness: f64,
    hardening: f64,
    loss: f64,
    path: &Path,
) -> Vec<f64> {
    let [away, back] = [hardening, hardening + loss].map(|rise| Curve::of(rise, sharpness));
    let mut stretched = vec![0.0; path.motion.len()];
    let mut before = None;
    let mut stretch = 0.0;
    let mut place: Option<Place> = None;
    for sample in path.strides.iter().flat_map(|stride| stride.visits()) {
        let displacement = motion_at::<f64>(path.motion, sample)
            .clamped()
            .displacement();
        let step = (displacement - before.replace(displacement).unwrap_or(displacement)) / limit;
        if step == 0.0 {
            stretched[sample] = limit * stretch;
            continue;
        }
        let is_upwards = step > 0.0;
        let sign = if is_upwards { 1.0 } else { -1.0 };
        let is_away = sign * stretch >= 0.0;
        let curve = if is_away { &away } else { &back };
        let goes_on = |at: &Place| at.is_upwards == is_upwards && at.is_away == is_away;
        let known = place.filter(goes_on).map(|at| at.way);
        let way = known.unwrap_or_else(|| curve.way_to(f64::abs(stretch)));
        let (is_away, way) = match is_away {
            true => (true, way + step.abs()),
            false if way > step.abs() => (false, way - step.abs()),
            // Beyond 0 it goes on away from there.
            false => (true, step.abs() - way),
        };
        stretch = match is_away {
            true => sign * away.at(way),
            false => -sign * back.at(way),
        };
        place = Some(Place {
            is_upwards,
            is_away,
            way,
        });
        stretched[sample] = limit * stretch;
    }
    stretched
}

#[cfg(test)]
mod tests {
    use mesh_damper::effects::HardeningFriction;
    use mesh_damper_recording::trajectory::Trajectory;
    use mesh_damper_recording::trajectory::strides::Stride;

    use super::super::super::run;
    use super::*;

    #[test]
    fn a_turn_changes_no_stretch() {
        for sharpness in [0.5, 1.0, 3.0] {
            for rise in [4.0, 44.0, 164.0] {
                let curve = Curve::of(rise, sharpness);
                assert_eq!(curve.way_to(1.0), curve.longest());
                for z in (0..1000).map(|n| f64::from(n) / 1000.0) {
                    let off = (curve.at(curve.way_to(z)) - z).abs();
                    assert!(off < 1e-9, "{sharpness} {rise} {z}: {off}");
                }
            }
        }
    }

    /// Beside the crate, in steps of at most a three-hundredth of the limit.
    #[test]
    fn the_curves_are_those_of_the_crate() {
        let moved = |n: i32| {
            let t = 2e-4 * f64::from(n);
            0.3 * (2.1 * t).sin() + 0.15 * (7.3 * t).sin()
        };
        let displacement: Vec<f64> = (0..40_000).map(moved).collect();
        let force = displacement.clone();
        let motion = Trajectory::new("two", 2e-4, &displacement, force, None, None);
        let strides = Stride::each(motion.len());
        let path = Path {
            motion: &motion,
            strides: &strides,
        };
        for limit in [0.1, 0.4, 2.0] {
            for sharpness in [0.5, 1.0, 3.0] {
                for loss in [0.4, 10.0, 40.0] {
                    let friction = HardeningFriction::new(1.0, limit, sharpness, 4.0, loss);
                    let exact = run(friction, &path).unwrap();
                    let along = stretched(limit, sharpness, 4.0, loss, &path);
                    let off = exact.iter().zip(&along).map(|(a, b)| (a - b).abs());
                    let off = off.fold(0.0, f64::max) / limit;
                    // The crate's own step is coarse where z falls steeply.
                    assert!(
                        off < 2e-3 + 1e-4 * loss,
                        "{limit} {sharpness} {loss}: {off}"
                    );
                }
            }
        }
    }
}
