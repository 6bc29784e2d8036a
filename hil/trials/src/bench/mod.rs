//! The cost of the crate on a microcontroller: instructions counted in an emulator, compared to its peers, with the errors against
//! f64 and the bytes.
//!
//! `firmware/src/bench` is the counting image. It calls one region at a time, and reads the timer before and after; the emulator
//! advances that timer by 2¹⁰ ns per instruction. A call's count is exact and the same in every run. It includes the registers that
//! the called function saves and restores; the call itself, measured with an empty function, is subtracted. Sequences of known
//! length are counted first, and a run with wrong counts for them is refused. Instructions are not cycles: an emulator has no
//! caches, no wait states and no pipeline.
//!
//! The counted code is in `firmware/src/bench/suite`. The host runs it too, with the same result in every bit, to determine its
//! errors.
//!
//! The whole tick is that of [`mesh_damper::simulation`], for a demanded sine. The generator, the law and the accumulator, which
//! make up the rig and work for any motion and any force, are counted as well.
//!
//! # Peers
//! The peers are libm and micromath in the same image, and the whole tick written in the obvious way with libm's sine, cosine and
//! power; and the same in C (`hil/trials/bench/peer.c`) with newlib's functions, as a separate image. Both give the results of the
//! crate's tick and leave out the same ones: means and harmonics, which are known for a sine and an odd law. micromath is only a
//! peer: its |v|^α is off by some percent, which goes directly into force and loss factor. No quantity in the tick tolerates that.

mod baseline;
mod count;
mod exact;
mod firmware;
mod judge;
mod limits;
mod peer;
mod rates;
mod results;
mod sizes;
mod uses;

use std::path::PathBuf;
use std::process::Command;

pub use baseline::{Baseline, Entry};
pub use count::{Core, Count};
pub use judge::LargestError;
pub use limits::{Side, Verdict, counted_effects};
pub use results::{Rate, Results, Size, Tools};

use mesh_damper_firmware::bench::suite;
use mesh_damper_link::image::{self, Image};
use mesh_damper_output::error::InputError;
use mesh_damper_output::process;
use mesh_damper_output::scratch::Scratch;

/// The image that counts.
pub const IMAGE: Image = Image {
    binary: "bench",
    feature: "bench",
    cfg: None,
};

/// The same image, with a rig without a monitor.
const UNMONITORED: Image = Image {
    cfg: Some("unmonitored"),
    ..IMAGE
};

/// Ticks per block of `tick/block`.
pub const BLOCK: usize = suite::tick::BLOCK;

/// Counts, judges and measures everything. `progress` receives a description of each step.
///
/// # Errors
/// There is no emulator or no compiler for the image, the image fails, or the counts are not reliable.
pub fn run(progress: &dyn Fn(&str)) -> Result<Results, InputError> {
    let (elf, counts) = count_core(Core::CortexM4f, progress)?;
    progress("judging what was counted");
    let mut errors = judge::powers().map_err(refused)?;
    errors.extend(judge::ticks().map_err(refused)?);
    let mut results = Results {
        tools: Tools {
            rustc: first_line("rustc"),
            c: peer::compiler(),
            emulator: first_line("qemu-system-arm"),
        },
        sizes: sizes::of_counted(&elf)?,
        counts,
        errors,
        ..Results::default()
    };
    results
        .counts
        .extend(count_unmonitored(Core::CortexM4f, progress)?);
    progress("timing the rig in this process");
    results.rates.push(rates::in_process()?);
    progress("counting the peer in C");
    match count_peer(Core::CortexM4f) {
        Ok((counts, sizes)) => {
            results.counts.extend(counts);
            results.sizes.extend(sizes);
        }
        Err(error) => results.left_out.push(error.to_string()),
    }
    match count_core(Core::CortexM0, progress) {
        Ok((_, counts)) => results.counts.extend(counts),
        Err(error) => results.left_out.push(error.to_string()),
    }
    progress("sizing small images");
    results.sizes.extend(uses::measure(Core::CortexM4f)?);
    progress("running the firmware's image");
    let (sizes, rate) = firmware::measure(Core::CortexM4f.board())?;
    results.sizes.extend(sizes);
    results.rates.push(rate);
    results.limits = limits::verdicts(&results);
    Ok(results)
}

