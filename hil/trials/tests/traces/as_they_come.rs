//! Recordings as laboratories bring them, drawn by a seed: what is unusual is found and named, and the parameters are right all the same.
//! In as many others nothing is unusual, and nothing is found.

mod drawn;
mod judged;

use drawn::{Drawn, LABELS};
use judged::Judged;
use rayon::prelude::*;

/// Counts of one row of the table.
#[derive(Clone, Copy, Default)]
struct Counts {
    drawn: usize,
    found: usize,
    named: usize,
    else_too: usize,
    right: usize,
    /// All of it.
    all: usize,
    inside: [usize; 2],
}

impl Counts {
    fn add(&mut self, judged: &Judged) {
        self.drawn += 1;
        self.found += usize::from(judged.found);
        self.named += usize::from(judged.named);
        self.else_too += usize::from(!judged.nothing_else);
        self.right += usize::from(judged.right);
        self.all += usize::from(judged.named && judged.nothing_else && judged.right);
        self.inside[0] += judged.inside[0];
        self.inside[1] += judged.inside[1];
    }

    fn row(&self, label: &str) -> String {
        let Self {
            drawn,
            found,
            named,
            else_too,
            right,
            all,
            inside: [inside, of],
        } = self;
        let share = 100.0 * *inside as f64 / (*of).max(1) as f64;
        format!(
            "| {label} | {drawn} | {found} | {named} | {else_too} | {right} | {all} | {share:.0} % |"
        )
    }
}

/// The recordings of these seeds, with the kind of each.
fn judged(seeds: std::ops::Range<u64>, unusual: bool) -> Vec<(Option<usize>, Judged)> {
    let judged = seeds.into_par_iter().map(|seed| {
        let label = unusual.then_some(seed as usize % LABELS.len());
        let drawn = Drawn::of(seed, label);
        if let Ok(folder) = std::env::var("DRAWN_OUT") {
            std::fs::write(format!("{folder}/{seed}.csv"), &drawn.text).unwrap();
        }
        let begin = std::time::Instant::now();
        if std::env::var("DRAWN_READ").is_ok() {
            let r = mesh_damper_recording::Recording::from_bytes(std::path::Path::new("a.csv"), drawn.text.clone().into_bytes()).unwrap();
            let t = mesh_damper_recording::trajectory::Trajectory::of(&r).unwrap();
            eprintln!("{seed} {:?} {:.2} s {} rows {} ticks: {:?}", drawn.kind, begin.elapsed().as_secs_f64(), r.len(), t.len(), t.faults);
            return (label, Judged::default());
        }
        let mut judged = Judged::of(&drawn);
        eprintln!("{seed} {}{}{} {:?} {:.2} s, {} rows {:?} {:.1} Hz to {:.2} noise {:.4} {:?}: {}", u8::from(judged.named), u8::from(judged.nothing_else), u8::from(judged.right), judged.inside, begin.elapsed().as_secs_f64(), drawn.text.lines().count(), drawn.kind, drawn.rate, drawn.highest, drawn.noise, drawn.specimen, judged.said);
        let Drawn {
            kind,
            specimen,
            rate,
            highest,
            noise,
            ..
        } = drawn;
        judged.said = format!(
            "seed {seed}, {rate:.1} Hz, to {highest:.2} Hz, noise {noise:.4}, {kind:?}, {specimen:?}: {}",
            judged.said
        );
        (label, judged)
    });
    judged.collect()
}

#[test]
#[ignore = "a quarter of an hour: in the full tier"]
fn drawn_recordings_are_named_and_their_parameters_are_right() {
    let count: u64 = std::env::var("DRAWN_SEEDS").map_or(500, |count| count.parse().unwrap());
    let (with, without) = (
        judged(0..count, true),
        judged(10_000..10_000 + count, false),
    );
    let mut counts = [Counts::default(); LABELS.len()];
    let (mut all, mut nothing) = (Counts::default(), Counts::default());
    for (label, judged) in &with {
        counts[label.unwrap()].add(judged);
        all.add(judged);
    }
    without.iter().for_each(|(_, judged)| nothing.add(judged));
    for (_, judged) in with.iter().chain(&without) {
        if !(judged.named && judged.nothing_else && judged.right) {
            println!(
                "{}{}{} {}",
                u8::from(judged.named),
                u8::from(judged.nothing_else),
                u8::from(judged.right),
                judged.said
            );
        }
    }
    for (label, counts) in LABELS.iter().zip(counts) {
        println!("{}", counts.row(label));
    }
    println!("{}", all.row("all of these"));
    println!("{}", nothing.row("nothing unusual"));
}

#[test]
#[ignore = "one seed"]
fn one_seed() {
    let list = std::env::var("DRAWN_LIST").unwrap();
    for seed in list.split(',') {
        let seed: u64 = seed.parse().unwrap();
        judged(seed..seed + 1, seed < 10_000);
    }
}
