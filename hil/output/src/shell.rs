//! Words of commands to type.

use std::ffi::OsStr;
use std::path::Path;

use crate::terminal::is_obeyed;

/// `name` as a shell reads it in a command: as it is, in quotes, or as `$'…'`, which shells of today know, if it holds what a terminal
/// would obey or what is no text.
///
/// ```
/// use mesh_damper_output::shell::word;
///
/// assert_eq!(word("force_kN"), "force_kN");
/// assert_eq!(word("Bob's force"), r"'Bob'\''s force'");
/// assert_eq!(word("a\u{1b}b's"), r"$'a\033b\'s'");
/// ```
pub fn word(name: impl AsRef<OsStr>) -> String {
    let bytes = name.as_ref().as_encoded_bytes();
    match std::str::from_utf8(bytes) {
        Ok(name) if !name.is_empty() && name.chars().all(is_plain) => name.to_owned(),
        Ok(name) if !name.contains(is_obeyed) => format!("'{}'", name.replace('\'', r"'\''")),
        _ => escaped(bytes),
    }
}

/// A file as an argument of a command, or as the value of an option: [`word`], which no option can be mistaken for.
pub fn file(path: &Path) -> String {
    if path.as_os_str().as_encoded_bytes().starts_with(b"-") {
        return word(Path::new(".").join(path));
    }
    word(path)
}

fn is_plain(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || "_-./:+".contains(letter)
}

/// The bytes in `$'…'`. Three octal digits end by themselves in all shells; hexadecimal ones do not.
fn escaped(bytes: &[u8]) -> String {
    let octal =
        |bytes: &[u8]| -> String { bytes.iter().map(|byte| format!("\\{byte:03o}")).collect() };
    let mut word = "$'".to_owned();
    for chunk in bytes.utf8_chunks() {
        for letter in chunk.valid().chars() {
            match letter {
                '\'' | '\\' => word.extend(['\\', letter]),
                _ if is_obeyed(letter) => {
                    word += &octal(letter.encode_utf8(&mut [0; 4]).as_bytes())
                }
                _ => word.push(letter),
            }
        }
        word += &octal(chunk.invalid());
    }
    word.push('\'');
    word
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::ffi::OsStrExt as _;
    use std::process::Command;

    use super::*;

    /// What bash makes of a command is the name again, and the command can be shown.
    #[test]
    fn a_shell_reads_a_word_as_the_name() {
        let names: [&[u8]; 12] = [
            b"force_kN",
            b"",
            b"two words",
            b"it's",
            b"a\\b$HOME`id`\"!*?",
            b"\x1b[2J\x07",
            b"a\n  next: rm b\r",
            b"tab\tand 1\x01234",
            "größe\u{202e}gpj.\u{2066}".as_bytes(),
            "\u{9b}31m'\\\u{200b}".as_bytes(),
            b"latin \xe4 1",
            b"$'x'",
        ];
        for name in names {
            let name = OsStr::from_bytes(name);
            let word = word(name);
            assert_eq!(crate::terminal::visible(&word), word);
            // In any locale.
            for locale in ["C", "C.UTF-8"] {
                let output = Command::new("bash")
                    .args(["-c", &format!("printf %s {word}")])
                    .env("LC_ALL", locale)
                    .output()
                    .unwrap();
                assert_eq!(OsStr::from_bytes(&output.stdout), name, "{word}");
            }
        }
    }

    #[test]
    fn a_file_is_no_option() {
        assert_eq!(file(Path::new("-rf.csv")), "./-rf.csv");
        assert_eq!(file(Path::new("--a b")), "'./--a b'");
        assert_eq!(file(Path::new("a/-b")), "a/-b");
    }
}
