//! The data that a batch keeps from run to run.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use mesh_damper_batch::Settings;
use mesh_damper_batch::outcome::Outcome;
use mesh_damper_model::Family;
use mesh_damper_tables::read_limit::ReadLimit;

use crate::rows::{batch, record, run};

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        match entry.path().is_dir() {
            true => copy(&entry.path(), &to.join(entry.file_name())),
            false => _ = fs::copy(entry.path(), to.join(entry.file_name())).unwrap(),
        }
    }
}

#[test]
fn nothing_is_made_twice_and_what_has_changed_is_made() {
    let root = tempfile::tempdir().unwrap();
    let (folder, out) = (root.path().join("recordings"), root.path().join("out"));
    record(&folder, 3);
    fs::write(folder.join("broken.csv"), "time_s\n0\n").unwrap();
    let first = run(&batch(&folder, &out));
    assert_eq!(first.computed, 4);
    let tables = ["outcomes.parquet", "outcomes.csv", "effects.parquet"];
    let read = |name: &&str| fs::read(out.join(name)).unwrap();
    let before: Vec<Vec<u8>> = tables.iter().map(read).collect();
    let again = run(&batch(&folder, &out));
    assert_eq!((again.computed, &again.traces), (0, &first.traces));
    assert_eq!(tables.iter().map(read).collect::<Vec<_>>(), before);

    // A file with another name is the same recording.
    fs::rename(folder.join("1.csv"), folder.join("moved.csv")).unwrap();
    let moved = run(&batch(&folder, &out));
    assert_eq!((moved.computed, moved.traced), (0, 3));
    assert!(
        moved
            .traces
            .iter()
            .any(|row| row.trace.ends_with("moved.csv"))
    );
    // A repaired file is a different recording.
    fs::copy(folder.join("0.csv"), folder.join("broken.csv")).unwrap();
    let text = fs::read_to_string(folder.join("0.csv")).unwrap();
    fs::write(folder.join("0.csv"), text.replacen('\n', "\n\n", 1)).unwrap();
    let corrected = run(&batch(&folder, &out));
    assert_eq!(
        (corrected.computed, corrected.traced, corrected.failed),
        (1, 4, 0)
    );
    // A model that was removed is made again, and so is a report that is requested.
    let Outcome::Traced(found) = &corrected.traces[0].outcome else {
        panic!("{:?}", corrected.traces[0]);
    };
    fs::remove_file(out.join(&found.folder).join("model.json")).unwrap();
    assert_eq!(run(&batch(&folder, &out)).computed, 1);
    let mut with_reports = batch(&folder, &out);
    with_reports.settings.reports = true;
    assert_eq!(run(&with_reports).computed, 4);
    assert!(out.join(&found.folder).join("report.html").is_file());
    assert_eq!(run(&batch(&folder, &out)).computed, 0);
}

#[test]
fn other_settings_are_other_traces_and_the_limit_matters_to_what_it_refused() {
    let root = tempfile::tempdir().unwrap();
    let (folder, out) = (root.path().join("recordings"), root.path().join("out"));
    record(&folder, 2);
    let mut batch = batch(&folder, &out);
    let size = fs::metadata(folder.join("0.csv")).unwrap().len();
    let larger = size.max(fs::metadata(folder.join("1.csv")).unwrap().len());
    batch.settings.reading.limit = ReadLimit::new(larger - 1);
    let refused = run(&batch);
    assert!(refused.failed >= 1 && refused.computed == 2, "{refused:?}");
    assert_eq!(run(&batch).computed, 0);
    batch.settings.reading.limit = ReadLimit::default();
    let passed = run(&batch);
    assert_eq!((passed.failed, passed.traced), (0, 2));
    assert!(passed.computed <= refused.failed);
    batch.settings = Settings::default();
    batch.settings.sought.exclude = vec![Family::named("inertia").unwrap()];
    assert_eq!(run(&batch).computed, 2);
    // The others are still known.
    batch.settings = Settings::default();
    assert_eq!(run(&batch).computed, 0);
}

/// A batch can be killed in any state: the journal may end anywhere, files of traces may be missing from the journal, and files may
/// be half written.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_batch_that_was_killed_anywhere_makes_only_what_it_had_not_kept() {
    let root = tempfile::tempdir().unwrap();
    let (folder, whole) = (root.path().join("recordings"), root.path().join("whole"));
    record(&folder, 3);
    let expected = run(&batch(&folder, &whole));
    let journal = fs::read(whole.join("journal.jsonl")).unwrap();
    let ends: Vec<usize> = (0..journal.len())
        .filter(|&at| journal[at] == b'\n')
        .map(|at| at + 1)
        .collect();
    assert_eq!(ends.len(), 1 + 3);
    let cuts = [
        0,
        7,
        ends[0],
        ends[0] + 1,
        ends[1],
        ends[2] - 1,
        ends[2],
        journal.len() - 1,
        journal.len(),
    ];
    for (number, cut) in cuts.into_iter().enumerate() {
        let out = root.path().join(format!("out{number}"));
        copy(&whole, &out);
        fs::remove_file(out.join("outcomes.parquet")).unwrap();
        fs::write(out.join("journal.jsonl"), &journal[..cut]).unwrap();
        fs::write(out.join(".tmpAbC123"), "half").unwrap();
        let kept = ends[1..].iter().filter(|&&end| end <= cut).count();
        let resumed = run(&batch(&folder, &out));
        assert_eq!(resumed.computed, 3 - kept, "{cut}");
        let ids = |rows: &[mesh_damper_batch::Row]| {
            rows.iter().map(|row| row.id.clone()).collect::<Vec<_>>()
        };
        assert_eq!(ids(&resumed.traces), ids(&expected.traces));
        let names: BTreeSet<_> = fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        let all = [
            "effects.parquet",
            "index.html",
            "journal.jsonl",
            "outcomes.csv",
            "outcomes.parquet",
            "traces",
        ];
        assert_eq!(names, all.iter().map(Into::into).collect());
        assert_eq!(run(&batch(&folder, &out)).computed, 0);
    }
}

#[test]
fn two_runs_into_one_folder_refuse_each_other_and_recordings_are_no_place_for_results() {
    let root = tempfile::tempdir().unwrap();
    let (folder, out) = (root.path().join("recordings"), root.path().join("out"));
    record(&folder, 2);
    let first = batch(&folder, &out);
    let refused = std::sync::Mutex::new(Vec::new());
    first
        .run(&|_| {
            let error = batch(&folder, &out).run(&|_| ()).unwrap_err().to_string();
            refused.lock().unwrap().push(error);
        })
        .unwrap();
    let refused = refused.into_inner().unwrap();
    assert_eq!(refused.len(), 2);
    assert!(
        refused
            .iter()
            .all(|error| error.contains("in use by another run")),
        "{refused:?}"
    );
    let error = batch(&folder, &folder)
        .run(&|_| ())
        .unwrap_err()
        .to_string();
    assert!(error.contains("holds recordings of the list"), "{error}");
    assert!(!folder.join("journal.jsonl").exists());
}
