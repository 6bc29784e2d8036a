//! The reader of recordings.

use std::io::Write as _;
use std::path::Path;
use std::sync::LazyLock;

use mesh_damper_recording::Recording;

use crate::edit::edited;

const WORDS: [&str; 58] = [
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
    ";",
    "|",
    "0,5",
    "1.234,5",
    "1,234",
    "1 234,5",
    "sep=;\n",
    "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n",
    "LabVIEW Measurement\n",
    "***End_of_Header***\n",
    "X_Value",
    "Delta_X\t0.001\n",
    "Time [s]",
    "Weg [mm]",
    "Kraft [kN]",
    "Load (N)",
    "s;mm;kN\n",
    "2024-03-01 12:00:00.125",
    "00:01:02.345",
    "Sample rate: 100 Hz\n",
    "% ",
    "// ",
    "Strom [A]",
    "Temp [°C]",
    "\u{2212}",
    "\n\nend of test\n",
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
    let utf16: Vec<u8> = foreign("Zeit [s];Weg [mm];Kraft [kN]\r\n", ";", ',')
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let texts = [
        foreign("Operator;me\n\nZeit;Weg;Kraft\ns;mm;N\n", ";", ','),
        foreign("# Time [s] Disp [mm] Load [kN]\n", " ", '.'),
        foreign("Time (s),Disp (mm),Load (lbf)\n", ",", '.'),
        format!(
            "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\nData Acquisition\t\tTime:\t4\ts\n{}",
            foreign(
                "Running Time\tAxial Displacement\tAxial Force\ns\tmm\tN\n",
                "\t",
                '.'
            )
        ),
        format!(
            "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tOne\n***End_of_Header***\t\n\n\
             Channels\t2\nY_Unit_Label\tmm\tN\nX_Dimension\tTime\tTime\nX0\t0\t0\nDelta_X\t0.01\t0.01\n***End_of_Header***\n{}",
            foreign("X_Value\tDisp\tLoad\tComment\n", "\t", '.')
        ),
        stamped(),
    ];
    let texts = texts.into_iter().map(String::into_bytes);
    let own = [plain.into(), other.into(), quoted.into(), zipped];
    own.into_iter().chain([utf16]).chain(texts).collect()
});

/// A recording in the format of another program, below its header.
fn foreign(header: &str, separator: &str, decimal: char) -> String {
    let row = |n: u32| {
        let y = (0.7 * f64::from(n)).sin();
        let cells =
            [0.01 * f64::from(n), 0.1 * y, 0.2 * y + 0.01].map(|value| format!("{value:.4}"));
        cells.join(separator).replace('.', &decimal.to_string()) + "\n"
    };
    header.to_owned() + &(0..12).map(row).collect::<String>()
}

/// A recording whose times are dates.
fn stamped() -> String {
    let row = |n: u32| {
        format!(
            "2024-03-01 23:59:59.{:02};0,{};-0,{}5\n",
            8 * n,
            n % 7,
            n % 5
        )
    };
    "Time;Disp [mm];Load [kN]\n".to_owned() + &(0..12).map(row).collect::<String>()
}

/// A recording that was read and written is a recording with the same numbers, cells, units and comments. Duplicate rows are written
/// once, and a row that may have been cut is not written, so that the second reading finds none. A recording in another dialect is
/// written in our own format, with the same numbers to nine digits.
pub fn check(script: &[u8]) -> bool {
    let name = Path::new("fuzzed.csv");
    let Ok(recording) = Recording::from_bytes(name, edited(&GOOD, &WORDS, script)) else {
        return false;
    };
    let file = |recording: &Recording| recording.to_file(name).expect("text holds any recording");
    let written = file(&recording);
    let again = Recording::from_bytes(name, written.clone());
    let is_same = match &again {
        Ok(again) if !recording.guesses().is_empty() => are_alike(&recording, again),
        Ok(again) if !recording.faults().is_empty() => {
            again.faults().is_empty() && again.time == recording.time && file(again) == written
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

/// Whether two recordings have the same numbers to nine digits.
fn are_alike(one: &Recording, other: &Recording) -> bool {
    let channels = |recording: &Recording| {
        let named = [&recording.time, &recording.displacement, &recording.force]
            .into_iter()
            .cloned();
        let more = [&recording.velocity, &recording.temperature]
            .into_iter()
            .flatten()
            .cloned();
        let controls = recording
            .controls
            .iter()
            .map(|control| control.values.clone());
        named.chain(more).chain(controls).collect::<Vec<_>>()
    };
    let (one, other) = (channels(one), channels(other));
    let is_same =
        |(a, b): (&f64, &f64)| (a - b).abs() <= 1.001e-8 * a.abs().max(b.abs()) + f64::MIN_POSITIVE;
    one.len() == other.len()
        && one
            .iter()
            .zip(&other)
            .all(|(one, other)| one.len() == other.len() && one.iter().zip(other).all(is_same))
}
