//! Runs every check on seeded inputs, the same every time: 10⁸ ticks of the rig, and 10⁶ files, packs and frames; and on a tenth of
//! them.
//!
//! `cargo test -p mesh-damper-fuzz -- --ignored --nocapture`, and without `--ignored`.

use std::thread;

use crate::feed::Random;
use crate::{formats, frames, model_file, motion, pack, recording, rig};

/// Ticks of all rigs and emulations together, and of one of them.
const TICKS: u64 = 100_000_000;
const TICKS_OF_ONE: u32 = 10_000;
/// Ticks of the motion check, which gets any floats.
const MOTION_TICKS: u64 = 20_000_000;
/// Files or frames of each of four kinds.
const INPUTS: u64 = 250_000;

/// The sum of the results of `seen` over `count` scripts, on every processor.
fn sum(count: u64, length: usize, seen: impl Fn(&[u8]) -> u64 + Sync) -> u64 {
    let threads = thread::available_parallelism().map_or(1, usize::from) as u64;
    let of = |first: u64| {
        let numbers = (first..count).step_by(threads as usize);
        numbers
            .map(|number| seen(&script(number, length)))
            .sum::<u64>()
    };
    thread::scope(|scope| {
        let of = &of;
        let started: Vec<_> = (0..threads)
            .map(|first| scope.spawn(move || of(first)))
            .collect();
        let sums = started
            .into_iter()
            .map(|thread| thread.join().expect("a check failed"));
        sums.sum()
    })
}

/// Up to `length` bytes.
fn script(number: u64, length: usize) -> Vec<u8> {
    let mut random = Random::of(&number.to_le_bytes());
    let length = 1 + random.next() as usize % length;
    (0..length).map(|_| random.next() as u8).collect()
}

/// Each check on a tenth of its inputs, for the gate, and on all of them.
macro_rules! bounded {
    ($($name:ident: $check:expr;)*) => {
        mod tenth {
            use super::*;
            $(#[test] fn $name() { $check(10); })*
        }
        mod whole {
            use super::*;
            $(#[test] #[ignore = "minutes"] fn $name() { $check(1); })*
        }
    };
}

bounded! {
    rigs_stay_within_their_limits: rigs;
    no_float_makes_another_that_is_not_finite: floats;
    recordings_are_refused_or_right: |part| files("recordings", INPUTS / part, recording::check);
    // Fewer inputs, because a workbook takes a hundred times as long as a text.
    files_of_all_formats_are_refused_or_right: |part| files("files of all formats", INPUTS / 10 / part, formats::check);
    model_files_are_refused_or_right: |part| files("model files", INPUTS / part, model_file::check);
    packs_are_refused_or_right: |part| files("packs", INPUTS / part, packs);
    frames_are_refused_or_right: frames;
}

fn rigs(part: u64) {
    let rigs = TICKS / u64::from(TICKS_OF_ONE) / part;
    let ticks = rigs * u64::from(TICKS_OF_ONE);
    let ran = sum(rigs, 200, |script| rig::check(script, TICKS_OF_ONE));
    println!("{rigs} rigs and emulators, {ticks} ticks, running on {ran} of them");
    assert!(ran > ticks / 10, "{ran}");
}

fn floats(part: u64) {
    let ticks = sum(MOTION_TICKS / 1000 / part, 200, |script| {
        motion::check(script, 1000);
        1000
    });
    println!("{ticks} ticks of any floats");
}

/// Some are accepted and some are refused: otherwise the check would have tested nothing.
fn files(name: &str, count: u64, check: impl Fn(&[u8]) -> bool + Sync) {
    let taken = sum(count, 25, |script| check(script).into());
    println!("{count} {name}: {taken} taken and right, the others refused");
    assert!(taken > count / 100 && taken < count, "{taken}");
}

fn packs(script: &[u8]) -> bool {
    if let Some(taken) = pack::damaged(script) {
        assert!(
            pack::GOOD.contains(&taken),
            "a damaged pack was taken: {taken:?}"
        );
    }
    pack::check(script)
}

fn frames(part: u64) {
    let count = INPUTS / part;
    let found = sum(count, 25, |script| {
        frames::check(script);
        let found = frames::damaged(script);
        let as_sent = found.iter().all(|frame| frames::GOOD.contains(frame));
        assert!(as_sent, "a damaged frame was taken: {found:?}");
        found.len() as u64
    });
    println!("{count} streams of frames: {found} frames taken, all as they were sent");
    assert!(found > count);
}
