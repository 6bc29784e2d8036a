//! Solves for both figures at once in one cell of the grid, by Newton's method.

use super::Wanted;
use super::search::misfit;

/// Starts of Newton's method in a cell, in each direction.
const STARTS: usize = 3;
/// Most of its steps.
const STEPS: usize = 60;
/// Logarithms of K/K* and η/η* below this count as 0.
const EXACT: f64 = 1e-9;

/// A cell of the grid, in which both figures are smooth.
pub(super) struct Cell<'w> {
    pub wanted: &'w Wanted,
    /// From and to, g/cm³.
    pub density: (f64, f64),
    /// From and to, mm.
    pub amplitude: (f64, f64),
}

impl Cell<'_> {
    /// Densities and amplitudes within it at which both figures have the required values; a point may occur more than once.
    pub(super) fn solutions(&self) -> impl Iterator<Item = (f64, f64)> {
        let part = |i: usize| (i as f64 + 0.5) / STARTS as f64;
        (0..STARTS * STARTS).filter_map(move |i| self.newton(part(i / STARTS), part(i % STARTS)))
    }

    /// From a start within the cell, with both coordinates 0…1 there. It never leaves the cell, beyond which the coefficients have
    /// another slope.
    fn newton(&self, mut u: f64, mut w: f64) -> Option<(f64, f64)> {
        const DIFFERENCE: f64 = 1e-5;
        let point = |u: f64, w: f64| {
            let between = |(low, high): (f64, f64), part: f64| low + part * (high - low);
            (between(self.density, u), between(self.amplitude, w))
        };
        let at = |u: f64, w: f64| {
            let (density, amplitude) = point(u, w);
            misfit(self.wanted, density, amplitude)
        };
        let inwards = |part: f64| if part < 0.5 { DIFFERENCE } else { -DIFFERENCE };
        for _ in 0..STEPS {
            let here = at(u, w);
            if here.iter().all(|misfit| misfit.abs() < EXACT) {
                return Some(point(u, w));
            }
            let (du, dw) = (inwards(u), inwards(w));
            let (along_u, along_w) = (at(u + du, w), at(u, w + dw));
            let by_u = [0, 1].map(|i| (along_u[i] - here[i]) / du);
            let by_w = [0, 1].map(|i| (along_w[i] - here[i]) / dw);
            let determinant = by_u[0] * by_w[1] - by_u[1] * by_w[0];
            if determinant == 0.0 {
                return None;
            }
            let step_u = (here[0] * by_w[1] - here[1] * by_w[0]) / determinant;
            let step_w = (here[1] * by_u[0] - here[0] * by_u[1]) / determinant;
            // At most half a cell: the derivatives are not reliable further.
            let shortened = (0.5 / step_u.abs().max(step_w.abs())).min(1.0);
            (u, w) = (
                (u - shortened * step_u).clamp(0.0, 1.0),
                (w - shortened * step_w).clamp(0.0, 1.0),
            );
        }
        None
    }
}
