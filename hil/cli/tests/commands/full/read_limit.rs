//! Files that are too large for the machine's memory, that would take a quadratic search too long, or that are incomplete.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Instant;

use mesh_damper_paper::orthogonal::Experiment;
use mesh_damper_recording::Recording;
use mesh_damper_recording::faults::{ChannelFault, ChannelFaultKind};
use mesh_damper_tables::channel::Channel;

use crate::bad_input::MODEL;

const HEADER: &str = "time_s,displacement_mm,force_kN\n";
/// Address space in MiB of the command itself, 75, and of what reading within a limit of 16 MiB may hold, 98, once more for the list
/// that grows.
const ALONE: u64 = 232;

/// The command with these arguments in `directory` and this number of MiB of address space.
fn hil_within(mebibytes: u64, directory: &Path, arguments: &[&str]) -> Output {
    let script = format!("ulimit -v {}; exec \"$HIL\" \"$@\"", 1024 * mebibytes);
    Command::new("sh")
        .args(["-c", &script, "sh"])
        .args(arguments)
        .env("HIL", env!("CARGO_BIN_EXE_hil"))
        .current_dir(directory)
        .output()
        .unwrap()
}

#[track_caller]
fn refuses(output: &Output, said: &[&str]) {
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert_eq!(error.lines().count(), 1, "{error}");
    for part in said {
        assert!(error.contains(part), "{part:?} not in {error}");
    }
}

