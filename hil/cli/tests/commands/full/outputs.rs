//! The commands destroy nothing when they write. An output that is an input, another output or a link is refused in one line before
//! any work, and so is a folder that another command fills.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use crate::command::{shell, words};
use crate::refusal::{hil, refuses};

const MODEL: &str = r#"{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.0, "k1": 1.2, "k3": 30.0, "c": 0.1, "alpha": 0.3 } ],
  "effects": [],
  "fitted_range": { "displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3] } }"#;

/// The commands that fill a folder, with that folder as `out`. Their inputs do not exist: a refusal that does not mention them comes
/// before any work.
const FILLING: [(&[&str], &str); 8] = [
    (
        &["run", "--model", "none.json", "--out", "out"],
        "cycles.csv",
    ),
    (&["demo", "--out", "out"], "trace.json"),
    (&["trace", "none.csv", "--out", "out"], "model.json"),
    (&["paper", "--out", "out"], "report.html"),
    (&["faults", "--part", "--out", "out"], "following.svg"),
    (&["blind", "--show", "1", "--out", "out"], "held-out.csv.gz"),
    (&["amplitude-free", "--out", "out"], "loops-10Hz.svg"),
    (
        &["characterize", "none.csv", "--static", "--out", "out"],
        "characterize.svg",
    ),
];

/// All contents of `directory`: bytes of files, and targets of links.
fn tree(directory: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_symlink() {
            let leads_to = fs::read_link(&path).unwrap();
            found.insert(path, leads_to.into_os_string().into_encoded_bytes());
        } else if path.is_dir() {
            found.append(&mut tree(&path));
            found.insert(path, Vec::new());
        } else {
            found.insert(path.clone(), fs::read(path).unwrap());
        }
    }
    found
}

/// Asserts that the command refuses with `said`, and that every file below `root` is unchanged.
#[track_caller]
fn destroys_nothing(root: &Path, arguments: &[&str], said: &[&str]) {
    let before = tree(root);
    refuses(root, arguments, said);
    assert!(tree(root) == before, "{arguments:?}");
}

/// A folder with a model, and with a recording that all readers of recordings accept.
fn root_with_recording() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    let mut text = "time_s,displacement_mm,force_kN\n".to_owned();
    for index in 0..400 {
        let time = f64::from(index) * 0.005;
        let wave = (std::f64::consts::TAU * 2.0 * time).sin();
        text += &format!("{time:.4},{:.6},{:.6}\n", 0.1 * wave, 0.2 * wave);
    }
    fs::write(root.path().join("rec.csv"), text).unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    root
}

const PREDICT: [&str; 3] = ["predict", "--model", "model.json"];

#[test]
fn a_recording_and_a_model_stay_whatever_leads_to_them() {
    let root = root_with_recording();
    let path = |name: &str| root.path().join(name);
    fs::create_dir(path("sub")).unwrap();
    for name in ["rec.csv", "model.json"] {
        symlink(name, path(&format!("link-{name}"))).unwrap();
        fs::hard_link(path(name), path(&format!("hard-{name}"))).unwrap();
        symlink("..", path(&format!("sub/up-{name}"))).unwrap();
        let spelled = [
            name.to_owned(),
            format!("./{name}"),
            format!("sub/../{name}"),
            format!("new/../{name}"),
            path(name).display().to_string(),
            format!("link-{name}"),
            format!("hard-{name}"),
            format!("sub/up-{name}/{name}"),
        ];
        for output in &spelled {
            let said = [output, " would replace the input ", name].map(String::from);
            let said: Vec<&str> = said.iter().map(String::as_str).collect();
            for outputs in [
                &["--out", output][..],
                &["--out", "p.csv", "--json", output],
            ] {
                destroys_nothing(
                    root.path(),
                    &[&PREDICT[..], &["rec.csv"], outputs].concat(),
                    &said,
                );
            }
        }
    }
    destroys_nothing(
        root.path(),
        &[&PREDICT[..], &["link-rec.csv", "--out", "rec.csv"]].concat(),
        &["rec.csv: would replace the input link-rec.csv"],
    );
}

/// The inputs here are neither recording nor model, and are not opened.
#[test]
fn no_command_replaces_what_it_reads() {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir(root.path().join("d")).unwrap();
    for name in [
        "in",
        "other",
        "trace.json",
        "d/model.json",
        "d/trace.json",
        "d/cycles.csv",
        "d/characterize.svg",
    ] {
        fs::write(root.path().join(name), "all there is").unwrap();
    }
    for arguments in [
        &["trace", "in", "--json", "in"][..],
        &["trace", "other", "--held-out", "in", "--json", "./in"],
        &["trace", "d/trace.json", "--out", "d"],
        &["run", "--model", "in", "--json", "in"],
        &["run", "--programme", "in", "--json", "in"],
        &["run", "--programme", "d/cycles.csv", "--out", "d"],
        &words("run --on image --model d/cycles.csv --out d"),
        &["predict", "--model", "in", "other", "--out", "in"],
        &["predict", "--model", "other", "in", "--out", "in"],
        &[
            "predict", "--model", "other", "in", "--out", "x", "--json", "in",
        ],
        &["characterize", "in", "--dynamic", "--json", "in"],
        &words("characterize d/characterize.svg --static --out d"),
        &["orthogonal", "in", "--json", "in"],
        &["bench", "--baseline", "in", "--json", "in"],
        &["compare", "d", "other", "--out", "d/model.json"],
        &["compare", "other", "d", "--json", "./d/trace.json"],
        &["compare", "d/model.json", "d", "--out", "d/trace.json"],
        &["compare", "in", "other", "--out", "trace.json"],
    ] {
        destroys_nothing(root.path(), arguments, &["would replace the input "]);
    }
}

