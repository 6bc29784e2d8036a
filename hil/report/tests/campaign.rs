//! The pictures of the fault campaign.

use mesh_damper_report::campaign;
use mesh_damper_rig::faults::{Campaign, InjectedFault};

#[test]
fn every_trial_and_every_slow_change_has_its_marks() {
    let campaign = Campaign {
        kinds: vec![InjectedFault::WireBreakage, InjectedFault::ForceStuck],
        specimens: vec![(3.0, 0.1, 10.0)],
        healthy_cycles: 100,
        ..Campaign::part()
    };
    let summary = campaign.run(&|| ()).unwrap();
    assert!(summary.right > 0);
    // A mark to each in the pictures, beside those of the legend.
    let found = campaign::found(&summary);
    assert!(found.contains("named otherwise"));
    assert_eq!(found.matches("<circle").count(), summary.right + 1);
    let followed = campaign::followed(&summary.slow);
    assert_eq!(
        followed.matches("<circle").count(),
        2 * (summary.slow.len() + 1)
    );
}