/// Compresses `head` and then repetitions of `part`, up to this number of bytes.
fn bomb(path: &Path, head: &str, part: &str, bytes: usize) {
    let file = fs::File::create(path).unwrap();
    let mut zip = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    zip.write_all(head.as_bytes()).unwrap();
    let block = part.repeat((1 << 20) / part.len());
    for _ in 0..bytes / block.len() {
        zip.write_all(block.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
}

fn rows(count: u32) -> String {
    let row = |i: u32| {
        let time = f64::from(i) * 0.005;
        let wave = (std::f64::consts::TAU * 2.0 * time).sin();
        format!("{time:.4},{:.6},{:.6}\n", 0.1 * wave, 0.2 * wave)
    };
    (0..count).map(row).collect()
}

fn commands<'a>(recording: &'a str, more: &[&'a str]) -> Vec<Vec<&'a str>> {
    let commands: [&[&str]; 5] = [
        &["trace", recording],
        &["trace", "good.csv", "--held-out", recording],
        &["predict", recording, "--model", "m.json", "--out", "p.csv"],
        &["characterize", recording, "--dynamic"],
        &["orthogonal", recording],
    ];
    commands.iter().map(|c| [c, more].concat()).collect()
}

fn folder() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(
        root.path().join("good.csv"),
        format!("{HEADER}{}", rows(400)),
    )
    .unwrap();
    fs::write(root.path().join("m.json"), MODEL).unwrap();
    root
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn a_line_without_an_end_takes_no_more_memory_than_a_file_may_have() {
    let root = folder();
    bomb(&root.path().join("line.csv.gz"), "# a\n", "1", 300 << 20);
    let begun = format!("{HEADER}{}\"", rows(40));
    bomb(&root.path().join("quoted.csv.gz"), &begun, "a\n", 600 << 20);
    // Each line of the last is short, but together they are one cell.
    for file in ["line.csv.gz", "/dev/zero", "quoted.csv.gz"] {
        let said = [
            &format!("{file}: holds more than 16MiB, the limit of a file;"),
            "raise the limit with --max-read 32MiB",
        ];
        for arguments in commands(file, &["--max-read", "16MiB"]) {
            refuses(&hil_within(ALONE, root.path(), &arguments), &said);
        }
    }
}

#[test]
fn an_endless_json_file_is_refused() {
    let root = folder();
    let said = ["/dev/zero: holds more than 8MiB, the limit of a JSON file, 1/64 of --max-read; "];
    for arguments in [
        &[
            "predict",
            "good.csv",
            "--model",
            "/dev/zero",
            "--out",
            "p.csv",
        ][..],
        &["run", "--model", "/dev/zero"],
        &["run", "--programme", "/dev/zero"],
        &["bench", "--baseline", "/dev/zero"],
    ] {
        refuses(&hil_within(ALONE, root.path(), arguments), &said);
    }
}

#[test]
fn an_endless_pack_is_refused() {
    let root = folder();
    let arguments = ["upload", "/dev/zero", "--to", "serial:/dev/none"];
    let said = ["/dev/zero: these bytes are not a coefficient pack"];
    refuses(&hil_within(ALONE, root.path(), &arguments), &said);
}

#[test]
fn many_short_lines_are_refused_at_the_limit() {
    let root = folder();
    let rows = "1,1,1\n2,2,2\n";
    bomb(&root.path().join("rows.csv.gz"), HEADER, rows, 300 << 20);
    bomb(&root.path().join("comments.csv.gz"), "", "#\n", 15 << 20);
    for (file, said) in [
        ("rows.csv.gz", "holds more than 16MiB, the limit of a file"),
        (
            "comments.csv.gz",
            "its comments would take the memory to 3 MiB",
        ),
    ] {
        let arguments = ["characterize", file, "--static", "--max-read", "16MiB"];
        refuses(&hil_within(ALONE, root.path(), &arguments), &[said]);
    }
}

#[test]
fn the_limit_can_be_set() {
    let root = folder();
    fs::write(
        root.path().join("rec.csv"),
        format!("{HEADER}{}", rows(2000)),
    )
    .unwrap();
    let predict = |limit| {
        let arguments = [
            "predict",
            "rec.csv",
            "--model",
            "m.json",
            "--out",
            "p.csv",
            "--max-read",
            limit,
        ];
        hil_within(4096, root.path(), &arguments)
    };
    refuses(
        &predict("40kB"),
        &[
            "rec.csv: holds more than 40kB, the limit of a file;",
            "--max-read 80kB",
        ],
    );
    refuses(
        &predict("6400"),
        &["m.json: holds more than 100B, the limit of a JSON file"],
    );
    assert_eq!(predict("80kB").status.code(), Some(0));
    assert_eq!(predict("1 TB").status.code(), Some(2));
}

/// The shortest time of `times` repetitions of `work`.
fn least(times: usize, work: impl Fn()) -> f64 {
    let once = || {
        let start = Instant::now();
        (0..times).for_each(|_| work());
        start.elapsed()
    };
    let least = (0..5).map(|_| once()).min();
    least.unwrap().as_secs_f64()
}

#[test]
fn time_grows_as_the_number_of_columns() {
    let root = tempfile::tempdir().unwrap();
    let names = |columns: usize, kind: &str| -> String {
        (0..columns)
            .map(|n| format!(",{}", kind.replace('#', &n.to_string())))
            .collect()
    };
    let recording = |columns, kind| {
        let text = HEADER.trim().to_owned() + &names(columns, kind) + "\n";
        move || {
            let read = Recording::from_bytes("a.csv".as_ref(), text.clone().into());
            assert!(read.unwrap_err().to_string().contains("holds no samples"));
        }
    };
    let test = |columns| {
        let path = root.path().join(format!("{columns}.csv"));
        let runs = [
            "0,0", "0,1", "0,2", "1,0", "1,1", "1,2", "2,0", "2,1", "2,2",
        ];
        let results = ",1".repeat(columns);
        let rows: String = runs.iter().map(|run| format!("{run}{results}\n")).collect();
        let header = format!("factor_a,factor_b{}\n", names(columns, "result_r#"));
        fs::write(&path, header + &rows).unwrap();
        move || assert!(Experiment::read(&path).is_ok())
    };
    // The same number of columns in one file and in 64 files: a search through all names for each column would take 64 times as long
    // in one file.
    // One of lengths is read as a control input.
    for kind in ["c#", "x#_mm"] {
        let whole = least(1, recording(1 << 16, kind));
        let of_recordings = whole / least(64, recording(1 << 10, kind));
        assert!(of_recordings < 16.0, "{kind}: {of_recordings}");
    }
    let of_tests = least(1, test(1 << 15)) / least(64, test(1 << 9));
    assert!(of_tests < 16.0, "{of_tests}");
}

/// Wherever a file ends within its last line, the recording consists of the whole rows and contains no other number.
#[test]
fn a_last_row_without_a_line_end_is_left_out_and_said() {
    let text = format!("{HEADER}{}", rows(12));
    let read = |text: &str| Recording::from_bytes("a.csv".as_ref(), text.into()).unwrap();
    let whole = read(&text);
    assert!(whole.faults().is_empty());
    let last = text.trim_end().rfind('\n').unwrap() + 1;
    for end in last + 1..text.len() {
        let part = read(&text[..end]);
        assert_eq!(part.force, whole.force[..11]);
        let fault = ChannelFault {
            channel: Channel::Time,
            kind: ChannelFaultKind::Cut,
        };
        assert_eq!(part.faults(), [fault]);
    }
    // A file that was not cut within a row is complete.
    for whole_rows in [
        &text[..last],
        &text.replace('\n', "\r\n"),
        &text.replace('\n', "\r"),
        &(text.clone() + "# end"),
    ] {
        assert!(read(whole_rows).faults().is_empty());
    }
}

#[test]
fn a_cut_row_is_said_by_every_command() {
    let root = folder();
    let text = fs::read_to_string(root.path().join("good.csv")).unwrap();
    fs::write(root.path().join("cut.csv"), &text[..text.len() - 3]).unwrap();
    let said = "the last row has no line end, so its last number may be cut; the row was left out";
    let hil = |arguments: &[&str]| {
        let output = hil_within(4096, root.path(), arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{error}");
        (String::from_utf8(output.stdout).unwrap(), error)
    };
    let (_, error) = hil(&["predict", "cut.csv", "--model", "m.json", "--out", "p.csv"]);
    assert!(error.contains(said), "{error}");
    let predicted = fs::read_to_string(root.path().join("p.csv")).unwrap();
    assert_eq!(predicted.lines().count(), text.lines().count() - 1);
    let (json, _) = hil(&["trace", "cut.csv", "--json", "-"]);
    let trace: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(
        trace["warnings"].to_string().contains(said),
        "{}",
        trace["warnings"]
    );
    for kind in ["--static", "--dynamic"] {
        let (_, error) = hil(&["characterize", "cut.csv", kind]);
        assert!(error.contains(said), "{error}");
    }

    let table = "factor_a,factor_b,result_k\n0,0,1.5\n0,1,2.5\n0,2,3.5\n1,0,4.5\n1,1,5.5\n1,2,6.5\n2,0,7.5\n2,1,8.5\n2,2,9.55\n";
    fs::write(root.path().join("test.csv"), table).unwrap();
    hil(&["orthogonal", "test.csv"]);
    fs::write(root.path().join("test.csv"), &table[..table.len() - 2]).unwrap();
    let output = hil_within(4096, root.path(), &["orthogonal", "test.csv"]);
    refuses(
        &output,
        &[
            "test.csv: line 10: the last row has no line end",
            "end its line",
        ],
    );
}
