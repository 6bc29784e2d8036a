//! The cost of each effect on a target, as the page about costs gives it.

use std::fmt::Write as _;
use std::path::Path;

use mesh_damper::effects::{AugmentedLaw, DESCRIPTIONS, Effect};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::pack::{LARGEST, PackInfo, encode};
use mesh_damper_trials::bench::{Baseline, Core};

/// Bytes of a pack of the law with these effects.
fn packed(effects: impl IntoIterator<Item = Effect<f32>>) -> usize {
    let law = Law::new(1.0, 10.0, 0.1, 0.4).unwrap();
    let mut augmented = AugmentedLaw::<f32, 8>::new(law);
    for effect in effects {
        augmented = augmented.with(effect).unwrap();
    }
    let mut buffer = [0; LARGEST];
    let info = PackInfo::at(1e4);
    encode(&FastLaw::new(augmented), &info, &mut buffer)
        .unwrap()
        .len()
}

/// One row per effect: additional instructions of a tick compared to the law alone, bytes in a pack, bytes of RAM in a law of a
/// static type.
fn table() -> String {
    let baseline = Baseline::read(&Baseline::path().unwrap()).unwrap();
    let count = |name: &str| {
        let mut counts = baseline.counts.iter();
        let counted = |entry: &&mesh_damper_trials::bench::Entry| {
            entry.core == Core::CortexM4f && entry.name == format!("effects/{name}")
        };
        counts.find(counted).unwrap_or_else(|| panic!("{name}"))
    };
    let none = count("none");
    let alone = packed([]);
    let mut table = String::new();
    for description in DESCRIPTIONS {
        let name = description.name;
        let effect = Effect::from_parameters(description.number, description.typical, 1e-4);
        let effect = effect.expect("typical parameters");
        let counted = count(name);
        // For a host, whose pointers are longer.
        let ram = effect.bytes();
        writeln!(
            table,
            "| `{name}` | {:.0} | {} | {} | {ram} |",
            counted.mean - none.mean,
            counted.most - none.most,
            packed([effect]) - alone,
        )
        .unwrap();
    }
    table
}

/// With BLESS=1 the test writes it there.
#[test]
fn the_page_says_what_each_effect_takes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/bench.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let head = "| effect | mean | longest | pack | RAM |\n|---|---:|---:|---:|---:|\n";
    let start = page.find(head).expect("the page has the table") + head.len();
    let end = start + page[start..].find("\n\n").unwrap() + 1;
    let table = table();
    if std::env::var("BLESS").is_ok_and(|bless| bless == "1") {
        let page = [&page[..start], &table, &page[end..]].concat();
        std::fs::write(&path, page).unwrap();
        return;
    }
    assert_eq!(&page[start..end], table, "run with BLESS=1");
}
