//! Which of several laws is written: by their errors on conditions that they were not fitted to.

use super::relative_error::RelativeError;

mesh_damper_recording::numbers! {
    /// When a law with effects or a table is adopted in place of the law alone.
    AdoptPolicy {
        /// Effects or a table are adopted only if they leave less than this fraction of the law's error beyond the noise, on conditions
        /// held out in turn, as a geometric mean and as an RMS.
        gain: f64 = 0.98, Convention("two per cent is no gain");
        /// A law is clearly better than another if its error beyond the noise is below this fraction of the other's.
        better: f64 = 0.95, Tuned("the blind trial");
        /// A table is adopted only if on no condition held out in turn its error beyond the noise exceeds this many times that of the law
        /// alone. Tables that help lose up to 1.2 at an end of their range, those that fail beyond it 1.5 and more.
        most_lost: f64 = 1.25, Tuned("the trial of conditions");
    }
}

/// Whether the law `with` more predicts conditions held out in turn better than the law `alone`. It must do so in total, where the
/// worst conditions count most, and on average over conditions, where each counts equally. A law that wins on one of the two only
/// would lose on the next condition.
pub(super) fn gains(alone: &[RelativeError], with: &[RelativeError]) -> bool {
    gains_by(AdoptPolicy::in_use().gain, alone, with)
}

/// The same, with the threshold by which one law is [clearly better](AdoptPolicy::better) than another.
pub(super) fn gains_clearly(alone: &[RelativeError], with: &[RelativeError]) -> bool {
    gains_by(AdoptPolicy::in_use().better, alone, with)
}

/// The errors of both laws on the conditions on which the law `alone` can be run: elsewhere its error has no size to compare with.
pub(super) fn comparable(
    alone: &[RelativeError],
    with: &[RelativeError],
) -> [Vec<RelativeError>; 2] {
    let pairs = alone.iter().zip(with);
    let (alone, with) = pairs.filter(|(alone, _)| alone.is_run()).unzip();
    [alone, with]
}

/// Whether the law `with` more is on no condition [far worse](AdoptPolicy::most_lost) than the law `alone`. A table fits any force, and so
/// may be far off beyond the motions that it was fitted to: the conditions at the ends of a range are such motions for the others.
pub(super) fn is_nowhere_far_worse(alone: &[RelativeError], with: &[RelativeError]) -> bool {
    let mut pairs = alone.iter().zip(with);
    let most = AdoptPolicy::in_use().most_lost;
    pairs.all(|(alone, with)| with.beyond_noise() <= most * alone.beyond_noise())
}

/// Index of the smallest of these errors, starting with the preferred law: a later one has to be clearly smaller.
pub(super) fn clearly_best(errors: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::INFINITY);
    for (number, error) in errors.enumerate() {
        if error < AdoptPolicy::in_use().better * best.1 {
            best = (number, error);
        }
    }
    best.0
}

/// A law's number, with the mean logarithm of its errors over those of another law, and its standard error.
type OfLaw = (usize, (f64, f64));

