//! The bench, if an emulator is installed; otherwise it is skipped with a message.

use std::io::Write as _;

use mesh_damper_link::image::Board;
use mesh_damper_trials::bench::{Baseline, IMAGE, Verdict, run};

use crate::emulated;

fn is_ci() -> bool {
    std::env::var("CI").as_deref() == Ok("true")
}

/// Past the test harness, which hides the output of passing tests.
fn say(line: &str) {
    let said = writeln!(std::io::stderr(), "{line}");
    said.unwrap();
}

#[test]
#[ignore = "a minute: in the full tier"]
fn counts_are_the_same_in_every_run() {
    if emulated::image(&IMAGE, Board::Mps2An386).is_none() {
        return;
    }
    assert_eq!(run(&|_| ()).unwrap().counts, run(&|_| ()).unwrap().counts);
}

#[test]
fn counts_are_no_higher_than_the_baseline_and_within_the_limits() {
    if emulated::image(&IMAGE, Board::Mps2An386).is_none() {
        return;
    }
    let results = run(&|_| ()).unwrap();
    for left_out in &results.left_out {
        assert!(!is_ci(), "{left_out}");
        say(&format!("left out: {left_out}"));
    }
    let baseline = Baseline::read(&Baseline::path().unwrap()).unwrap();
    let failures = baseline.failures(&results);
    // Another compiler generates other code, so its counts do not apply to ours.
    if baseline.tools.rustc != results.tools.rustc && !is_ci() {
        say(&format!(
            "left out: the baseline of instructions is of {}, not of {}; rustup toolchain install {} has it compared",
            baseline.tools.rustc,
            results.tools.rustc,
            baseline
                .tools
                .rustc
                .split_whitespace()
                .nth(1)
                .unwrap_or("it"),
        ));
        return;
    }
    assert!(failures.is_empty(), "{failures:#?}");
    let missed = results.limits.iter().filter_map(Verdict::failure);
    assert_eq!(missed.collect::<Vec<_>>(), Vec::<String>::new());
}
