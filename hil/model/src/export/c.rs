//! A pack as C99: a header with its description, and a source with its bytes.

use std::fmt::Write as _;

use mesh_damper::pack::{PackInfo, Stamp};

use super::c_identifier;
use crate::Control;

/// Bytes of the pack per line.
const ON_A_LINE: usize = 16;

/// Header and source of `pack`, described by `info`; its law sees these control inputs.
pub fn files(info: &PackInfo, controls: &[Control], pack: &[u8], stem: &str) -> [String; 2] {
    let name = c_identifier(&info.name);
    [
        header(&name, info, controls, pack.len()),
        source(&name, info, pack, stem),
    ]
}

fn header(name: &str, info: &PackInfo, controls: &[Control], length: usize) -> String {
    let upper = name.to_ascii_uppercase();
    let quoted = quoted(&info.name);
    let Stamp {
        tick_rate,
        revision,
        ..
    } = info.stamp;
    let mut arrays = String::new();
    let mut array = |what: &str, declaration: String| {
        let _ = write!(arrays, "/* {what} */\nextern const {declaration};\n");
    };
    array(
        "The coefficient pack.",
        format!("uint8_t {name}_pack[{upper}_PACK_LENGTH]"),
    );
    array(
        "Identity of the model.",
        format!("uint8_t {name}_identity[8]"),
    );
    for (field, of, _) in numbers(info) {
        let (count, what) = match of {
            Of::Range(what) => (
                "[2]",
                format!("{what} of the motion that it was fitted on: least and largest."),
            ),
            Of::Number(what) => ("", what.to_owned()),
        };
        array(&what, format!("float {name}_{field}{count}"));
    }
    let mut inputs = String::new();
    for (place, control) in controls.iter().enumerate() {
        let _ = writeln!(
            inputs,
            "/* Control input at index {place} of the controls of a motion, with its unit. */\n#define {upper}_CONTROL_{place} {}",
            self::quoted(&control.name)
        );
    }
    format!(
        "/* Written by `hil export` of mesh-damper {version}. Export the model again instead of changing this. */\n\
         #ifndef MESH_DAMPER_PACK_{upper}_H\n\
         #define MESH_DAMPER_PACK_{upper}_H\n\n\
         #include <stdint.h>\n\n\
         /* Name of the model. */\n\
         #define {upper}_NAME {quoted}\n\
         /* Revision of this export. */\n\
         #define {upper}_REVISION {revision}u\n\
         /* Ticks per second that the law is for, Hz. */\n\
         #define {upper}_TICK_RATE {tick_rate:?}f\n\
         /* Bytes of the pack. */\n\
         #define {upper}_PACK_LENGTH {length}u\n\
         {inputs}\n\
         #ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n\
         {arrays}\n\
         #ifdef __cplusplus\n}}\n#endif\n\n\
         #endif\n",
        version = env!("CARGO_PKG_VERSION"),
    )
}

fn source(name: &str, info: &PackInfo, pack: &[u8], stem: &str) -> String {
    let upper = name.to_ascii_uppercase();
    let mut text = format!(
        "/* Written by `hil export` of mesh-damper {}. Export the model again instead of changing this. */\n\
         #include \"{stem}.h\"\n\n\
         const uint8_t {name}_pack[{upper}_PACK_LENGTH] = {{\n",
        env!("CARGO_PKG_VERSION"),
    );
    for line in pack.chunks(ON_A_LINE) {
        let _ = writeln!(text, "    {},", bytes(line));
    }
    let _ = write!(
        text,
        "}};\nconst uint8_t {name}_identity[8] = {{{}}};\n",
        bytes(&info.stamp.identity.0)
    );
    for (field, of, values) in numbers(info) {
        let values: Vec<String> = values.iter().map(|value| format!("{value:?}f")).collect();
        let values = values.join(", ");
        let _ = match of {
            Of::Range(_) => writeln!(text, "const float {name}_{field}[2] = {{{values}}};"),
            Of::Number(_) => writeln!(text, "const float {name}_{field} = {values};"),
        };
    }
    text
}

/// The kind of a number.
enum Of {
    Range(&'static str),
    Number(&'static str),
}

/// The numbers of the pack's description, if it has them.
fn numbers(info: &PackInfo) -> Vec<(&'static str, Of, Vec<f32>)> {
    let mut numbers = Vec::new();
    if let Some(range) = &info.operating_range {
        let displacement = Of::Range("Displacement in mm");
        numbers.push(("displacement", displacement, range.displacement().to_vec()));
        let velocity = Of::Range("Velocity in mm/s");
        numbers.push(("velocity", velocity, range.velocity().to_vec()));
    }
    if let Some(amplitude) = info.amplitude {
        let of = Of::Number("Amplitude that the law was taken at, mm.");
        numbers.push(("amplitude", of, vec![amplitude]));
    }
    if let Some(density) = info.density {
        let of = Of::Number("Density of the specimen, g/cm3.");
        numbers.push(("density", of, vec![density]));
    }
    numbers
}

fn bytes(bytes: &[u8]) -> String {
    let bytes: Vec<String> = bytes.iter().map(|byte| format!("0x{byte:02x}")).collect();
    bytes.join(", ")
}

/// As a C99 string. Special characters become octal escapes, which a following digit cannot extend; a `?` may begin a trigraph.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for byte in text.bytes() {
        let _ = match byte {
            b'"' | b'\\' | b'?' => write!(quoted, "\\{}", char::from(byte)),
            b' '..=b'~' => write!(quoted, "{}", char::from(byte)),
            _ => write!(quoted, "\\{byte:03o}"),
        };
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_ends_a_string() {
        assert_eq!(quoted("mount 4"), "\"mount 4\"");
        assert_eq!(quoted("a\"b\\c??/"), r#""a\"b\\c\?\?/""#);
        assert_eq!(quoted("ä1\n"), r#""\303\2441\012""#);
    }
}
