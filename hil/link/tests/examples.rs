//! The firmwares of `examples/virtual-specimen` and `examples/microbit` in the emulator.

#[allow(dead_code, reason = "read from the firmware here")]
#[path = "../../../examples/microbit/src/damper.rs"]
mod damper;
mod emulated;
#[path = "../../../examples/virtual-specimen/src/specimen.rs"]
mod specimen;

use std::f64::consts::{PI, TAU};
use std::process::{Output, Stdio};

use damper::Damper;
use mesh_damper::law::Law;
use mesh_damper_link::image::Board;
use mesh_damper_recording::Recording;
use specimen::Specimen;

/// The output of the example; `None`, with a message, if this machine cannot run it. An instruction takes 4 ns of the emulator's time.
fn run(name: &str, board: Board) -> Option<Output> {
    let elf = emulated::example(name, board)?;
    let output = board
        .emulator(&elf)
        .unwrap()
        .args(["-icount", "shift=2,sleep=off"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {said}", output.status);
    Some(output)
}

/// Stiffness in kN/mm and loss factor of each cycle in the lines of `text` that begin with "cycle".
fn cycles(text: &[u8]) -> Vec<[f64; 2]> {
    let text = str::from_utf8(text).unwrap();
    let lines = text.lines().filter(|line| line.starts_with("cycle"));
    let numbers = |line: &str| {
        let words = line.split([' ', ',']).filter_map(|word| word.parse().ok());
        words.collect::<Vec<f64>>().try_into().unwrap()
    };
    lines.map(numbers).collect()
}

/// Stiffness in kN/mm and loss factor of a steady cycle, from the equations. With y = X·sin φ and v = X·ω·cos φ the energy is
/// X·∮F·cos φ dφ.
fn expected(law: &Law<f64>, amplitude: f64, frequency: f64) -> [f64; 2] {
    const STEPS: u32 = 100_000;
    let speed = TAU * frequency * amplitude;
    let (mut largest, mut sum) = (0.0f64, 0.0);
    for step in 0..STEPS {
        let (sin, cos) = (TAU * f64::from(step) / f64::from(STEPS)).sin_cos();
        let (y, v) = (amplitude * sin, speed * cos);
        let damping = law.c() * v.abs().powf(law.alpha()) * v.signum();
        let force = law.k1() * y + law.k3() * y.powi(3) + damping;
        largest = largest.max(force);
        sum += force * cos;
    }
    let energy = amplitude * TAU / f64::from(STEPS) * sum;
    let stiffness = largest / amplitude;
    [stiffness, energy / (PI * stiffness * amplitude.powi(2))]
}

fn assert_near(found: [f64; 2], expected: [f64; 2], tolerance: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        let error = (found / expected - 1.0).abs();
        assert!(error < tolerance, "{found}, expected {expected}");
    }
}

/// Every row is the host's to the last bit; the file reads as a recording without a guess; and each cycle is the equations', before
/// the break and after it. Extremes over 2000 ticks are within (π/2000)²/2 = 1.3e-6 of the motion's; f32 adds less than 1e-6.
#[test]
fn the_virtual_specimen_is_its_law_and_breaks() {
    let Some(output) = run("virtual-specimen", Board::NetduinoPlus2) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.csv");
    std::fs::write(&path, &output.stdout).unwrap();
    let recording = Recording::read(&path).unwrap();
    assert_eq!(recording.guesses(), <[String; 0]>::default());
    let mut specimen = Specimen::new().unwrap();
    let mut rows = str::from_utf8(&output.stdout).unwrap().lines().skip(1);
    let (mut ticks, mut samples) = (0, 0);
    while let Some(sample) = specimen.tick() {
        if ticks % 10 == 0 {
            let [displacement, force] = [sample.displacement, sample.force];
            let milliseconds = ticks / 10;
            let row = format!(
                "{}.{:03},{displacement},{force}",
                milliseconds / 1000,
                milliseconds % 1000
            );
            assert_eq!(rows.next(), Some(&row[..]));
            samples += 1;
        }
        ticks += 1;
    }
    assert_eq!(rows.next(), None);
    assert_eq!(recording.len(), samples);

    let law = specimen::law().cast::<f64>();
    let left = f64::from(specimen::LEFT);
    let broken = Law::new(
        left * law.k1(),
        left * law.k3(),
        left * law.c(),
        law.alpha(),
    );
    let [whole, broken] =
        [law, broken.unwrap()].map(|law| expected(&law, specimen::AMPLITUDE, specimen::FREQUENCY));
    let cycles = cycles(&output.stderr);
    // After the cycle of the ramp.
    let (before, after) = cycles[1..].split_at(specimen::WHOLE as usize - 1);
    assert_eq!(before.len() + after.len(), specimen::CYCLES as usize);
    for cycle in before {
        assert_near(*cycle, whole, 3e-6);
    }
    for cycle in after {
        assert_near(*cycle, broken, 3e-6);
    }
}

/// Every force is the host's, and each cycle is the equations' within the error that docs/bench.md states for integers.
#[test]
fn the_law_in_integers_runs_on_a_cortex_m0() {
    let Some(output) = run("microbit", Board::Microbit) else {
        return;
    };
    let mut here = Damper::new().unwrap();
    let mut sum = 0;
    while let Some((force, _)) = here.tick() {
        sum = damper::added(sum, force);
    }
    let text = str::from_utf8(&output.stdout).unwrap();
    assert_eq!(text.lines().last(), Some(&format!("forces {sum:08x}")[..]));
    let sine = damper::SINE;
    let equations = expected(&damper::published(), sine.amplitude, sine.frequency);
    // After the cycle of the ramp.
    let cycles = &cycles(&output.stdout)[1..];
    assert_eq!(cycles.len(), sine.cycles as usize);
    for cycle in cycles {
        assert_near(*cycle, equations, 1e-4);
    }
}
