//! The contents of lists, tables and folders.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::types::Int32Type;
use arrow_array::{ArrayRef, BooleanArray, DictionaryArray, Int64Array, RecordBatch, StringArray};
use mesh_damper_batch::{List, Task};
use mesh_damper_tables::read_limit::ReadLimit;
use parquet::arrow::ArrowWriter;

fn read(path: &Path) -> Result<List, String> {
    List::read(path, ReadLimit::default()).map_err(|error| error.to_string())
}

/// A folder with files of these names; each contains its name.
fn folder(names: &[&str]) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    for name in names {
        fs::create_dir_all(root.path().join(name).parent().unwrap()).unwrap();
        fs::write(root.path().join(name), name).unwrap();
    }
    root
}

fn names(list: &List, root: &Path) -> Vec<(Vec<PathBuf>, Vec<PathBuf>)> {
    let short = |paths: &[PathBuf]| {
        let short = paths
            .iter()
            .map(|path| path.strip_prefix(root).unwrap_or(path).to_owned());
        short.collect::<Vec<_>>()
    };
    let each = |task: &Task| (short(&task.recordings), short(&task.held_out));
    list.tasks.iter().map(each).collect()
}

#[test]
fn a_folder_gives_its_recordings_by_name() {
    let root = folder(&[
        "b.CSV",
        "a.csv.gz",
        "notes.pdf",
        "model.json",
        ".hidden.csv",
        "deeper/c.csv",
    ]);
    let list = read(root.path()).unwrap();
    let alone = |name: &str| (vec![name.into()], vec![]);
    assert_eq!(
        names(&list, root.path()),
        [alone("a.csv.gz"), alone("b.CSV")]
    );
    // Files that a trace wrote there are not recordings.
    let ignored = ["model.json", "notes.pdf"].map(|name| root.path().join(name));
    assert_eq!(list.ignored, ignored);
    let empty = folder(&["notes.pdf", "deeper/c.csv"]);
    let error = read(empty.path()).unwrap_err();
    assert!(
        error.contains("holds no file with an ending of recordings")
            && error.contains("1 folders in it are not searched"),
        "{error}"
    );
}

