//! Every check on so many seeded inputs, the same every time: 10⁸ ticks of the rig, and 10⁶ files, packs and frames.
//!
//! `cargo test --manifest-path fuzz/Cargo.toml --lib -- --nocapture`

use std::thread;

use crate::feed::Random;
use crate::{formats, frames, model_file, motion, pack, recording, rig};

/// Ticks of rigs and emulators, and of one of them.
const TICKS: u64 = 100_000_000;
const TICKS_OF_ONE: u32 = 10_000;
/// Ticks fed any floats.
const MOTION_TICKS: u64 = 20_000_000;
/// Files or frames of each of four kinds.
const INPUTS: u64 = 250_000;

/// `seen` of every script out of `count`, on every processor; the sum of what it says.
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

#[test]
fn rigs_stay_within_their_limits() {
    let rigs = TICKS / u64::from(TICKS_OF_ONE);
    let ran = sum(rigs, 200, |script| rig::check(script, TICKS_OF_ONE));
    println!("{rigs} rigs and emulators, {TICKS} ticks, running on {ran} of them");
    assert!(ran > TICKS / 10, "{ran}");
}

#[test]
fn no_float_makes_another_that_is_not_finite() {
    let ticks = sum(MOTION_TICKS / 1000, 200, |script| {
        motion::check(script, 1000);
        1000
    });
    println!("{ticks} ticks of any floats");
}

/// Some are taken, and some refused: otherwise nothing was tried.
fn files(name: &str, check: impl Fn(&[u8]) -> bool + Sync) {
    let taken = sum(INPUTS, 25, |script| check(script).into());
    println!("{INPUTS} {name}: {taken} taken and right, the others refused");
    assert!(taken > INPUTS / 100 && taken < INPUTS, "{taken}");
}

#[test]
fn recordings_are_refused_or_right() {
    files("recordings", recording::check);
}

/// Fewer, as a workbook takes a hundred times as long as a text.
#[test]
fn files_of_all_formats_are_refused_or_right() {
    let count = INPUTS / 10;
    let taken = sum(count, 25, |script| formats::check(script).into());
    println!(
        "{count} files of all formats: {taken} taken and as long as they say, the others refused"
    );
    assert!(taken > count / 100 && taken < count, "{taken}");
}

#[test]
fn model_files_are_refused_or_right() {
    files("model files", model_file::check);
}

#[test]
fn packs_are_refused_or_right() {
    files("packs", |script| {
        if let Some(taken) = pack::damaged(script) {
            assert!(
                pack::GOOD.contains(&taken),
                "a damaged pack was taken: {taken:?}"
            );
        }
        pack::check(script)
    });
}

#[test]
fn frames_are_refused_or_right() {
    let found = sum(INPUTS, 25, |script| {
        frames::check(script);
        let found = frames::damaged(script);
        let as_sent = found.iter().all(|frame| frames::GOOD.contains(frame));
        assert!(as_sent, "a damaged frame was taken: {found:?}");
        found.len() as u64
    });
    println!("{INPUTS} streams of frames: {found} frames taken, all as they were sent");
    assert!(found > INPUTS);
}
