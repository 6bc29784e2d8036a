//! The numbers that decide: which policy file is used, and when.

use mesh_damper_recording::Recording;
use mesh_damper_recording::numbers::{AlreadyInUse, Field, Mark};
use mesh_damper_recording::policy::Policy;
use mesh_damper_recording::trajectory::Trajectory;

#[test]
fn a_file_states_the_numbers_that_differ_and_no_others() {
    let policy: Policy = serde_json::from_str(r#"{"sign": {"certain": 0.1}}"#).unwrap();
    let mut expected = Policy::default();
    expected.sign.certain = 0.1;
    assert_eq!(policy, expected);
    for (text, unknown) in [
        (r#"{"sine": {}}"#, "sine"),
        (r#"{"sign": {"certainty": 0.1}}"#, "certainty"),
    ] {
        let error = serde_json::from_str::<Policy>(text).unwrap_err();
        assert!(error.to_string().contains(unknown), "{error}");
    }
}

#[test]
fn every_number_says_what_it_decides_and_where_it_comes_from() {
    for (part, fields) in Policy::PARTS {
        for Field {
            name,
            about,
            reason,
            ..
        } in *fields
        {
            assert!(about.trim().ends_with('.'), "{part}.{name}: {about}");
            assert!(
                !reason.is_empty() && !reason.ends_with('.'),
                "{part}.{name}: {reason}"
            );
        }
    }
    let sign = Policy::PARTS.iter().find(|(part, _)| *part == "sign");
    assert_eq!(sign.unwrap().1[0].mark, Mark::Tuned);
}

/// One test for both, because a process has one policy.
#[test]
fn a_policy_is_installed_before_any_work_and_then_decides() {
    let mut other = Policy::default();
    other.trajectory.fewest_samples = 200;
    assert_eq!(other.clone().install(), Ok(()));
    assert_eq!(other.install(), Err(AlreadyInUse));
    assert_eq!(Policy::in_use().trajectory.fewest_samples, 200);
    let time: Vec<f64> = (0..150).map(|i| 0.001 * f64::from(i)).collect();
    let displacement: Vec<f64> = time.iter().map(|t| (62.8 * t).sin()).collect();
    let recording = Recording::new("short", time, displacement.clone(), displacement).unwrap();
    let refused = Trajectory::of(&recording).unwrap_err();
    assert!(refused.to_string().contains("200"), "{refused}");
}
