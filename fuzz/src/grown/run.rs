//! Reads grown files under a count of memory, steps and time, and prints a table of what they took: a line for each structure, then
//! one for the format.
//!
//! `cargo test --release -p mesh-damper-fuzz grown -- --ignored --nocapture --test-threads 1`, and without `--ignored` a few small
//! ones. With `GROWN=FOLDER`, each file that takes too much is left there.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use std::{env, fs, thread};

use rustix::time::{ClockId, clock_gettime};

use super::{FORMATS, Grow, Size, file, look, memory};

/// Files of each structure in the gate, and in all.
const FEW: u64 = 1;
const MANY: u64 = 24;
const SMALL: Size = Size {
    file: 1 << 20,
    unpacked: 16 << 20,
};
const LARGE: Size = Size {
    file: 4_000_000,
    unpacked: 64_000_000,
};
/// Bytes that reading may take: those of the budget for each byte that was read and before, and what libraries take that is charged
/// afterwards. That is 512 MiB for a large file, with those of the program itself.
fn memory(size: Size) -> usize {
    (64 << 20) + 6 * size.read() + (16 << 20)
}
/// Processor time that reading may take, when it is optimized.
const TIME: Duration = Duration::from_secs(5);
/// Steps that the budget allows.
fn steps(size: Size) -> u64 {
    (64 << 20) + 8 * size.read() as u64
}

/// What the files of one structure took at most.
#[derive(Clone, Copy, Default)]
struct Most {
    files: u64,
    /// Files that were read, and those that the budget refused.
    read: u64,
    refused: u64,
    bytes: usize,
    steps: u64,
    time: Duration,
}

impl Most {
    fn with(&mut self, other: &Self) {
        self.files += other.files;
        self.read += other.read;
        self.refused += other.refused;
        self.bytes = self.bytes.max(other.bytes);
        self.steps = self.steps.max(other.steps);
        self.time = self.time.max(other.time);
    }

    fn said(&self, format: &str, structure: &str) -> String {
        format!(
            "| {format} | {structure} | {} | {} | {} | {:.0} | {:.0} | {:.2} |",
            self.files,
            self.read,
            self.refused,
            self.bytes as f64 / f64::from(1 << 20),
            self.steps as f64 / 1e6,
            self.time.as_secs_f64()
        )
    }
}

fn time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

/// Reads the file of a seed.
fn once(name: &str, grow: Grow, seed: u64, size: Size, wrong: &Mutex<Vec<String>>) -> Most {
    let bytes = file(grow, seed, size);
    let before = time();
    let (looked, held) = memory::most(|| look(&bytes));
    let time = time() - before;
    let is_slow = time > TIME && !cfg!(debug_assertions);
    if held > memory(size) || looked.steps > steps(size) || is_slow {
        let said = format!(
            "{name}, seed {seed}: {} bytes take {} MiB, {} steps and {:.1} s",
            bytes.len(),
            held >> 20,
            looked.steps,
            time.as_secs_f64()
        );
        if let Ok(folder) = env::var("GROWN") {
            let path = format!("{folder}/{}-{seed}", name.replace(' ', "-"));
            fs::write(path, &bytes).expect("a folder");
        }
        wrong.lock().expect("no panic").push(said);
    }
    Most {
        files: 1,
        read: looked.is_read.into(),
        refused: looked.is_refused.into(),
        bytes: held,
        steps: looked.steps,
        time,
    }
}

/// Reads `files` files of each structure of a format, on every processor.
fn run(format: &str, files: u64, size: Size) {
    let (_, structures) = FORMATS
        .iter()
        .find(|(name, _)| *name == format)
        .expect("a format");
    let wrong = Mutex::new(Vec::new());
    let most = Mutex::new(vec![Most::default(); structures.len()]);
    let next = AtomicUsize::new(0);
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some((structure, grow)) = structures.get(number / files as usize) else {
                break;
            };
            let seed = number as u64 % files;
            let name = format!("{format} {structure}");
            let took = once(&name, *grow, seed, size, &wrong);
            most.lock().expect("no panic")[number / files as usize].with(&took);
        }
    };
    thread::scope(|scope| {
        let threads = thread::available_parallelism().map_or(1, usize::from);
        (0..threads).for_each(|_| _ = scope.spawn(work));
    });
    let most = most.into_inner().expect("no panic");
    let mut all = Most::default();
    println!(
        "| format | structure | files | read | refused by the budget | largest MiB | 1e6 steps | s |"
    );
    let mut wrong = wrong.into_inner().expect("no panic");
    for ((structure, _), most) in structures.iter().zip(&most) {
        println!("{}", most.said(format, structure));
        // Otherwise nothing was grown that a reader follows.
        if files >= MANY && most.read + most.refused == 0 {
            wrong.push(format!("{format} {structure}: no file was read"));
        }
        all.with(most);
    }
    let names: Vec<&str> = structures.iter().map(|(name, _)| *name).collect();
    println!("{}", all.said(format, &names.join(", ")));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(all.read > 0, "no file was read");
}

/// A format with a few small files.
pub fn few(format: &str) {
    run(format, FEW, SMALL);
}

/// The same with many large ones.
pub fn many(format: &str) {
    run(format, MANY, LARGE);
}
