//! The archive of an FMU: the description, the model, and the library for each platform.
//!
//! The same model and libraries give the same bytes: all files in the archive are dated 1980.

use std::fs;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use mesh_damper_fmu::contents::{Contents, MODEL, SETTINGS};
use mesh_damper_fmu::description::description;
use mesh_damper_fmu::{IDENTIFIER, MARK};
use mesh_damper_model::export::Export;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::{InputError, Place};
use serde::Serialize;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The identity of an FMU, and its platforms.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Unit {
    /// Hash of model, settings and library.
    pub guid: String,
    /// FMI names of the platforms for which the FMU has a library.
    pub platforms: Vec<&'static str>,
}

/// A library as a file of an FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct Library {
    platform: Platform,
    bytes: Vec<u8>,
}

/// A platform, by the name of its folder in an FMU.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Platform {
    name: &'static str,
    ending: &'static str,
}

const fn platform(name: &'static str, ending: &'static str) -> Platform {
    Platform { name, ending }
}

impl Platform {
    /// The platform of a library, from the first bytes of its file.
    fn of(bytes: &[u8]) -> Option<Self> {
        let at = |place: usize| bytes.get(place..place + 4);
        match at(0)? {
            // Whatever the processor: FMI 2.0 names only distinguish the number of bits.
            b"\x7fELF" => match bytes.get(4)? {
                1 => Some(platform("linux32", "so")),
                2 => Some(platform("linux64", "so")),
                _ => None,
            },
            // 64 bits, or one file for several processors.
            [0xcf, 0xfa, 0xed, 0xfe] | [0xca, 0xfe, 0xba, 0xbe] => {
                Some(platform("darwin64", "dylib"))
            }
            [b'M', b'Z', ..] => {
                let head = u32::from_le_bytes(at(0x3c)?.try_into().ok()?) as usize;
                if at(head)? != b"PE\0\0" {
                    return None;
                }
                match bytes.get(head + 4..head + 6)? {
                    [0x64, 0x86] => Some(platform("win64", "dll")),
                    [0x4c, 0x01] => Some(platform("win32", "dll")),
                    _ => None,
                }
            }
            _ => None,
        }
    }
}

/// The libraries that are `named`, one for each platform, plus the library in the first of `folders` that has one if none of them
/// is for this platform.
///
/// # Errors
/// A file is not such a library, two are for the same platform, or there is none.
pub fn libraries(named: &[PathBuf], folders: &[PathBuf]) -> Result<Vec<Library>, InputError> {
    let mut all: Vec<Library> = Vec::new();
    for path in named {
        let library = library(path)?;
        if all.iter().any(|other| other.platform == library.platform) {
            return Err(InputError::new(
                path.display().to_string(),
                format!("a second library for {}", library.platform.name),
                "give one for each platform",
            ));
        }
        all.push(library);
    }
    let mut places = folders.iter().map(|folder| folder.join(file_name()));
    match places.find(|path| path.is_file()) {
        Some(path) => {
            let own = library(&path)?;
            if all.iter().all(|other| other.platform != own.platform) {
                all.push(own);
            }
        }
        None if all.is_empty() => {
            return Err(InputError::new(
                "--library",
                format!("there is no {} beside this program", file_name()),
                "build it with `cargo build --release -p mesh-damper-fmu`, and give --library target/release/".to_owned()
                    + &file_name(),
            ));
        }
        None => {}
    }
    all.sort_by_key(|library| library.platform.name);
    Ok(all)
}

/// The name of the library for this platform.
pub fn file_name() -> String {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    format!("{DLL_PREFIX}{IDENTIFIER}{DLL_SUFFIX}")
}

/// The folders that may contain the library: built together with this program, or installed next to it.
pub fn beside_this_program() -> Vec<PathBuf> {
    let program = std::env::current_exe().ok();
    let folder = program.as_deref().and_then(Path::parent);
    // The first is from the same build as this program; the second may be from an earlier build.
    folder.map_or_else(Vec::new, |folder| {
        vec![folder.join("deps"), folder.to_owned()]
    })
}

