//! Polynomials through equidistant samples.

/// Coefficients of the cubic through a window, about the window's own sample, in units of ticks.
pub(super) struct Cubic {
    pub value: f64,
    pub slope: f64,
    pub curvature: f64,
    /// Variance of the slope for noise of variance 1.
    pub slope_variance: f64,
    /// Sum of squares of the residual.
    pub error: f64,
}

/// Least-squares polynomial of `degree` ≤ 3 through equidistant samples, evaluated at position `at` in ticks from the
/// first.
///
/// The abscissa is scaled to −1…1, and the three-term recurrence of the discrete Legendre (Gram) polynomials makes the basis
/// orthogonal, so that no normal equations have to be solved.
pub(super) fn fit_polynomial(samples: &[f64], at: f64, degree: usize) -> Cubic {
    let count = samples.len() as f64;
    let centre = 0.5 * (count - 1.0);
    let scale = centre.max(1.0);
    let x_at = (at - centre) / scale;

    // Monic polynomials orthogonal over the symmetric grid: p[j+1] = x·p[j] − b[j]·p[j−1].
    let mut recurrence = [0.0; 4];
    let mut norms = [0.0; 4];
    let mut projections = [0.0; 4];
    for j in 0..=degree {
        let (mut norm, mut projection) = (0.0, 0.0);
        for (i, &sample) in samples.iter().enumerate() {
            let x = (i as f64 - centre) / scale;
            let p = gram(&recurrence, j, x)[0];
            norm += p * p;
            projection += p * sample;
        }
        norms[j] = norm;
        projections[j] = projection;
        if j > 0 {
            recurrence[j] = norm / norms[j - 1];
        }
    }
    let mut cubic = Cubic {
        value: 0.0,
        slope: 0.0,
        curvature: 0.0,
        slope_variance: 0.0,
        error: samples.iter().map(|y| y * y).sum(),
    };
    for j in 0..=degree {
        let [p, slope, curvature] = gram(&recurrence, j, x_at);
        let coefficient = projections[j] / norms[j];
        cubic.error -= coefficient * projections[j];
        cubic.value += coefficient * p;
        cubic.slope += coefficient * slope / scale;
        cubic.curvature += coefficient * curvature / (scale * scale);
        cubic.slope_variance += slope * slope / (scale * scale) / norms[j];
    }
    cubic
}

/// Sum of squares of the residual of the least-squares polynomial of any `degree` through equidistant samples; 0 if there are no
/// more samples than coefficients.
pub(super) fn left_by_polynomial(samples: &[f64], degree: usize) -> f64 {
    if samples.len() <= degree + 1 {
        return 0.0;
    }
    let centre = 0.5 * (samples.len() as f64 - 1.0);
    let place = |index: usize| index as f64 / centre - 1.0;
    // The Gram polynomials' values, by the same recurrence as above; the residual is updated along the way, so that nothing
    // cancels.
    let mut before = vec![0.0; samples.len()];
    let mut now = vec![1.0; samples.len()];
    let mut left = samples.to_vec();
    let mut last_norm = f64::INFINITY;
    for _ in 0..=degree {
        let norm: f64 = now.iter().map(|p| p * p).sum();
        let projection: f64 = now.iter().zip(&left).map(|(p, y)| p * y).sum();
        let coefficient = projection / norm;
        for (left, p) in left.iter_mut().zip(&now) {
            *left -= coefficient * p;
        }
        let recurrence = norm / last_norm;
        last_norm = norm;
        for (index, (now, before)) in now.iter_mut().zip(&mut before).enumerate() {
            let next = place(index) * *now - recurrence * *before;
            *before = *now;
            *now = next;
        }
    }
    left.iter().map(|y| y * y).sum()
}

/// The Gram polynomial of degree `j` with its first two derivatives at `x`.
#[inline]
fn gram(recurrence: &[f64; 4], j: usize, x: f64) -> [f64; 3] {
    let b1 = recurrence[1];
    match j {
        0 => [1.0, 0.0, 0.0],
        1 => [x, 1.0, 0.0],
        2 => [x * x - b1, 2.0 * x, 2.0],
        _ => {
            let b = b1 + recurrence[2];
            [x * (x * x - b), 3.0 * x * x - b, 6.0 * x]
        }
    }
}