#[test]
fn a_list_gives_a_trace_a_line_relative_to_itself() {
    let root = folder(&["tests/a.csv", "tests/b c.csv"]);
    let path = root.path().join("tests/list.txt");
    fs::write(&path, "\u{feff}# of May\r\n\r\na.csv\r\nb c.csv\ngone.csv").unwrap();
    let list = read(&path).unwrap();
    let alone = |name: &str| (vec![name.into()], vec![]);
    assert_eq!(
        names(&list, root.path()),
        [
            alone("tests/a.csv"),
            alone("tests/b c.csv"),
            alone("tests/gone.csv")
        ]
    );
    assert_eq!(list.tasks[1].name, "b c.csv");
    assert_eq!(list.file, Some(path.clone()));
    for (text, said) in [
        ("# nothing\n", "names no recording"),
        (
            "time_s,displacement_mm,force_kN\n0,0,0\n",
            "one recording is for `hil trace`",
        ),
    ] {
        fs::write(&path, text).unwrap();
        let error = read(&path).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    fs::write(&path, b"\xff\xfe\x00").unwrap();
    assert!(read(&path).unwrap_err().contains("so it cannot be a list"));
}

#[test]
fn a_table_gives_a_trace_a_group() {
    let root = folder(&["a.csv", "b.csv", "c.csv", "d.csv"]);
    let path = root.path().join("table.csv");
    let expected = [
        (vec!["a.csv".into(), "c.csv".into()], vec!["b.csv".into()]),
        (vec!["d.csv".into()], vec![]),
    ];
    for text in [
        "path,group,specimen,role\na.csv,1,S7,fit\nb.csv,1,,held_out\nd.csv,,S8,\nc.csv,1,S7,\n",
        "Group;held_out;note;PATH;specimen\n1;no;x;a.csv;S7\n1;1;;b.csv;S7\n;;;d.csv;S8\n1;false;;c.csv;\n",
        "path\tgroup\theld_out\tspecimen\na.csv\t1\t0\tS7\nb.csv\t1\tTRUE\t\nd.csv\t\t\tS8\nc.csv\t1\t\t\n",
    ] {
        fs::write(&path, text).unwrap();
        let list = read(&path).unwrap();
        assert_eq!(names(&list, root.path()), expected, "{text}");
        assert_eq!(list.tasks[0].name, "1");
        assert_eq!(list.tasks[0].specimen.as_deref(), Some("S7"));
        assert_eq!(
            (list.tasks[1].name.as_str(), &list.tasks[1].group),
            ("d.csv", &None)
        );
        assert_eq!(list.tasks[1].specimen.as_deref(), Some("S8"));
    }
    for (text, said) in [
        (
            "path,role\na.csv,judge\n",
            "line 2: \"judge\" is not a role",
        ),
        ("path,group\n,1\n", "line 2: has no path"),
        ("path,path\na.csv,b.csv\n", "column path: appears twice"),
        (
            "path,role,held_out\na.csv,fit,no\n",
            "column role: repeats the column held_out",
        ),
        (
            "path,group,specimen\na.csv,1,S7\nb.csv,1,S8\n",
            "line 3: group \"1\" is of specimen \"S7\" too",
        ),
        (
            "path,held_out\na.csv,yes\n",
            "\"a.csv\" has held-out recordings but none to fit",
        ),
        ("path,group\na.csv\n", "line 2"),
        ("path,group\n", "has no row"),
    ] {
        fs::write(&path, text).unwrap();
        let error = read(&path).unwrap_err();
        assert!(
            error.contains(said) && error.lines().count() == 1,
            "{error}"
        );
    }
}

fn write_parquet(path: &Path, columns: Vec<(&str, ArrayRef)>) {
    let batch = RecordBatch::try_from_iter_with_nullable(
        columns
            .into_iter()
            .map(|(name, column)| (name, column, true)),
    )
    .unwrap();
    let mut writer =
        ArrowWriter::try_new(fs::File::create(path).unwrap(), batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
}

#[test]
fn a_table_as_parquet_gives_the_same() {
    let root = folder(&["a.csv", "b.csv", "c.csv"]);
    let path = root.path().join("table.parquet");
    let paths = ["a.csv", "b.csv", "c.csv"];
    // A category of pandas is a dictionary.
    let specimen: DictionaryArray<Int32Type> = [Some("S7"), Some("S7"), None].into_iter().collect();
    write_parquet(
        &path,
        vec![
            ("path", Arc::new(StringArray::from(paths.to_vec()))),
            (
                "group",
                Arc::new(Int64Array::from(vec![Some(4), Some(4), None])),
            ),
            (
                "held_out",
                Arc::new(BooleanArray::from(vec![Some(false), Some(true), None])),
            ),
            ("specimen", Arc::new(specimen)),
        ],
    );
    let list = read(&path).unwrap();
    let expected = [
        (vec!["a.csv".into()], vec!["b.csv".into()]),
        (vec!["c.csv".into()], vec![]),
    ];
    assert_eq!(names(&list, root.path()), expected);
    assert_eq!(
        (
            list.tasks[0].name.as_str(),
            list.tasks[0].specimen.as_deref()
        ),
        ("4", Some("S7"))
    );
    write_parquet(
        &path,
        vec![("file", Arc::new(StringArray::from(paths.to_vec())))],
    );
    assert!(
        read(&path)
            .unwrap_err()
            .contains("has no column path; it has file")
    );
    fs::write(&path, b"PAR1 and no more").unwrap();
    assert!(
        read(&path)
            .unwrap_err()
            .contains("cannot be read as Parquet")
    );
}
