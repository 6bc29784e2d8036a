//! The example in C: its law equals the export of the model next to it, and in the emulator it prints the values that the crate
//! computes.

mod build;

use std::fmt::Write as _;

use build::{On, Program, can, declared, example, make, run};
use mesh_damper::cycle::CycleAccumulator;
use mesh_damper::effects::Motion;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::pack::{Expectation, decode};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper_model::export::{Export, ExportSettings};
use mesh_damper_model::file::ModelFile;

fn export() -> Export {
    let model = ModelFile::read(example().join("model.json")).unwrap();
    Export::new(&model, &ExportSettings::at(10_000.0, "mount")).unwrap()
}

#[test]
fn the_law_in_the_tree_is_what_its_model_exports() {
    for (file, written) in ["mount.h", "mount.c"]
        .into_iter()
        .zip(export().c("mount").unwrap())
    {
        let there = std::fs::read_to_string(example().join(file)).unwrap();
        assert!(
            there == written,
            "examples/c/{file}: the command in its Makefile writes it again"
        );
    }
}

/// The expected output of the example, from the crate.
fn expected() -> String {
    let mut law = FastLaw::<8>::EMPTY;
    decode(
        &export().pack().unwrap(),
        &mut law,
        &Expectation::at(10_000.0),
    )
    .unwrap();
    let mut law = RunningLaw::new(law);
    let programme = Programme::<1>::new(10_000.0, 1).unwrap();
    let programme = programme.with(Block::sine(0.1, 5.0, 3).unwrap()).unwrap();
    let mut sine = SineGenerator::new(programme).unwrap();
    let mut cycles = CycleAccumulator::new();
    let mut said = String::from("mount at 10000 Hz\n");
    loop {
        let now = sine.tick();
        if now.done {
            break;
        }
        let force = law.force(&Motion {
            acceleration: now.acceleration,
            temperature: 20.0,
            ..Motion::at(now.displacement, now.velocity)
        });
        if let Some([cycle]) = cycles.update(now.displacement, [force], now.phase) {
            let (stiffness, loss_factor) = (cycle.stiffness, cycle.loss_factor);
            writeln!(
                said,
                "cycle {}: stiffness {stiffness:.4} kN/mm, loss factor {loss_factor:.4}",
                now.cycle
            )
            .unwrap();
        }
    }
    said + "0 ticks late, 0 cycles lost\n"
}

#[test]
fn it_prints_in_the_emulator_what_the_crate_computes() {
    if !can(On::Emulator) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let said = run(make(&example())
        .arg("run")
        .arg(format!("BUILD={}", folder.path().display())));
    assert_eq!(said, expected());
    assert!(said.lines().count() >= 5, "{said}");
}

/// The same with a pack for half the rate: the load refuses the pack and reports both rates.
#[test]
fn it_refuses_a_law_for_another_tick_rate_than_its_timers() {
    if !can(On::Emulator) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let model = ModelFile::read(example().join("model.json")).unwrap();
    let slow = Export::new(&model, &ExportSettings::at(5_000.0, "mount")).unwrap();
    for (file, written) in ["mount.h", "mount.c"]
        .into_iter()
        .zip(slow.c("mount").unwrap())
    {
        std::fs::write(folder.path().join(file), written).unwrap();
    }
    let of_folder = |variable: &str| format!("{variable}={}", folder.path().display());
    let output = make(&example())
        .arg("run")
        .args([of_folder("BUILD"), of_folder("MOUNT")])
        .output()
        .unwrap();
    assert!(!output.status.success());
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("MD_ERROR_PACK_TICK_RATE")
            && said.contains("tick_rate = 5000 is not within 10000 to 10000"),
        "{said}"
    );
}

/// The program of the page, in its first block of C, prints the force that the page states.
#[test]
fn the_pages_program_gives_the_force_that_the_page_says() {
    if !can(On::Host) {
        return;
    }
    let page = std::fs::read_to_string(example().join("../../docs/c.md")).unwrap();
    let (_, after) = page.split_once("```c\n").unwrap();
    let (program, _) = after.split_once("```\n").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("main.c");
    std::fs::write(&source, program).unwrap();
    for file in ["mount.h", "mount.c"] {
        std::fs::copy(example().join(file), folder.path().join(file)).unwrap();
    }
    let said = Program {
        on: On::Host,
        folder: folder.path(),
        sources: &[source],
        packs: &["mount"],
        map: None,
    }
    .run();
    assert!(
        page.contains(&format!("It prints `{}`", said.trim())),
        "{said}"
    );
}

/// The page mentions every function of the header.
#[test]
fn the_page_has_every_function() {
    let page = std::fs::read_to_string(example().join("../../docs/c.md")).unwrap();
    let functions = declared();
    assert!(functions.len() > 30, "{functions:?}");
    for function in functions {
        assert!(
            page.contains(&format!("`{function}`")),
            "docs/c.md lacks {function}"
        );
    }
}
