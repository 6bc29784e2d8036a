//! Bad recordings through the real command: one line that identifies the place, exit code 2, and no output files.

use std::fs;
use std::io::Write as _;

use crate::command::words;
use crate::refusal::{hil, refuses};

/// A law with an offset.
pub const MODEL: &str = r#"{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.0, "k1": 1.2, "k3": 30.0, "c": 0.1, "alpha": 0.3 } ],
  "effects": [ { "family": "offset", "parameters": { "force": 0.01 } } ],
  "fitted_range": { "displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3] } }"#;

/// A recording of a few cycles. `change` may damage the lines, header first.
pub fn recording(change: impl FnOnce(&mut Vec<String>)) -> Vec<u8> {
    let mut lines = vec!["time_s,displacement_mm,force_kN".to_owned()];
    lines.extend((0..400).map(|i| {
        let time = f64::from(i) * 0.005;
        let wave = (std::f64::consts::TAU * 2.0 * time).sin();
        format!("{time:.4},{:.6},{:.6}", 0.1 * wave, 0.2 * wave)
    }));
    change(&mut lines);
    (lines.join("\n") + "\n").into_bytes()
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Every bad recording, with the parts that its message must contain.
pub fn bad_recordings() -> Vec<(&'static str, Vec<u8>, &'static [&'static str])> {
    let whole = recording(|_| ());
    let truncated = {
        let mut bytes = gzipped(&whole);
        bytes.truncate(bytes.len() / 2);
        bytes
    };
    // A UTF-8 character in the header, and a character of another encoding in the last row.
    let mixed = recording(|lines| lines[0].push_str(",note \u{b5}"))
        .iter()
        .chain(b"1,2,3,\xb0C\n")
        .copied()
        .collect();
    let cell = |line: usize, text: &str| {
        let row = format!("9.0,{text},0.1");
        recording(move |lines| lines[line - 1] = row)
    };
    vec![
        ("empty.csv", Vec::new(), &["is empty", "write a header"]),
        ("empty.csv.gz", gzipped(b""), &["is empty"]),
        (
            "comments.csv",
            b"# one\n# two\n".to_vec(),
            &["comments only"],
        ),
        (
            "no-header.csv",
            recording(|lines| drop(lines.remove(0))),
            &["line 1", "no header"],
        ),
        (
            "header-only.csv",
            recording(|lines| lines.truncate(1)),
            &["no samples"],
        ),
        (
            "one-sample.csv",
            recording(|lines| lines.truncate(2)),
            &["only 1 sample;", "at least"],
        ),
        (
            "few-samples.csv",
            recording(|lines| lines.truncate(4)),
            &["only 3 samples;"],
        ),
        (
            "no-force.csv",
            recording(|lines| lines[0] = "time_s,displacement_mm,stress_kPa".into()),
            &[
                "line 1",
                "no force column",
                "\"stress_kPa\"",
                "force_kN, force_N",
            ],
        ),
        (
            "no-time.csv",
            recording(|lines| lines[0] = "t,displacement_mm,force_kN".into()),
            &[
                "no time column",
                "\"t\"",
                "time_s, time_ms",
                "--channel time=t",
                "--rate",
            ],
        ),
        (
            "no-unit.csv",
            recording(|lines| lines[0] = "time_s,displacement,force_kN".into()),
            &["column displacement:", "no unit", "displacement_mm"],
        ),
        (
            "unknown-unit.csv",
            recording(|lines| lines[0] = "time_s,displacement_furlong,force_kN".into()),
            &[
                "column displacement_furlong",
                "unknown unit \"furlong\"",
                "displacement_in",
            ],
        ),
        (
            "double.csv",
            recording(|lines| lines[0] = "time_s,force_kN,force_kN".into()),
            &["column force_kN", "columns 2 and 3"],
        ),
        (
            "two-forces.csv",
            recording(|lines| lines[0] = "time_s,force_N,force_kN".into()),
            &["column force_kN", "force_N is also a force"],
        ),
        (
            "nan.csv",
            recording(|lines| {
                for line in &mut lines[7..] {
                    *line = "1.0,0.1,NaN".into();
                }
            }),
            &["line 8, column force_kN", "\"NaN\""],
        ),
        (
            "blank.csv",
            recording(|lines| lines[7] = ",0.1,0.1".into()),
            &["line 8, column time_s", "cell is empty"],
        ),
        (
            "word.csv",
            cell(9, "abc"),
            &["line 9, column displacement_mm", "\"abc\" is not a number"],
        ),
        (
            "infinite.csv",
            cell(10, "-inf"),
            &["line 10", "\"-inf\" is not finite"],
        ),
        (
            "overflow.csv",
            cell(10, "1e999"),
            &["line 10", "not finite"],
        ),
        (
            "huge.csv",
            recording(|lines| {
                lines[0] = "time_s,displacement_m,force_kN".into();
                lines[4] = "0.015,1e308,0.1".into();
            }),
            &["line 5, column displacement", "not finite"],
        ),
        (
            "ragged.csv",
            recording(|lines| lines[20] = "0.1,0.2".into()),
            &["line 21", "2 cells where the header has 3"],
        ),
        (
            "after-comments.csv",
            recording(|lines| {
                lines[20] = "0.1,0.2,0.3,0.4".into();
                lines.insert(5, String::new());
                lines.insert(0, "# a comment".into());
            }),
            &["line 23", "4 cells"],
        ),
        (
            "backwards.csv",
            recording(|lines| lines.swap(30, 31)),
            &["line 32", "runs backwards"],
        ),
        (
            "standing.csv",
            recording(|lines| {
                let time = lines[30].split(',').next().unwrap().to_owned();
                lines[31] = format!("{time},0.1,0.2");
            }),
            &["line 32", "stands still"],
        ),
        (
            "jump.csv",
            recording(|lines| lines.push("1e9,0.1,0.2".into())),
            &["line 402", "time jumps"],
        ),
        (
            "constant.csv",
            recording(|lines| {
                for line in &mut lines[1..] {
                    let time = line.split(',').next().unwrap().to_owned();
                    *line = format!("{time},0.1,0.2");
                }
            }),
            &["column displacement", "never changes"],
        ),
        ("truncated.csv.gz", truncated, &["not valid gzip"]),
        ("plain.csv.gz", whole, &["not valid gzip"]),
        ("mixed.csv", mixed, &["line 402", "not UTF-8"]),
        (
            "thousands-or-decimals.csv",
            b"time_s;displacement_mm;force_kN\n1,001;1;2\n1,002;2;3\n".to_vec(),
            &["line 2", "\"1,001\"", "--decimal point or --decimal comma"],
        ),
        (
            "comma-as-both.csv",
            b"Time [s],Disp [mm],Load [kN]\n0,001,0,5,0,7\n0,002,0,6,0,8\n".to_vec(),
            &["line 2", "export it again with a semicolon"],
        ),
        (
            "no-unit-of-time.csv",
            b"Zeit;Weg [mm];Kraft [kN]\n0,1;1;2\n0,2;2;3\n".to_vec(),
            &["column Zeit", "no unit", "--unit time=s or --unit time=ms"],
        ),
        (
            "two-loads.csv",
            b"Time [s]\tDisp [mm]\tLoad 1 [N]\tLoad 2 [N]\n0.1\t1\t2\t3\n0.2\t2\t3\t4\n".to_vec(),
            &[
                "2 columns could be the force",
                "--channel force='Load 1 [N]' or --channel force='Load 2 [N]'",
            ],
        ),
        (
            "letter.txt",
            b"Dear reader,\nthere are no numbers here.\n".to_vec(),
            &["holds no rows", "commas, semicolons, tabs, bars or blanks"],
        ),
    ]
}

#[test]
fn every_bad_recording_is_refused_by_predict() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    // `predict` needs only the motion.
    let bad = bad_recordings()
        .into_iter()
        .filter(|(name, ..)| *name != "no-force.csv");
    for (name, bytes, said) in bad {
        fs::write(root.path().join(name), bytes).unwrap();
        let line = format!("predict --model model.json {name} --out new/pred.csv");
        let arguments = words(&line);
        refuses(
            root.path(),
            &[&arguments[..], &["--json", "new.json"]].concat(),
            said,
        );
        let error = hil(root.path(), &arguments).stderr;
        assert!(String::from_utf8(error).unwrap().contains(name));
    }
    let predict = |recording: &'static str, said| {
        let line = format!("predict --model model.json {recording} --out p.csv");
        let arguments = words(&line);
        refuses(root.path(), &arguments, said);
    };
    predict("nowhere.csv", &["nowhere.csv", "does not exist"]);
    predict(".", &["is a directory"]);
}

#[test]
fn every_bad_recording_is_refused_by_trace() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("good.csv"), recording(|_| ())).unwrap();
    for (name, bytes, said) in bad_recordings() {
        fs::write(root.path().join(name), bytes).unwrap();
        refuses(root.path(), &["trace", name, "--json", "new.json"], said);
        refuses(
            root.path(),
            &["trace", "good.csv", "--held-out", name],
            said,
        );
    }
}