fn library(path: &Path) -> Result<Library, InputError> {
    let refused = |problem: String, remedy: &str| {
        Err(InputError::new(path.display().to_string(), problem, remedy))
    };
    let bytes = fs::read(path).map_err(|error| InputError::io(path, "read", &error))?;
    let Some(platform) = Platform::of(&bytes) else {
        return refused(
            "no library for linux64, linux32, darwin64, win64 or win32".into(),
            "give what `cargo build --release -p mesh-damper-fmu` built for one of these",
        );
    };
    let is_marked = |bytes: &[u8]| {
        let mut places = bytes.windows(MARK.len());
        places.any(|place| place == MARK.as_bytes())
    };
    if !is_marked(&bytes) {
        return refused(
            format!("not the library of {MARK}"),
            "build it of this source with `cargo build --release -p mesh-damper-fmu`",
        );
    }
    Ok(Library { platform, bytes })
}

/// The bytes of an FMU; `model` is the name of the model's file.
///
/// # Errors
/// A control input has the name of another variable.
pub fn packed(
    file: &ModelFile,
    export: &Export,
    tick_rate: f64,
    libraries: &[Library],
    model: &str,
) -> Result<(Vec<u8>, Unit), InputError> {
    let (contents, [model_json, settings]) = Contents::of_export(file, export, tick_rate);
    let description = description(&contents).map_err(|refusal| {
        InputError::new(model, refusal.message, "rename it and trace again")
            .at(Place::Field("controls".into()))
    })?;
    let mut files = vec![
        ("modelDescription.xml".to_owned(), description.as_bytes()),
        (format!("resources/{MODEL}"), &model_json),
        (format!("resources/{SETTINGS}"), &settings),
    ];
    for Library { platform, bytes } in libraries {
        let Platform { name, ending } = platform;
        files.push((format!("binaries/{name}/{IDENTIFIER}.{ending}"), bytes));
    }
    let unit = Unit {
        guid: contents.guid.clone(),
        platforms: libraries.iter().map(|each| each.platform.name).collect(),
    };
    match archive(&files) {
        Ok(bytes) => Ok((bytes, unit)),
        Err(error) => Err(InputError::new(
            model,
            format!("the archive cannot be made: {error}"),
            "give smaller libraries",
        )),
    }
}

fn archive(files: &[(String, &[u8])]) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let is_library = name.starts_with("binaries/");
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(if is_library { 0o755 } else { 0o644 });
        archive.start_file(name.as_str(), options)?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_platform_is_told_by_the_first_bytes() {
        let windows = |machine: [u8; 2]| {
            let mut bytes = vec![0; 0x80];
            bytes[..2].copy_from_slice(b"MZ");
            bytes[0x3c] = 0x70;
            bytes[0x70..0x74].copy_from_slice(b"PE\0\0");
            bytes[0x74..0x76].copy_from_slice(&machine);
            bytes
        };
        let name = |bytes: &[u8]| Platform::of(bytes).map(|platform| platform.name);
        assert_eq!(name(b"\x7fELF\x02\x01"), Some("linux64"));
        assert_eq!(name(b"\x7fELF\x01\x01"), Some("linux32"));
        assert_eq!(name(b"\xcf\xfa\xed\xfe"), Some("darwin64"));
        assert_eq!(name(&windows([0x64, 0x86])), Some("win64"));
        assert_eq!(name(&windows([0x4c, 0x01])), Some("win32"));
        assert_eq!(name(&windows([0x64, 0xaa])), None);
        let cut = &windows([0x64, 0x86])[..0x75];
        for other in [&b""[..], b"\x7fEL", b"\x7fELF", b"PK\x03\x04", b"MZ", cut] {
            assert_eq!(name(other), None);
        }
    }
}
