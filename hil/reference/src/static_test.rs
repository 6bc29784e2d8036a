//! Quasistatic compression, eqs 1 and 2.

/// Results of a load–unload curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticResult {
    /// Elastic potential U: area under the middle line of the loop, kN·mm = J.
    pub elastic_potential: f64,
    /// Energy dissipation ΔW: area of the loop, J.
    pub dissipated: f64,
    /// Equivalent stiffness, eq 1: k_eq = 2U / x_max², kN/mm.
    pub equivalent_stiffness: f64,
    /// Static loss factor, eq 2: η_s = ΔW / (πU).
    pub loss_factor: f64,
}

/// Eqs 1 and 2 for a curve that is loaded from 0 mm to its largest displacement and unloaded again.
///
/// `displacement` in mm and `force` in kN, in order of time; integrated by the trapezoidal rule. The middle line is the mean of the
/// two branches at each displacement, so that U is the mean of the areas below them. If the unloading curve ends before 0 mm (a
/// residual set), its force counts as 0 from there.
///
/// `None` if the lengths differ, nothing was displaced, or the elastic potential is not positive.
pub fn characterize(displacement: &[f64], force: &[f64]) -> Option<StaticResult> {
    if displacement.len() != force.len() {
        return None;
    }
    let peak =
        (0..displacement.len()).max_by(|&a, &b| displacement[a].total_cmp(&displacement[b]))?;
    let largest = displacement[peak];
    let area = |from: usize, to: usize| -> f64 {
        (from..to)
            .map(|i| 0.5 * (force[i] + force[i + 1]) * (displacement[i + 1] - displacement[i]))
            .sum()
    };
    let loading = area(0, peak);
    let unloading = -area(peak, displacement.len() - 1);
    let elastic_potential = 0.5 * (loading + unloading);
    let dissipated = loading - unloading;
    if !(largest > 0.0 && elastic_potential > 0.0) {
        return None;
    }
    Some(StaticResult {
        elastic_potential,
        dissipated,
        equivalent_stiffness: 2.0 * elastic_potential / (largest * largest),
        loss_factor: dissipated / (std::f64::consts::PI * elastic_potential),
    })
}
