//! Whether an extended law is better than the law alone on conditions that it was not fitted to.

use super::relative_error::RelativeError;
use crate::trace::unexplained::UnexplainedPolicy;

mesh_damper_recording::numbers! {
    /// When a law with effects or a table is adopted in place of the law alone.
    AdoptPolicy {
        /// Effects or a table are adopted only if they leave less than this fraction of the law's error beyond the noise, on conditions
        /// held out in turn: both as an RMS and as a geometric mean.
        gain: f64 = 0.98, Convention("two per cent is no gain");
    }
}

/// Whether the law `with` more predicts conditions held out in turn better than the law `alone`. It must do so in total, where the
/// worst conditions count most, and on average over conditions, where each counts equally. A law that wins on one of the two only
/// would lose on the next condition.
pub(super) fn gains(alone: &[RelativeError], with: &[RelativeError]) -> bool {
    gains_by(AdoptPolicy::in_use().gain, alone, with)
}

/// The same, with the threshold by which one law is [clearly better](super::unexplained::UnexplainedPolicy::better) than another.
pub(super) fn gains_clearly(alone: &[RelativeError], with: &[RelativeError]) -> bool {
    gains_by(UnexplainedPolicy::in_use().better, alone, with)
}

fn gains_by(gain: f64, alone: &[RelativeError], with: &[RelativeError]) -> bool {
    let pairs = || {
        let each = alone.iter().zip(with);
        each.map(|(alone, with)| [alone.beyond_noise(), with.beyond_noise()])
    };
    // A condition with nearly equal errors says nothing, however large they are: the coefficients of an amplitude that occurs in
    // one condition only may be far off with both laws.
    let same = -AdoptPolicy::in_use().gain.ln();
    let differ = |[alone, with]: &[f64; 2]| (with / alone).ln().abs() > same;
    let squares = pairs().filter(differ).fold([0.0; 2], |sum, pair| {
        [sum[0] + pair[0].powi(2), sum[1] + pair[1].powi(2)]
    });
    let logs = pairs().map(|[alone, with]| (with / alone).ln());
    let mean_ratio = (logs.sum::<f64>() / alone.len() as f64).exp();
    // The error beyond the noise is 0 for NaN.
    let finite = with.iter().all(|one| one.error.is_finite());
    finite && squares[1] < gain * gain * squares[0] && mean_ratio < gain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(errors: &[f64]) -> Vec<RelativeError> {
        let each = errors.iter();
        each.map(|error| RelativeError {
            error: error * error,
            noise: 1e-6,
        })
        .collect()
    }

    #[test]
    fn a_gain_is_one_in_all_and_from_one_condition_to_the_next() {
        let alone = errors(&[0.1, 0.2, 0.3, 0.1]);
        assert!(gains(&alone, &errors(&[0.05, 0.1, 0.15, 0.05])));
        assert!(
            gains(&alone, &errors(&[0.1, 0.2, 0.05, 0.1])),
            "an effect of one condition"
        );
        assert!(!gains(&alone, &errors(&[0.15, 0.3, 0.1, 0.15])));
        assert!(
            !gains(&alone, &errors(&[0.02, 0.05, 0.9, 0.02])),
            "a loss that outweighs"
        );
        let far_off = [0.1, 0.2, 0.3, 9.0];
        assert!(
            gains(&errors(&far_off), &errors(&[0.05, 0.1, 0.15, 9.05])),
            "what both know nothing of"
        );
        assert!(!gains(&errors(&far_off), &errors(&[0.05, 0.1, 0.15, 9.5])));
        assert!(!gains(&alone, &alone));
        assert!(!gains(&alone, &errors(&[f64::NAN; 4])));
    }
}
