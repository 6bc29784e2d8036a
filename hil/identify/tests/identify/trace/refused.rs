//! Recordings that contradict each other, or contain no information, are refused.

use mesh_damper_identify::trace::trace;
use mesh_damper_recording::Recording;

use super::{BLOCKS, OTHERS, record};

fn with_force(recording: &Recording, name: &str, change: impl Fn(f64) -> f64) -> Recording {
    Recording::new(
        name,
        recording.time.clone(),
        recording.displacement.clone(),
        recording.force.iter().map(|&f| change(f)).collect(),
    )
    .unwrap()
}

#[test]
fn recordings_that_contradict_each_other_are_refused() {
    let one = record("one", &BLOCKS, 0.004, 51, |_| 0.0);
    let elsewhere = record("elsewhere", &OTHERS, 0.004, 52, |_| 0.0);
    for (other, what) in [
        (with_force(&one, "other", |f| 1.5 * f), "1.5"),
        (with_force(&elsewhere, "other", |f| 1000.0 * f), "unit"),
    ] {
        let error = trace(std::slice::from_ref(&one), &[other], &|_| ())
            .unwrap_err()
            .to_string();
        assert!(error.contains("other") && error.contains(what), "{error}");
    }
    assert!(trace(&[one], &[elsewhere], &|_| ()).is_ok());
}

/// A recording with the opposite sign is turned back, and contradicts the others no more.
#[test]
fn a_turned_sign_is_turned_back_with_a_warning() {
    let one = record("one", &BLOCKS, 0.004, 51, |_| 0.0);
    let elsewhere = record("elsewhere", &OTHERS, 0.004, 52, |_| 0.0);
    let turned = with_force(&elsewhere, "turned", |f| -f);
    let clean = trace(std::slice::from_ref(&one), &[elsewhere], &|_| ()).unwrap();
    let corrected = trace(std::slice::from_ref(&one), &[turned], &|_| ()).unwrap();
    assert_eq!(corrected.result.verdict, clean.result.verdict);
    assert_eq!(corrected.result.augmented, clean.result.augmented);
    let start = "turned: sign of the force flipped";
    assert!(
        corrected
            .result
            .warnings
            .iter()
            .any(|warning| warning.starts_with(start))
    );
    // The same motion with the force turned is the same recording again.
    let copy = with_force(&one, "copy", |f| -f);
    let error = trace(&[one], &[copy], &|_| ()).unwrap_err().to_string();
    assert!(
        error.contains("copy") && error.contains("only repeats fitted recordings"),
        "{error}"
    );
}

#[test]
fn recordings_that_tell_nothing_are_refused() {
    let one = record("one", &BLOCKS, 0.004, 53, |_| 0.0);
    let refused = |fitted: &Recording, held: &[Recording]| {
        trace(std::slice::from_ref(fitted), held, &|_| ())
            .unwrap_err()
            .to_string()
    };
    assert!(refused(&with_force(&one, "dead", |_| 0.3), &[]).contains("never changes"));
    assert!(
        refused(&one, &[with_force(&one, "copy", |f| f)])
            .contains("only repeats fitted recordings")
    );
    let still = Recording::new(
        "still",
        one.time.clone(),
        record("still", &[(1e-9, 1.0, 29)], 0.004, 54, |_| 0.0).displacement[..one.len()].to_vec(),
        one.force.clone(),
    )
    .unwrap();
    assert!(refused(&still, &[]).contains("displacement"));
}
