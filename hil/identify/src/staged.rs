//! Identification in two stages, as in the paper: a cubic for the elastic force (eq 14), then c and α from the residual (eq 15),
//! amplitude by amplitude.
//!
//! The joint fit of [`super::problem`] is the default. Published coefficients come from this one, and it shows the gain of the
//! joint fit.

use mesh_damper_model::LawNode;
use mesh_damper_reference::cubic_fit::identify;

use super::rows::Rows;

/// Eq 13 at every node of `rows`, identified in two stages.
///
/// `None` if a stage fails, or gives a coefficient that no damper has: c below 0, α outside 0…1.
pub fn staged(rows: &Rows) -> Option<Vec<LawNode>> {
    rows.nodes
        .iter()
        .enumerate()
        .map(|(node, &amplitude)| {
            let (displacement, velocity, force) = rows.channels(node);
            let found = identify(&displacement, &velocity, &force)?;
            let admissible = found.c >= 0.0 && (0.0..=1.0).contains(&found.alpha);
            admissible.then_some(LawNode {
                amplitude,
                k1: found.k1,
                k3: found.k3,
                c: found.c,
                alpha: found.alpha,
            })
        })
        .collect()
}
