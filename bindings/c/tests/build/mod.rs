//! Builds the library, and programs in C that use it, for this machine and for the emulated board, and runs them. Shared by the
//! tests.
#![allow(dead_code, reason = "not every test uses all of it")]

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Once, OnceLock};

use mesh_damper_link::image::Board;

/// Where a program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    Host,
    Emulator,
}

impl On {
    pub const BOTH: [Self; 2] = [Self::Host, Self::Emulator];

    fn compiler(self) -> &'static str {
        match self {
            Self::Host => "gcc",
            Self::Emulator => "arm-none-eabi-gcc",
        }
    }

    /// A tool of the compiler's binutils.
    pub fn tool(self, name: &str) -> String {
        match self {
            Self::Host => name.to_owned(),
            Self::Emulator => format!("arm-none-eabi-{name}"),
        }
    }

    /// The name in `bindings/c/Makefile`.
    fn target(self) -> &'static str {
        match self {
            Self::Host => "",
            Self::Emulator => BOARD.target(),
        }
    }
}

const BOARD: Board = Board::Mps2An386;

pub fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The example's folder, whose start-up code and linker script the tests use.
pub fn example() -> PathBuf {
    here().join("../../examples/c")
}

/// Whether this machine has the tools for a program that runs `on`. If not, a message says which tests are skipped. If `CI` is
/// `true`, nothing may be skipped, and it fails.
pub fn can(on: On) -> bool {
    let starts = |program: &str| {
        let mut command = Command::new(program);
        command
            .arg("--version")
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    let missing = [
        ("make", "apt-get install make"),
        (
            on.compiler(),
            match on {
                On::Host => "apt-get install gcc",
                On::Emulator => "apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi",
            },
        ),
    ]
    .into_iter()
    .find(|(program, _)| !starts(program))
    .map(|(program, remedy)| format!("{program} is not installed: {remedy}"))
    .or_else(|| match on {
        On::Host => None,
        On::Emulator => BOARD.check().err().map(|error| error.to_string()),
    });
    let Some(missing) = missing else {
        return true;
    };
    assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{missing}");
    // Once for all tests, and past their harness, which hides the output of passing tests.
    static SAID: [Once; 2] = [const { Once::new() }; 2];
    SAID[on as usize].call_once(|| {
        let said = writeln!(
            std::io::stderr(),
            "left out, no program in C is run ({on:?}): {missing}"
        );
        said.unwrap();
    });
    false
}

/// Runs `command` to its end and returns its output.
pub fn run(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command.stdin(Stdio::null()).output().unwrap();
    let [said, complaint] =
        [stdout, stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(status.success(), "{command:?} fails\n{said}\n{complaint}");
    said
}

/// `make` in `folder`, independent of a `make` that runs the tests.
pub fn make(folder: &Path) -> Command {
    let mut command = Command::new("make");
    command
        .arg("--silent")
        .arg("--no-print-directory")
        .arg("-C")
        .arg(folder);
    command.env_remove("MAKEFLAGS").env_remove("MAKELEVEL");
    // Cargo's variables for the test do not apply to the cargo that builds the library.
    command
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env("CARGO", env!("CARGO"));
    command
        .env("RUSTFLAGS", "")
        .env("CARGO_TARGET_DIR", target_directory());
    command
}

fn target_directory() -> PathBuf {
    let root = here().join("../..");
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(directory) => root.join(directory),
        None => root.join("target"),
    }
}

/// The library, built.
pub fn library(on: On) -> PathBuf {
    let command = |goal| {
        let mut command = make(here());
        command.arg(goal).arg(format!("TARGET={}", on.target()));
        command
    };
    // Once: a test that builds it again would remove the archive that another one links.
    static BUILT: [OnceLock<PathBuf>; 2] = [const { OnceLock::new() }; 2];
    let built = BUILT[on as usize].get_or_init(|| {
        run(&mut command("all"));
        PathBuf::from(run(&mut command("path")).trim())
    });
    built.clone()
}

/// A program from `sources` and the contents of `folder`: headers, and the packs of `packs` by their stems.
pub struct Program<'p> {
    pub on: On,
    pub folder: &'p Path,
    pub sources: &'p [PathBuf],
    pub packs: &'p [&'p str],
    /// Name of the linker's map, in `folder`.
    pub map: Option<&'p str>,
}

impl Program<'_> {
    /// Compiles and links the program.
    pub fn build(&self) -> PathBuf {
        let elf = self.folder.join(format!("{:?}.elf", self.on));
        let mut command = Command::new(self.on.compiler());
        command.args([
            "-std=c99",
            "-O2",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-pedantic",
        ]);
        command.args([
            "-ffunction-sections",
            "-fdata-sections",
            "-Wl,--gc-sections,-z,noexecstack",
        ]);
        if self.on == On::Emulator {
            let board = example().join("mps2-an386");
            command.args([
                "-mcpu=cortex-m4",
                "-mthumb",
                "-mfloat-abi=hard",
                "-mfpu=fpv4-sp-d16",
            ]);
            command
                .args(["-nostartfiles", "--specs=rdimon.specs", "-T"])
                .arg(board.join("mps2-an386.ld"));
            command.arg(board.join("startup.c"));
        }
        if let Some(map) = self.map {
            command.arg(format!("-Wl,-Map={}", self.folder.join(map).display()));
        }
        command
            .arg("-I")
            .arg(here().join("include"))
            .arg("-I")
            .arg(self.folder);
        command.args(self.sources);
        command.args(
            self.packs
                .iter()
                .map(|stem| self.folder.join(format!("{stem}.c"))),
        );
        command.arg(library(self.on)).arg("-lm").arg("-o").arg(&elf);
        run(&mut command);
        elf
    }

    /// Runs the program in its folder, and returns its output.
    pub fn run(&self) -> String {
        let elf = self.build();
        let mut command = match self.on {
            On::Host => Command::new(&elf),
            On::Emulator => emulator(&elf),
        };
        run(command.current_dir(self.folder))
    }
}

/// The emulator with `elf`, in which an instruction takes 2^10 ns and time passes only that way.
pub fn emulator(elf: &Path) -> Command {
    let mut command = BOARD.emulator(elf).unwrap();
    command.args(["-icount", "shift=10,sleep=off"]);
    command.args(["-chardev", "stdio,id=said"]);
    command.args([
        "-semihosting-config",
        "enable=on,target=native,chardev=said",
    ]);
    command
}

/// A source of these tests.
pub fn source(name: &str) -> PathBuf {
    here().join("tests/c").join(name)
}

/// Names of the functions that the header declares.
pub fn declared() -> BTreeSet<String> {
    let header = std::fs::read_to_string(here().join("include/mesh_damper.h")).unwrap();
    header
        .lines()
        .filter(|line| !line.starts_with([' ', '/', '#']) && line.contains('('))
        .filter_map(|line| line.split('(').next()?.split([' ', '*']).next_back())
        .filter(|name| name.starts_with("md_"))
        .map(str::to_owned)
        .collect()
}
