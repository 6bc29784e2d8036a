//! The folder of an FMU's resource location.

use std::path::PathBuf;

use percent_encoding::percent_decode_str;

use crate::refusal::Refusal;

/// The folder of a `file:` URI without a host, or on this host.
///
/// # Errors
/// Another scheme or host, or percent signs that do not encode UTF-8.
pub fn folder(uri: &str) -> Result<PathBuf, Refusal> {
    let refused = |problem: &str| {
        Refusal::new(
            "fmuResourceLocation",
            uri,
            problem,
            "give a URI such as file:///tmp/fmu/resources",
        )
    };
    let scheme = uri.get(..5).filter(|it| it.eq_ignore_ascii_case("file:"));
    if scheme.is_none() {
        return Err(refused("no file: URI"));
    }
    let rest = &uri[5..];
    let path = match rest.strip_prefix("//") {
        Some(with_host) => {
            let slash = with_host.find('/').ok_or_else(|| refused("no path"))?;
            let (host, path) = with_host.split_at(slash);
            if !host.is_empty() && !host.eq_ignore_ascii_case("localhost") {
                return Err(refused("on another host"));
            }
            path
        }
        None => rest,
    };
    if !path.starts_with('/') {
        return Err(refused("no absolute path"));
    }
    let path = percent_decode_str(path)
        .decode_utf8()
        .map_err(|_| refused("not UTF-8 behind its percent signs"))?;
    // /C:/fmu is C:/fmu on systems with drive letters.
    let path = match path.as_bytes() {
        [b'/', letter, b':', ..] if cfg!(windows) && letter.is_ascii_alphabetic() => &path[1..],
        _ => &path,
    };
    Ok(PathBuf::from(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_forms_of_a_file_uri_name_the_same_folder() {
        for uri in [
            "file:///tmp/a b/resources",
            "file:///tmp/a%20b/resources",
            "file:/tmp/a%20b/resources",
            "FILE://localhost/tmp/%61%20b/resources",
        ] {
            assert_eq!(folder(uri).unwrap(), PathBuf::from("/tmp/a b/resources"));
        }
        assert_eq!(folder("file:///%C3%A4").unwrap(), PathBuf::from("/ä"));
    }

    #[test]
    fn what_is_no_folder_of_this_host_is_refused() {
        for (uri, problem) in [
            ("", "no file: URI"),
            ("/tmp/resources", "no file: URI"),
            ("http://host/x", "no file: URI"),
            ("file://host/x", "on another host"),
            ("file://", "no path"),
            ("file:tmp", "no absolute path"),
            ("file:///%ff", "not UTF-8"),
            ("fileä/x", "no file: URI"),
        ] {
            let message = folder(uri).unwrap_err().message;
            assert!(message.contains(problem), "{message}");
            assert!(message.contains("give a URI such as"), "{message}");
        }
    }
}