/// Counts everything on `core`, and checks that its results equal the host's.
fn count_core(core: Core, progress: &dyn Fn(&str)) -> Result<(PathBuf, Vec<Count>), InputError> {
    let board = core.board();
    board.check()?;
    progress(&format!(
        "building the image that counts on a {}",
        core.name()
    ));
    let elf = image::build(&IMAGE, board)?;
    progress(&format!("counting on a {}", core.name()));
    let mut counts = count::count(&elf, core)?.counts;
    check_known(&counts)?;
    counts.retain(|count| !count.name.starts_with(KNOWN));
    let mismatches = judge::mismatches(core, &counts).map_err(refused)?;
    if mismatches.is_empty() {
        Ok((elf, counts))
    } else {
        Err(untrusted(format!(
            "image and host give other results for {}",
            mismatches.join(", ")
        )))
    }
}

/// The rig's tick without its monitor.
fn count_unmonitored(core: Core, progress: &dyn Fn(&str)) -> Result<Vec<Count>, InputError> {
    progress("counting the rig without its monitor");
    let elf = image::build(&UNMONITORED, core.board())?;
    let mut counts = count::count(&elf, core)?.counts;
    check_known(&counts)?;
    counts.retain(|count| count.name == "rig/tick");
    for count in &mut counts {
        count.name = "rig/unmonitored".into();
    }
    Ok(counts)
}

fn refused(_: suite::Refused) -> InputError {
    untrusted("the host refuses what the image counted".into())
}

/// The peer in C, whose cycles have to equal ours.
fn count_peer(core: Core) -> Result<(Vec<Count>, Vec<Size>), InputError> {
    let directory =
        Scratch::new().map_err(|error| InputError::io(&std::env::temp_dir(), "write", &error))?;
    let elf = peer::build(directory.path())?;
    let said = count::count(&elf, core)?;
    judge::check_peer(&said.results).map_err(untrusted)?;
    Ok((said.counts, sizes::of_peer(&elf)?))
}

/// Prefix of the names of sequences with known length; the length follows.
const KNOWN: &str = "known/nops-";

/// Refuses counts in which a sequence of known length has another count.
fn check_known(counts: &[Count]) -> Result<(), InputError> {
    let mut known = 0;
    for count in counts {
        let Some(length) = count.name.strip_prefix(KNOWN) else {
            continue;
        };
        known += 1;
        let [least, most] = [count.least, count.most].map(|length| length.to_string());
        if [&least, &most] != [length, length] {
            return Err(untrusted(format!(
                "{length} instructions were counted as {least} to {most}"
            )));
        }
    }
    if known == 0 {
        return Err(untrusted("no known sequence was counted".into()));
    }
    Ok(())
}

fn untrusted(problem: String) -> InputError {
    let remedy = "report this, with the emulator's version";
    InputError::new("the counts", problem, remedy)
}

/// A tool's version line.
fn first_line(tool: &str) -> String {
    let output = process::output(Command::new(tool).arg("--version"));
    output.map_or_else(
        |_| String::new(),
        |output| {
            let text = String::from_utf8_lossy(&output.stdout);
            text.lines().next().unwrap_or_default().to_owned()
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(name: &str, least: u64, most: u64) -> Count {
        Count {
            core: Core::CortexM0,
            name: name.into(),
            moment: "call".into(),
            calls: 1,
            mean: most as f64,
            least,
            most,
            checksum: 0,
        }
    }

    #[test]
    fn counts_are_trusted_only_beside_known_sequences_counted_right() {
        let right = counted("known/nops-7", 7, 7);
        assert!(check_known(&[right.clone(), counted("power/table", 16, 17)]).is_ok());
        assert!(check_known(&[counted("power/table", 16, 16)]).is_err());
        for (least, most) in [(6, 7), (7, 8), (8, 8)] {
            let wrong = counted("known/nops-7", least, most);
            assert!(check_known(&[right.clone(), wrong]).is_err());
        }
    }
}
