//! Samples too few for the velocity can hide an effect, and a trace warns of it.

use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::trace;
use mesh_damper_recording::Recording;

use super::{BLOCKS, OTHERS, Trace, record, slider};

/// Every `step`-th sample of a recording.
fn thinned(recording: &Recording, step: usize) -> Recording {
    let some = |values: &[f64]| values.iter().copied().step_by(step).collect();
    Recording::new(
        recording.name.clone(),
        some(&recording.time),
        some(&recording.displacement),
        some(&recording.force),
    )
    .unwrap()
}

/// A slider, recorded at 500 Hz over `step`.
fn traced_at(step: usize) -> Trace {
    let recorded = |name, blocks: &[_], seed| {
        let whole = record(name, blocks, 0.004, seed, slider(0.9, 0.03));
        thinned(&whole, step)
    };
    let fitted = recorded("fitted", &BLOCKS[..4], 7);
    trace(&[fitted], &[recorded("held", &OTHERS, 8)], &|_| ()).unwrap()
}

fn warned(trace: &Trace) -> bool {
    let warnings = &trace.result.warnings;
    warnings
        .iter()
        .any(|warning| warning.contains("may be hidden"))
}

#[test]
fn an_effect_that_few_samples_hide_is_warned_of() {
    // Five samples to the cycle of 5 Hz.
    let hidden = traced_at(20);
    assert_eq!(
        hidden.result.verdict,
        Verdict::None,
        "{:?}",
        hidden.result.effects
    );
    assert_eq!(hidden.result.conclusion(), Conclusion::Hidden);
    assert!(warned(&hidden), "{:?}", hidden.result.warnings);
    let shown = traced_at(1);
    assert_eq!(shown.result.verdict, Verdict::Found);
    assert!(!warned(&shown), "{:?}", shown.result.warnings);
}
