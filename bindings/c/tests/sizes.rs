//! What law and one effect from a pack take in C: flash, RAM, stack and instructions, as the page says.

mod build;

use build::{On, Program, can, emulator, example, here, run, source};
use mesh_damper_link::image::sections;

/// The row of `docs/c.md` that begins with `what`, without it.
fn row(what: &str) -> Vec<u64> {
    let page = std::fs::read_to_string(here().join("../../docs/c.md")).unwrap();
    let row = page
        .lines()
        .find(|line| line.starts_with(&format!("| {what} |")));
    let cells = row.unwrap_or_else(|| panic!("docs/c.md has no row {what}"));
    let cells = cells.trim_matches('|').split('|').skip(1);
    cells.map(|cell| cell.trim().parse().unwrap()).collect()
}

#[test]
fn law_and_one_effect_take_what_the_page_says() {
    if !can(On::Emulator) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for file in ["mount.h", "mount.c"] {
        std::fs::copy(example().join(file), folder.path().join(file)).unwrap();
    }
    let elf = Program {
        on: On::Emulator,
        folder: folder.path(),
        sources: &[source("size.c")],
        packs: &["mount"],
        map: None,
    }
    .build();
    let takes = sections(&elf).unwrap();
    let said = run(&mut emulator(&elf));
    let number = |name: &str| -> u64 {
        let value = said
            .lines()
            .find_map(|line| line.strip_prefix(name)?.trim().parse().ok());
        value.unwrap_or_else(|| panic!("{name}: {said}"))
    };
    let found = [
        takes.flash,
        takes.ram,
        number("stack"),
        number("mean"),
        number("longest"),
        number("filling"),
    ];
    let page = row("law and stick-slip from a pack, in C");
    assert_eq!(page.len(), found.len());
    for (page, found) in page.iter().zip(found) {
        // Another version of the compiler or of newlib makes a little of it.
        assert!(
            found.abs_diff(*page) * 20 <= *page,
            "{found} instead of {page}: {takes:?} {said}"
        );
    }
}
