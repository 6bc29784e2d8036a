//! The reader of recordings.

use std::io::Write as _;
use std::path::Path;
use std::sync::LazyLock;

use mesh_damper_recording::Recording;

use crate::edit::edited;

const WORDS: [&str; 32] = [
    "NaN",
    "inf",
    "-inf",
    "1e400",
    "-1e-400",
    "1e308",
    "-0",
    "1_000",
    "0x10",
    "",
    " ",
    "\t",
    ",",
    ";",
    "\"",
    "\"\"",
    "\n",
    "\r\n",
    "\r",
    "#",
    "# specimen: x\n",
    "\u{feff}",
    "time_s",
    "time_ms",
    "displacement_m",
    "force_uN",
    "velocity_mm/s",
    "temperature_degC",
    "force_command_kN",
    "\0",
    "\u{1f600}",
    ",,,",
];

static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let rows = |end: &str| -> String {
        let row = |n: u32| {
            let time = 1e-3 * f64::from(n);
            let y = (0.7 * f64::from(n)).sin();
            format!(
                "{time:.3},{:.4},{:.5},{:.3},20.5{end}",
                0.1 * y,
                0.2 * y + 0.01,
                7.0 * y
            )
        };
        (0..12).map(row).collect()
    };
    let header = "time_s,displacement_mm,force_kN,velocity_mm_s,temperature_degC";
    let plain = format!("# specimen: simulated\n{header}\n{}", rows("\n"));
    let other = format!(
        "\u{feff}{}\r\n{}",
        header
            .replace("_mm,", "_um,")
            .replace("force_kN", "force_lbf"),
        rows("\r\n"),
    );
    let quoted = "time_ms,displacement_in,force_N,\"a \"\"name\"\"\"\n".to_owned()
        + &(0..9)
            .map(|n| format!("{n},0.{n},-{n}e-1,\"#{n}, \"\n"))
            .collect::<String>();
    let mut zip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    zip.write_all(plain.as_bytes()).expect("to memory");
    let zipped = zip.finish().expect("to memory");
    vec![plain.into(), other.into(), quoted.into(), zipped]
});

/// A recording that is read is one when it is written: the same numbers, cells, units and comments. Rows that stood in it twice
/// are written once, and one that may have been cut is not, so that the second reading finds none.
pub fn check(script: &[u8]) -> bool {
    let name = Path::new("fuzzed.csv");
    let Ok(recording) = Recording::from_bytes(name, edited(&GOOD, &WORDS, script)) else {
        return false;
    };
    let written = recording.to_file(name);
    let again = Recording::from_bytes(name, written.clone());
    let is_same = match &again {
        Ok(again) if !recording.faults().is_empty() => {
            again.faults().is_empty()
                && again.time == recording.time
                && again.to_file(name) == written
        }
        again => again.as_ref() == Ok(&recording),
    };
    assert!(
        is_same,
        "{recording:?} is written as {:?}, and read as {again:?}",
        String::from_utf8_lossy(&written)
    );
    true
}
