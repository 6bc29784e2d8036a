//! The whole tick in plain C, with newlib: built if the compiler is installed.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use mesh_damper_output::error::InputError;
use mesh_damper_output::process;
use mesh_damper_sources::Sources;

use mesh_damper_firmware::bench::suite::{power, tick};

const COMPILER: &str = "arm-none-eabi-gcc";
const FLAGS: [&str; 9] = [
    "-O3",
    "-mcpu=cortex-m4",
    "-mthumb",
    "-mfloat-abi=hard",
    "-mfpu=fpv4-sp-d16",
    // Not plain C11, which forbids merging a multiplication and an addition into one instruction.
    "-std=gnu11",
    "-Wall",
    "-Wextra",
    "-Werror",
];

/// The name and version of the compiler, the version of its library, and the compiler options; `None` if the compiler or the
/// library is missing.
pub fn compiler() -> Option<String> {
    let said = |arguments: &[&str]| {
        let mut command = Command::new(COMPILER);
        let output = process::output(command.args(arguments)).ok()?;
        Some(String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let version = said(&["--version"])?;
    let macros = said(&["-E", "-dM", "-include", "newlib.h", "-x", "c", "/dev/null"])?;
    let newlib = macros
        .lines()
        .find_map(|line| line.strip_prefix("#define _NEWLIB_VERSION "))?;
    Some(format!(
        "{}, newlib {}, {}",
        version.lines().next()?,
        newlib.trim_matches('"'),
        FLAGS[..6].join(" ")
    ))
}

/// Builds the image in `directory`. It counts over the same inputs as the image in Rust.
///
/// # Errors
/// There is no compiler, no C library for it, or an error of the compiler.
pub fn build(directory: &Path) -> Result<PathBuf, InputError> {
    let remedy = "apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi (or your system's packages of them)";
    let failed = |problem: String| InputError::new("the peer in C", problem, remedy);
    let header = directory.join("inputs.h");
    std::fs::write(&header, inputs()).map_err(|error| InputError::io(&header, "write", &error))?;
    let sources = Sources::find()?;
    let here = sources.root().join("hil/trials/bench");
    let elf = directory.join("peer.elf");
    let mut build = Command::new(COMPILER);
    build
        // Folder of the memory.x for the board of the count.
        .current_dir(sources.root())
        .args(FLAGS)
        .arg("-nostartfiles")
        .arg("-I")
        .arg(directory)
        .arg("-T")
        .arg(here.join("peer.ld"))
        .arg(here.join("peer.c"))
        .arg("-lm")
        .arg("-o")
        .arg(&elf);
    let output = process::output(&mut build)
        .map_err(|error| failed(format!("{COMPILER} does not start: {error}")))?;
    if output.status.success() {
        Ok(elf)
    } else {
        let text = String::from_utf8_lossy(&output.stderr);
        Err(failed(format!("{COMPILER} fails: {}", text.trim())))
    }
}

/// The inputs as a header.
fn inputs() -> String {
    let mut laws = String::new();
    for (amplitude, law) in tick::laws() {
        // Rust's shortest decimal that reads back as the same float is valid in C; writing to a string does not fail.
        let _ = write!(
            laws,
            "{{{amplitude:?}f, {:?}f, {:?}f, {:?}f, {:?}f}}, ",
            law.k1(),
            law.k3(),
            law.c(),
            law.alpha()
        );
    }
    let alphas = power::ALPHAS.map(|alpha| format!("{alpha:?}f"));
    let step = tick::FREQUENCY / tick::TICK_RATE * 2_f64.powi(32);
    let lines = [
        format!("ALPHAS {}", alphas.join(", ")),
        format!("VELOCITIES {}u", power::VELOCITIES),
        format!("VELOCITY_LOW {}u", power::LOWEST.to_bits()),
        format!("VELOCITY_HIGH {}u", power::HIGHEST.to_bits()),
        format!("LAWS {laws}"),
        format!("STEP {}u", step as u32),
        format!(
            "ANGULAR {:?}f",
            (std::f64::consts::TAU * tick::FREQUENCY) as f32
        ),
        format!("TICKS {}u", tick::NAIVE_TICKS),
    ];
    lines.map(|line| format!("#define {line}\n")).concat()
}