/// From the errors of laws on the same conditions, the simplest law first: index of the one to write, and of the best of the others. The
/// first is the law alone. The best of those that [gain](gains()) over it by more than one standard error takes its place; or the simplest
/// of them that is within one standard error of that one.
///
/// Laws are compared by the mean logarithm of the ratio of their errors, in which each condition counts equally, and its standard error
/// over the conditions. A law that gains while a device is nearly at rest and fails while it moves gains nothing in total.
/// Only a law that `may_be_written` is.
pub(super) fn simplest_of_best(
    laws: &[&[RelativeError]],
    may_be_written: impl Fn(usize) -> bool,
) -> (usize, usize) {
    // Mean and its standard error.
    let log_ratio = |a: usize, b: usize| {
        let [of_b, of_a] = comparable(laws[b], laws[a]);
        let pairs = of_a.iter().zip(&of_b);
        let logs = pairs.map(|(a, b)| (a.beyond_noise() / b.beyond_noise()).ln());
        let logs: Vec<f64> = logs.collect();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let squares = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>();
        (mean, (squares / (count - 1.0) / count).sqrt())
    };
    // A law that cannot be run on some condition is none.
    let is_run = |law: &usize| laws[*law].iter().all(RelativeError::is_run);
    let candidates = (1..laws.len()).filter(is_run);
    let candidates: Vec<OfLaw> = candidates.map(|law| (law, log_ratio(law, 0))).collect();
    let by_mean = |a: &&OfLaw, b: &&OfLaw| a.1.0.total_cmp(&b.1.0);
    let Some(&(best, _)) = candidates.iter().min_by(by_mean) else {
        return (0, 0);
    };
    // NaN, as of a single condition, is no gain.
    let is_better = |(law, (mean, error)): &&OfLaw| {
        let [alone, with] = comparable(laws[0], laws[*law]);
        *mean < -*error && gains(&alone, &with) && may_be_written(*law)
    };
    let better: Vec<OfLaw> = candidates.iter().filter(is_better).copied().collect();
    let Some(&(of_better, _)) = better.iter().min_by(by_mean) else {
        return (0, best);
    };
    let is_as_good = |(law, _): &&OfLaw| {
        let (mean, error) = log_ratio(*law, of_better);
        mean <= error
    };
    // The best is as good as itself.
    let simplest = better.iter().find(is_as_good);
    (simplest.map_or(0, |(law, _)| *law), best)
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
    let is_run = with.iter().all(RelativeError::is_run);
    is_run && squares[1] < gain * gain * squares[0] && mean_ratio < gain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(errors: &[f64]) -> Vec<RelativeError> {
        let each = errors.iter();
        each.map(|error| RelativeError {
            error: error * error,
            noise: 1e-6,
            most: 0.0,
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
        assert!(gains(&[RelativeError::NONE], &errors(&[0.1])));
        assert!(!gains(&errors(&[0.1]), &[RelativeError::NONE]));
    }

    #[test]
    fn a_table_may_not_fail_at_an_end() {
        let alone = errors(&[0.1, 0.2, 0.3, 0.1]);
        let fails_by =
            |factor: f64| !is_nowhere_far_worse(&alone, &errors(&[0.01, 0.01, 0.01, 0.1 * factor]));
        assert!(!fails_by(0.1) && !fails_by(1.24));
        assert!(fails_by(1.26) && fails_by(20.0));
        let cannot_be_run = [&alone[..3], &[RelativeError::NONE]].concat();
        assert!(!is_nowhere_far_worse(&alone, &cannot_be_run));
        assert!(is_nowhere_far_worse(&cannot_be_run, &alone));
    }

    #[test]
    fn the_simplest_law_within_a_standard_error_of_the_best_is_written() {
        let alone = errors(&[0.1, 0.2, 0.3, 0.1]);
        let simple = errors(&[0.05, 0.11, 0.14, 0.052]);
        let as_good = errors(&[0.052, 0.1, 0.15, 0.048]);
        let better = errors(&[0.03, 0.06, 0.08, 0.029]);
        let chosen = |laws: &[&[RelativeError]]| simplest_of_best(laws, |_| true);
        assert_eq!(chosen(&[&alone, &simple, &as_good]).0, 1);
        assert_eq!(chosen(&[&alone, &simple, &better]), (2, 2));
        assert_eq!(chosen(&[&alone, &better, &simple]), (1, 1));
        let but_the_best = |law: usize| law != 2;
        assert_eq!(
            simplest_of_best(&[&alone, &simple, &better], but_the_best),
            (1, 2)
        );
        assert_eq!(chosen(&[&alone]), (0, 0));
        let no_use = errors(&[0.101, 0.199, 0.3, 0.1]);
        assert_eq!(chosen(&[&alone, &no_use]), (0, 1));
        let of_one_condition = errors(&[0.001, 0.21, 0.33, 0.11]);
        assert_eq!(
            chosen(&[&alone, &of_one_condition]),
            (0, 1),
            "it loses elsewhere"
        );
        assert_eq!(chosen(&[&alone, &errors(&[f64::NAN; 4])]), (0, 0));
        let fails_in_motion = errors(&[0.02, 0.04, 0.9, 0.02]);
        assert_eq!(chosen(&[&alone, &fails_in_motion]), (0, 1));
        assert_eq!(chosen(&[&alone, &simple, &fails_in_motion]).0, 1);
        // Where the law alone cannot be run, it has no error to gain over, and the others decide.
        let refused = [&alone[..3], &[RelativeError::NONE]].concat();
        assert_eq!(chosen(&[&refused, &better]).0, 1);
        assert_eq!(chosen(&[&refused, &no_use]), (0, 1));
        let cannot_be_run = [&better[..3], &[RelativeError::NONE]].concat();
        assert_eq!(chosen(&[&alone, &cannot_be_run]), (0, 0));
        // One condition says nothing of the next.
        assert_eq!(chosen(&[&errors(&[0.2]), &errors(&[0.1])]).0, 0);
    }
}
