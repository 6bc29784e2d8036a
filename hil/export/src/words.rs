//! Describes the output in text.

use std::path::Path;

use mesh_damper_model::export::{c_identifier, rust_module};

use super::{Format, Range, Request, Summary};

impl Request {
    /// The output, its contents and its use.
    pub(crate) fn in_words(&self, summary: &Summary) -> Vec<String> {
        let files: Vec<String> = summary
            .files
            .iter()
            .map(|file| format!("{} ({} bytes)", file.path.display(), file.bytes))
            .collect();
        let mut said = format!(
            "{}: model {}, revision {}, for {} ticks a second",
            files.join(", "),
            summary.identity,
            summary.revision,
            summary.tick_rate
        );
        if let Some(amplitude) = summary.amplitude {
            said += &format!(", at an amplitude of {amplitude} mm");
        }
        if let Some(Range {
            displacement: [low, high],
            velocity: [slowest, fastest],
        }) = summary.operating_range
        {
            said += &format!(", within {low} to {high} mm and {slowest} to {fastest} mm/s");
        }
        if summary.passive {
            said += ", passive";
        }
        let used = match self.format {
            Format::Pack => format!(
                "Load it with pack::decode or Upload::finish and Expectation::at({:?})",
                summary.tick_rate
            ),
            Format::Rust => format!(
                "Use it beside the crate mesh-damper: `#[path = {:?}] mod {module};`, then `{module}::fill(&mut law)` with a \
                 `{module}::DamperLaw`",
                from_src(&self.out).display().to_string(),
                module = rust_module(&self.stem())
            ),
            Format::Fmu => format!(
                "Import it for co-simulation on {}, with steps that are multiples of {} s",
                summary
                    .fmu
                    .as_ref()
                    .map_or(String::new(), |unit| unit.platforms.join(", ")),
                1.0 / self.tick_rate
            ),
            Format::C => {
                let name = c_identifier(&summary.name);
                format!(
                    "Compile the source with your firmware and include the header: {name}_pack has {}_PACK_LENGTH bytes",
                    name.to_ascii_uppercase()
                )
            }
        };
        vec![said, used]
    }
}

/// The path of a module from the folder `src` on: there is the `main.rs` that declares it. A path without `src` stays.
fn from_src(path: &Path) -> &Path {
    let mut rest = path;
    let mut parts = path.components();
    while let Some(part) = parts.next() {
        if part.as_os_str() == "src" && parts.clone().next().is_some() {
            rest = parts.as_path();
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_is_declared_from_the_folder_of_main() {
        for (out, declared) in [
            ("mount.rs", "mount.rs"),
            ("src/mount.rs", "mount.rs"),
            ("/home/me/src/rig/src/laws/mount.rs", "laws/mount.rs"),
            ("laws/mount.rs", "laws/mount.rs"),
        ] {
            assert_eq!(from_src(Path::new(out)), Path::new(declared));
        }
    }
}
