//! The size of the law and one effect from a pack in C: flash, RAM, stack and instructions, as on the page.

mod build;

use build::{On, Program, can, emulator, here, run, source};
use mesh_damper_link::image::sections;
use mesh_damper_model::export::{Export, ExportSettings};
use mesh_damper_model::file::ModelFile;

/// The row of `docs/c.md` that begins with `what`, without that cell.
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
    // The law of the images in Rust, so that the rows can be compared: the same bytes as their pack.
    let model = here().join("../../examples/own-timer/src/mount.json");
    let settings = ExportSettings::at(10_000.0, "stick_slip");
    let export = Export::new(&ModelFile::read(model).unwrap(), &settings).unwrap();
    let of_rust = include_bytes!("../../../firmware/src/sizes/stick_slip.mdcp");
    assert_eq!(export.pack().unwrap(), of_rust);
    let [header, array] = export.c("stick_slip").unwrap();
    std::fs::write(folder.path().join("stick_slip.h"), header).unwrap();
    std::fs::write(folder.path().join("stick_slip.c"), array).unwrap();
    let elf = Program {
        on: On::Emulator,
        folder: folder.path(),
        sources: &[source("size.c")],
        packs: &["stick_slip"],
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
        // Another version of the compiler or of newlib changes it a little.
        assert!(
            found.abs_diff(*page) * 20 <= *page,
            "{found} instead of {page}: {takes:?} {said}"
        );
    }
}
