//! Flash, RAM and stack of small images, each with one use of the crate (`firmware/src/sizes`).

use mesh_damper_link::image::{self, Image, sections};
use mesh_damper_output::error::InputError;

use super::count::{Core, run_to_end};
use super::results::Size;

/// Mixed damping law, stick-slip and the results of each cycle, in a law of a static type.
const STATIC_LAW: &str = "static-law";
/// A law read from a pack.
const RUNNING_LAW: &str = "running-law";
/// The law with one effect: as a static type, or read from a pack.
const ONE_EFFECT: [&str; 2] = ["one-effect-static", "one-effect-pack"];
/// The damper from docs/firmware.md.
pub const DAMPER: &str = "damper";
/// The constructors that targets call, one after the other: for this image only the stack of each counts.
const CONSTRUCTORS: &str = "constructors";

/// Sizes of each use on the board of `core`, and the stack of each constructor.
///
/// # Errors
/// An error of the compiler or the emulator, or unexpected output of an image.
pub fn measure(core: Core) -> Result<Vec<Size>, InputError> {
    let mut all = Vec::new();
    let [of_its_type, from_pack] = ONE_EFFECT;
    for binary in [
        STATIC_LAW,
        RUNNING_LAW,
        of_its_type,
        from_pack,
        DAMPER,
        CONSTRUCTORS,
    ] {
        let image = Image {
            binary,
            feature: "sizes",
            cfg: None,
        };
        let elf = image::build(&image, core.board())?;
        let size = |name: &str, of, bytes| Size {
            name: name.into(),
            of,
            bytes,
        };
        let said = run_to_end(&elf, core)?;
        let stacks = said.lines().map(|line| {
            let (name, bytes) = line.rsplit_once(' ')?;
            Some((name, bytes.parse().ok()?))
        });
        let stacks: Option<Vec<(&str, u64)>> = stacks.collect();
        let stacks = stacks.ok_or_else(|| {
            let remedy = "report this";
            InputError::new(
                elf.display().to_string(),
                format!("said what is no size: {said}"),
                remedy,
            )
        })?;
        if binary == CONSTRUCTORS {
            let each = stacks.iter().filter(|(name, _)| *name != "stack");
            all.extend(each.map(|&(name, bytes)| size(name, "stack", bytes)));
            continue;
        }
        let taken = sections(&elf)?;
        all.push(size(binary, "flash", taken.flash));
        all.push(size(binary, "RAM", taken.ram));
        all.extend(
            stacks
                .iter()
                .map(|&(_, bytes)| size(binary, "stack", bytes)),
        );
    }
    Ok(all)
}
