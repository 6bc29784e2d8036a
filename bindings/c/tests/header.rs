//! The header in the tree equals the generated one: `BLESS=1 cargo test -p mesh-damper-c --test header` writes it again.

use std::path::Path;

use cbindgen::{Config, DocumentationStyle, EnumConfig, Language, LayoutConfig, RenameRule};
use mesh_damper::health::HealthCause;

/// The beginning of the header: it selects between the two constants for this target, and the alignment of a struct.
const BEFORE: &str = r#"
/* The sizes of this target. */
#if UINTPTR_MAX == 0xFFFFFFFFu
#define MD_POINTERS_OF_32_BITS
#elif UINTPTR_MAX == 0xFFFFFFFFFFFFFFFFu
#define MD_POINTERS_OF_64_BITS
#else
#error "mesh_damper.h: a target's pointers have 32 or 64 bits"
#endif

/* For another compiler, define it before this header. */
#ifndef MD_ALIGNED
#define MD_ALIGNED(bytes) __attribute__((aligned(bytes)))
#endif"#;

const HEADER: &str = "\
/* mesh-damper for C: the law of a metal mesh damper with its effects, per-cycle results, a sine generator, a damper emulation and a rig.
 *
 * Generated from bindings/c of mesh-damper: change that instead. docs/c.md is its page.
 *
 * Units are mm, s, kN and J = kN*mm. All memory is the caller's. No function is called from two contexts at once with the same
 * memory. A function that runs every tick fails only on memory that was never initialised, and its result is finite for every finite input.
 */";

/// Types of the crate and their names in C.
const NAMES: [(&str, &str); 25] = [
    ("Block", "md_block"),
    ("Crossings", "md_crossings"),
    ("Cycle", "md_cycle"),
    ("Cycles", "md_cycles"),
    ("Emulation", "md_emulation"),
    ("EmulationSettings", "md_emulation_settings"),
    ("Error", "md_error"),
    ("Excitation", "md_excitation"),
    ("Excited", "md_programme"),
    ("Expected", "md_expected"),
    ("HealthEvent", "md_health"),
    ("Info", "md_pack_info"),
    ("Law", "md_law"),
    ("Motion", "md_motion"),
    ("Problem", "md_problem"),
    ("Reading", "md_reading"),
    ("Rig", "md_rig"),
    ("RigIo", "md_rig_io"),
    ("RigSettings", "md_rig_settings"),
    ("Sample", "md_sample"),
    ("Scale", "md_scale"),
    ("Sine", "md_sine"),
    ("State", "md_state"),
    ("Telemetry", "md_telemetry"),
    ("Wiring", "md_wiring"),
];

/// The constants of the health causes, from the crate's list, in the form in which cbindgen writes an enumeration.
fn health_causes() -> String {
    let constants = HealthCause::ALL.map(|cause| {
        let description = cause.description();
        let (name, meaning) = match cause.channel() {
            Some(channel) => {
                let of = description.name.strip_prefix("Sensor").unwrap();
                let meaning = description.meaning.strip_prefix("The channel").unwrap();
                let channel = channel.name();
                (
                    format!("{channel}{of}"),
                    format!("The {channel} channel{meaning}"),
                )
            }
            None => (description.name.to_owned(), description.meaning.to_owned()),
        };
        let name: String = name
            .char_indices()
            .flat_map(|(at, c)| {
                let between = (at > 0 && c.is_uppercase()).then_some('_');
                between.into_iter().chain(c.to_uppercase())
            })
            .collect();
        format!("  // {meaning}\n  MD_HEALTH_{name} = {},\n", cause.number())
    });
    let constants = constants.concat();
    format!(
        "
// Findings of a rig's monitor. The numbers are those of the link. A later version may have more of them.
enum md_health
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {{
{constants}}};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum md_health md_health;
#else
typedef int32_t md_health;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus"
    )
}

fn config() -> Config {
    let mut config = Config {
        language: Language::C,
        cpp_compat: true,
        header: Some(HEADER.into()),
        after_includes: Some(format!("{BEFORE}\n{}", health_causes())),
        include_guard: Some("MESH_DAMPER_H".into()),
        no_includes: true,
        sys_includes: ["stdbool.h", "stddef.h", "stdint.h"]
            .map(String::from)
            .into(),
        usize_is_size_t: true,
        documentation_style: DocumentationStyle::C99,
        line_length: 130,
        enumeration: EnumConfig {
            rename_variants: RenameRule::QualifiedScreamingSnakeCase,
            ..EnumConfig::default()
        },
        layout: LayoutConfig {
            aligned_n: Some("MD_ALIGNED".into()),
            ..LayoutConfig::default()
        },
        ..Config::default()
    };
    let pairs = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
        pairs
            .iter()
            .map(|(from, to)| (String::from(*from), String::from(*to)))
            .collect()
    };
    config.export.rename = pairs(&NAMES).into_iter().collect();
    config
        .export
        .rename
        .insert("TripCause".into(), "md_trip".into());
    config.export.exclude = vec!["HealthEvent".into()];
    config.defines = pairs(&[
        ("target_pointer_width = 32", "MD_POINTERS_OF_32_BITS"),
        ("target_pointer_width = 64", "MD_POINTERS_OF_64_BITS"),
    ])
    .into_iter()
    .collect();
    config
}

#[test]
fn the_header_in_the_tree_is_what_the_crate_generates() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = [
        "error",
        "law",
        "pack_info",
        "cycle",
        "sine",
        "converter",
        "telemetry",
        "emulation",
        "rig",
    ];
    let builder = sources.iter().fold(
        cbindgen::Builder::new().with_config(config()),
        |builder, source| builder.with_src(here.join(format!("src/{source}.rs"))),
    );
    let mut header = Vec::new();
    builder.generate().unwrap().write(&mut header);
    let header = String::from_utf8(header).unwrap();
    let path = here.join("include/mesh_damper.h");
    if std::env::var("BLESS").is_ok_and(|bless| bless == "1") {
        std::fs::write(&path, &header).unwrap();
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(there == header, "{}: run with BLESS=1", path.display());
}
