//! The fault campaign, a part of it: what the rig's monitor is asked for.

use hil::faults::{Campaign, Kind, missed};

/// `cargo hil faults --check` is the whole.
#[test]
fn a_part_of_the_campaign_meets_the_requirement() {
    let campaign = Campaign::part();
    assert_eq!(campaign.kinds.len(), Kind::ALL.len());
    let summary = campaign.run(&|| ()).unwrap();
    let missed = missed(&summary);
    assert!(missed.is_empty(), "{}", missed.join("\n"));
    let within = summary
        .slow
        .iter()
        .filter(|one| one.change.is_within())
        .count();
    assert!(within > 0 && within < summary.slow.len());
    // It settles by 10 % and is warmed by what moves it by 6 %: both are said, and are no alarms.
    for healthy in &summary.healthy {
        let noted: Vec<&str> = healthy
            .noted
            .iter()
            .map(|(_, cause)| cause.as_str())
            .collect();
        assert_eq!(noted, ["RunIn", "Temperature"], "{healthy:?}");
    }
}