#[test]
fn of_two_outputs_neither_is_lost() {
    let root = root_with_recording();
    let predict = [&PREDICT[..], &["rec.csv"]].concat();
    symlink(".", root.path().join("here")).unwrap();
    for (one, other) in [
        ("x", "x"),
        ("x", "./x"),
        ("new/x", "new/../new/x"),
        ("x", "here/x"),
        ("-", "-"),
        ("-", "/dev/stdout"),
        ("/dev/stdout", "-"),
    ] {
        destroys_nothing(
            root.path(),
            &[&predict[..], &["--out", one, "--json", other]].concat(),
            &["would be written twice"],
        );
    }
    for (command, name) in FILLING {
        if command.contains(&"--show") {
            // Writes no JSON.
            continue;
        }
        let output = format!("./out/{name}");
        destroys_nothing(
            root.path(),
            &[command, &["--json", &output]].concat(),
            &[&output, "would be written twice; the other output is out/"],
        );
    }
    let partial = ["run", "--json", "run-out/recording.partial.csv"];
    destroys_nothing(root.path(), &partial, &["would be written twice"]);
}

#[test]
fn a_link_in_the_folder_is_not_followed() {
    for leads_to in ["../precious", "nowhere"] {
        for (command, name) in FILLING {
            let root = tempfile::tempdir().unwrap();
            fs::write(root.path().join("precious"), "all there is").unwrap();
            fs::create_dir(root.path().join("out")).unwrap();
            let link = root.path().join("out").join(name);
            symlink(leads_to, &link).unwrap();
            let said = format!("out/{name}: is a symbolic link");
            destroys_nothing(root.path(), command, &[&said]);
        }
    }
    let root = root_with_recording();
    fs::create_dir(root.path().join("run-out")).unwrap();
    let journal = root.path().join("run-out/recording.partial.csv");
    symlink("../rec.csv", &journal).unwrap();
    destroys_nothing(root.path(), &["run"], &["is a symbolic link"]);
    symlink("rec.csv", root.path().join("link.csv")).unwrap();
    destroys_nothing(
        root.path(),
        &["orthogonal", "--json", "link.csv"],
        &["link.csv: is a symbolic link"],
    );
}

#[test]
fn a_folder_that_another_command_fills_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("out");
    fs::create_dir(&folder).unwrap();
    symlink("out", root.path().join("other-name")).unwrap();
    let held = File::open(&folder).unwrap();
    held.try_lock().unwrap();
    for (command, _) in FILLING {
        destroys_nothing(
            root.path(),
            command,
            &["out: in use by another run; wait for it or name another folder"],
        );
    }
    for more in [
        &["run", "--out", "other-name"][..],
        // A frequency that is given twice is not two outputs.
        &["amplitude-free", "--frequencies", "1,1", "--out", "out"],
    ] {
        destroys_nothing(root.path(), more, &["in use by another run"]);
    }
    drop(held);
    let output = hil(root.path(), &["run", "--blocks", "0.1:5:4", "--out", "out"]);
    assert!(output.status.success());
    let names: Vec<PathBuf> = tree(&folder).into_keys().collect();
    // No lock file remains.
    assert_eq!(
        names,
        ["cycles.csv", "recording.csv.gz"].map(|name| folder.join(name))
    );
}

#[test]
fn what_a_broken_off_run_left_is_kept() {
    for command in ["run", "demo"] {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir(root.path().join("out")).unwrap();
        let left = root.path().join("out/recording.partial.csv");
        fs::write(left, "all there is").unwrap();
        destroys_nothing(
            root.path(),
            &[command, "--out", "out"],
            &[
                "out/recording.partial.csv: left by an interrupted run",
                "move it or remove it, or name another folder",
            ],
        );
    }
}

#[test]
fn a_file_that_standard_output_goes_to_is_an_output_like_any_other() {
    let root = root_with_recording();
    let before = tree(root.path());
    for (script, said) in [
        (
            "\"$HIL\" predict --model model.json rec.csv --out - >> rec.csv",
            "standard output: would replace the input rec.csv",
        ),
        (
            "\"$HIL\" predict --model model.json rec.csv --out /dev/stdout --json model.json",
            "model.json: would replace the input model.json",
        ),
        (
            "\"$HIL\" predict --model model.json rec.csv --out - --json x > x; rm x; exit 2",
            "x: would be written twice",
        ),
    ] {
        let output = shell("sh", root.path(), script);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
        assert!(error.contains(said), "{error}");
        assert!(tree(root.path()) == before, "{script}");
    }
}

#[test]
fn devices_and_pipes_are_written_as_they_are() {
    let root = root_with_recording();
    let predict = "\"$HIL\" predict --model model.json rec.csv";
    for script in [
        format!("{predict} --out /dev/null --json /dev/null"),
        format!("{predict} --out /dev/stdout | grep -q predicted_force_kN"),
        format!("{predict} --out /dev/null --json /dev/fd/3 3>&1 | grep -q nrmse"),
        format!("{predict} --out /dev/null --json /dev/fd/3 3>x && grep -q nrmse x && rm x"),
        format!("{predict} --out /dev/stdout > x && grep -q predicted_force_kN x && rm x"),
    ] {
        let output = shell("sh", root.path(), &script);
        assert!(
            output.status.success(),
            "{script}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    assert_eq!(tree(root.path()).len(), 2);
}
