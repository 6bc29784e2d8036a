//! Lines for a person, on standard output and standard error: nothing that a person reads goes there in another way.

use std::borrow::Cow;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::OnceLock;

use crate::ending;
use crate::error::InputError;

/// The first error of standard output.
static UNSAID: OnceLock<io::Error> = OnceLock::new();

/// Prints a line of results to standard output, [`visible`]. A reader that closed the pipe has seen enough; any other error is kept
/// for [`check_said`].
pub fn say(line: &str) {
    match write(&mut io::stdout(), line) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            // The first error counts.
            let _ = UNSAID.set(error);
        }
        _ => {}
    }
}

/// Prints a line about the work to standard error, [`visible`]. The work goes on where nobody can read it.
pub fn tell(line: &str) {
    // There is no other place to say that.
    let _ = write(&mut io::stderr(), line);
}

/// Whether standard output took every line.
///
/// # Errors
/// The first reason why it did not, except that its reader was gone.
pub fn check_said() -> Result<(), InputError> {
    let failed = |error| Err(unwritten(error));
    UNSAID.get().map_or(Ok(()), failed)
}

/// The error of a standard output that cannot be written.
pub fn unwritten(error: &io::Error) -> InputError {
    InputError::io(Path::new("standard output"), "write", error)
}

fn write(output: &mut impl Write, line: &str) -> io::Result<()> {
    // A program that a signal ends has no more to say.
    drop(ending::whole());
    let mut line = visible(line).into_owned();
    line.push('\n');
    // In one piece, so that lines of several threads do not mix.
    output.write_all(line.as_bytes())?;
    output.flush()
}

/// A text as one line in which each character that a terminal would obey is escaped, such as `\u{1b}` or `\n`: file names, columns
/// and comments can hold any.
///
/// ```
/// use mesh_damper_output::terminal::visible;
///
/// assert_eq!(visible("größe\u{202e}\r\n"), r"größe\u{202e}\r\n");
/// ```
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return text.into();
    }
    let mut shown = String::new();
    for letter in text.chars() {
        if is_obeyed(letter) {
            shown.extend(letter.escape_default());
        } else {
            shown.push(letter);
        }
    }
    shown.into()
}

/// Several lines as a terminal may show them; a file or a program gets them as they are.
pub(crate) fn visible_lines(text: &str) -> String {
    let lines = text.split_inclusive('\n').map(|line| {
        let (line, end) = line
            .strip_suffix('\n')
            .map_or((line, ""), |line| (line, "\n"));
        let cells: Vec<Cow<'_, str>> = line.split('\t').map(visible).collect();
        cells.join("\t") + end
    });
    lines.collect()
}

/// Whether a terminal obeys a character instead of showing it, or shows nothing: control characters, ends of lines and paragraphs,
/// marks of annotations, and what Unicode 16 lists as `Default_Ignorable_Code_Point`, to which all directions of text belong.
pub(crate) fn is_obeyed(letter: char) -> bool {
    letter.is_control()
        || matches!(
            letter,
            '\u{ad}'
                | '\u{34f}'
                | '\u{61c}'
                | '\u{115f}'..='\u{1160}'
                | '\u{17b4}'..='\u{17b5}'
                | '\u{180b}'..='\u{180f}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}'
                | '\u{3164}'
                | '\u{fe00}'..='\u{fe0f}'
                | '\u{feff}'
                | '\u{ffa0}'
                | '\u{fff0}'..='\u{fffb}'
                | '\u{1bca0}'..='\u{1bca3}'
                | '\u{1d173}'..='\u{1d17a}'
                | '\u{e0000}'..='\u{e0fff}'
        )
}

/// A time in s, with the precision that matters.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.ceil() as u64;
    match whole {
        0..100 => format!("{whole} s"),
        100..6000 => format!("{} min", whole.div_ceil(60)),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_stay_as_they_are() {
        assert_eq!(
            visible_lines("a\tb\n\u{1b}[2J\t1\r\nc"),
            "a\tb\n\\u{1b}[2J\t1\\r\nc"
        );
    }

    #[test]
    fn what_a_terminal_obeys_is_escaped_and_nothing_else() {
        for (text, shown) in [
            ("force_kN", "force_kN"),
            (
                r"C:\tests\3 'a' — größer, 力 [кН]",
                r"C:\tests\3 'a' — größer, 力 [кН]",
            ),
            // An accent that is a character of its own, as in the names of some systems.
            ("u\u{308}ber", "u\u{308}ber"),
            (
                "\u{1b}[2J\u{7}\u{8}\r\n\t\u{7f}",
                r"\u{1b}[2J\u{7}\u{8}\r\n\t\u{7f}",
            ),
            ("\u{9b}31m\u{85}", r"\u{9b}31m\u{85}"),
            (
                "a\u{202e}b\u{2066}c\u{200f}d\u{61c}",
                r"a\u{202e}b\u{2066}c\u{200f}d\u{61c}",
            ),
            (
                "\u{200b}\u{200d}\u{feff}\u{2060}\u{ad}",
                r"\u{200b}\u{200d}\u{feff}\u{2060}\u{ad}",
            ),
            ("\u{2028}\u{2029}\u{e0041}", r"\u{2028}\u{2029}\u{e0041}"),
            ("\u{206a}\u{206f}\u{fe0f}", r"\u{206a}\u{206f}\u{fe0f}"),
        ] {
            assert_eq!(visible(text), shown);
        }
    }

    #[test]
    fn a_line_is_one_line() {
        let mut output = Vec::new();
        write(&mut output, "a\nerror: b\r").unwrap();
        assert_eq!(output, b"a\\nerror: b\\r\n");
    }
}
