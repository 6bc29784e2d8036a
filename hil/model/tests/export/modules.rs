//! Exported modules, compiled for this machine as a program of their own.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use mesh_damper::effects::Motion;
use mesh_damper_model::export::Export;

/// What a module has given.
pub struct Ran {
    /// Its constants, as `Debug` writes them.
    pub said: String,
    /// kN, at each motion.
    pub forces: Vec<f32>,
}

/// The program after the names of its modules.
const PROGRAM: &str = r#"
use mesh_damper::effects::Motion;
use mesh_damper::tick_law::TickLaw as _;

fn motion(bytes: &[u8]) -> Motion<f32> {
    let mut numbers = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
    let mut next = || numbers.next().unwrap();
    Motion {
        displacement: next(),
        velocity: next(),
        acceleration: next(),
        cycles: next(),
        temperature: next(),
        controls: std::array::from_fn(|_| next()),
    }
}

macro_rules! run {
    ($($module:ident)+) => {
        fn main() {
            let bytes = std::fs::read("motions.bin").unwrap();
            let motions: Vec<Motion<f32>> = bytes.chunks_exact(36).map(motion).collect();
            $(
                let mut law = Box::new($module::DamperLaw::empty());
                $module::fill(&mut law).unwrap();
                let said = (
                    $module::NAME,
                    $module::IDENTITY,
                    $module::REVISION,
                    $module::TICK_RATE,
                    $module::operating_range().unwrap(),
                    $module::AMPLITUDE,
                    $module::DENSITY,
                );
                println!("{said:?}");
                for motion in &motions {
                    println!("{}", law.force(motion).to_bits());
                }
            )+
        }
    };
}
"#;

/// Compiles the modules and runs each through `motions`, from rest.
pub fn run(exports: &[(String, Export)], motions: &[Motion<f32>]) -> Vec<Ran> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("modules");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    std::fs::create_dir_all(folder.join("src")).unwrap();
    let write = |name: &str, text: &[u8]| std::fs::write(folder.join(name), text).unwrap();
    let manifest = format!(
        "[package]\nname = \"modules\"\nedition = \"2024\"\n\n[dependencies]\nmesh-damper = {{ path = {:?} }}\n\n\
         [profile.dev]\nopt-level = 1\ndebug = false\n\n[workspace]\n",
        root.canonicalize().unwrap()
    );
    write("Cargo.toml", manifest.as_bytes());
    // The versions that everything else is built with.
    let lock = std::fs::read(root.join("Cargo.lock")).unwrap();
    write("Cargo.lock", &lock);
    let mut program = String::new();
    let mut names = String::new();
    for (name, export) in exports {
        write(&format!("src/{name}.rs"), export.rust().unwrap().as_bytes());
        writeln!(program, "mod {name};").unwrap();
        write!(names, "{name} ").unwrap();
    }
    write!(program, "{PROGRAM}\nrun! {{ {names}}}\n").unwrap();
    write("src/main.rs", program.as_bytes());
    let records: Vec<u8> = motions.iter().flat_map(record).collect();
    write("motions.bin", &records);
    let said = printed(&folder);
    let mut lines = said.lines();
    let ran = exports.iter().map(|_| Ran {
        said: lines.next().unwrap().to_owned(),
        forces: lines
            .by_ref()
            .take(motions.len())
            .map(|bits| f32::from_bits(bits.parse().unwrap()))
            .collect(),
    });
    ran.collect()
}

/// What the program in `folder` prints.
fn printed(folder: &PathBuf) -> String {
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(["run", "--quiet", "--offline"])
        .current_dir(folder);
    cargo.env("CARGO_TARGET_DIR", folder.join("target"));
    let output = cargo.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    String::from_utf8(output.stdout).unwrap()
}

fn record(motion: &Motion<f32>) -> Vec<u8> {
    let [a, b, c, d] = motion.controls;
    [
        motion.displacement,
        motion.velocity,
        motion.acceleration,
        motion.cycles,
        motion.temperature,
        a,
        b,
        c,
        d,
    ]
    .iter()
    .flat_map(|value| value.to_le_bytes())
    .collect()
}
