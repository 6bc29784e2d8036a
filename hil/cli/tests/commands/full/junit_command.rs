//! `--junit`: the checks of a command in the format of build servers, including those that fail.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::refusal::hil;

/// A test case in the file.
#[derive(Debug)]
pub struct Case {
    pub class: String,
    name: String,
    /// `failure` or `skipped`, with its message.
    mark: Option<(String, String)>,
}

/// A suite in the file.
pub struct Suite {
    name: String,
    properties: BTreeMap<String, String>,
    pub cases: Vec<Case>,
}

impl Suite {
    fn count(&self, mark: Option<&str>) -> usize {
        let of = |case: &&Case| case.mark.as_ref().map(|(mark, _)| mark.as_str()) == mark;
        self.cases.iter().filter(of).count()
    }

    /// The reason for which the case `name` failed.
    #[track_caller]
    pub fn failure(&self, name: &str) -> &str {
        let case = self.cases.iter().find(|case| case.name == name);
        match &case.unwrap_or_else(|| panic!("no case {name}")).mark {
            Some((mark, message)) if mark == "failure" => message,
            other => panic!("{name}: {other:?}"),
        }
    }
}

fn attributes(element: &BytesStart) -> BTreeMap<String, String> {
    let each = element.attributes().map(|attribute| {
        let attribute = attribute.unwrap();
        let name = String::from_utf8(attribute.key.as_ref().to_vec()).unwrap();
        (
            name,
            attribute
                .normalized_value(quick_xml::XmlVersion::Implicit1_0)
                .unwrap()
                .into_owned(),
        )
    });
    each.collect()
}

/// Reads a file by the rules of the usual schema: `testsuites` with one `testsuite` of `properties` and `testcase`s, whose counts and
/// times equal the attributes.
pub fn suite(path: &Path) -> Suite {
    let text = fs::read_to_string(path).unwrap();
    let mut reader = Reader::from_str(&text);
    let mut inside: Vec<String> = Vec::new();
    let mut suite = Suite {
        name: String::new(),
        properties: BTreeMap::new(),
        cases: Vec::new(),
    };
    let mut said = BTreeMap::new();
    loop {
        let event = reader.read_event().unwrap();
        let (element, is_empty) = match &event {
            Event::Start(element) => (element, false),
            Event::Empty(element) => (element, true),
            Event::End(_) => {
                inside.pop();
                continue;
            }
            Event::Eof => break,
            _ => continue,
        };
        let name = String::from_utf8(element.name().as_ref().to_vec()).unwrap();
        let mut values = attributes(element);
        match (inside.join(" ").as_str(), name.as_str()) {
            ("", "testsuites") => assert_eq!(values["name"], "hil"),
            ("testsuites", "testsuite") => {
                suite.name = values["name"].clone();
                assert!(values["time"].parse::<f64>().unwrap() >= 0.0);
                said = values;
            }
            ("testsuites testsuite", "properties") => {
                assert!(suite.cases.is_empty(), "properties come before the cases");
            }
            ("testsuites testsuite properties", "property") => {
                let value = values.remove("value").unwrap();
                suite
                    .properties
                    .insert(values.remove("name").unwrap(), value);
            }
            ("testsuites testsuite", "testcase") => suite.cases.push(Case {
                class: values.remove("classname").unwrap(),
                name: values.remove("name").unwrap(),
                mark: None,
            }),
            ("testsuites testsuite testcase", "failure" | "skipped") => {
                let message = values.remove("message").unwrap();
                assert!(!message.is_empty());
                let case = suite.cases.last_mut().unwrap();
                assert!(case.mark.replace((name.clone(), message)).is_none());
            }
            (place, other) => panic!("{other} in {place}"),
        }
        if !is_empty {
            inside.push(name);
        }
    }
    assert!(inside.is_empty());
    let count = |name: &str| said[name].parse::<usize>().unwrap();
    assert_eq!(count("tests"), suite.cases.len());
    assert_eq!(count("failures"), suite.count(Some("failure")));
    assert_eq!(count("skipped"), suite.count(Some("skipped")));
    assert_eq!(count("errors"), 0);
    let mut names: Vec<(&str, &str)> = suite
        .cases
        .iter()
        .map(|case| (case.class.as_str(), case.name.as_str()))
        .collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), suite.cases.len(), "two cases have one name");
    suite
}

fn run(root: &Path, line: &str) -> Output {
    hil(root, &line.split(' ').collect::<Vec<_>>())
}

#[test]
fn a_run_has_a_case_for_each_block() {
    let root = tempfile::tempdir().unwrap();
    let output = run(
        root.path(),
        "run --blocks 0.1:5:3,0.05:5-10:4 --junit run.xml",
    );
    assert_eq!(output.status.code(), Some(0));
    let suite = suite(&root.path().join("run.xml"));
    assert_eq!(suite.name, "hil run");
    let names: Vec<&str> = suite.cases.iter().map(|case| case.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "block 1: 0.1 mm, 5 Hz, 3 cycles",
            "block 2: 0.05 mm, 5 to 10 Hz, 4 cycles",
            "the rig runs to its end"
        ]
    );
    assert_eq!(suite.cases[0].class, "hil.run.block");
    assert_eq!(suite.count(None), 3);
    assert_eq!(suite.properties["seed"], "1");
    assert_eq!(suite.properties["tick rate, Hz"], "10000");
}

/// The rig stops in the second of three blocks: the file is written although the command fails.
#[test]
fn a_run_that_stops_says_in_which_block() {
    let root = tempfile::tempdir().unwrap();
    let output = run(
        root.path(),
        "run --blocks 0.1:5:3,0.98:5:3,0.1:5:3 --junit run.xml",
    );
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    let suite = suite(&root.path().join("run.xml"));
    assert_eq!(suite.count(None), 1);
    assert_eq!(suite.count(Some("failure")), 2);
    assert_eq!(suite.count(Some("skipped")), 1);
    let stopped = suite.failure("block 2: 0.98 mm, 5 Hz, 3 cycles");
    assert!(stopped.contains("after 0 of 3 cycles"), "{stopped}");
    let why = suite.failure("the rig runs to its end");
    let (cause, _) = why.split_once(", ").unwrap();
    assert!(said.contains(cause), "{said}");
}

#[test]
fn faults_have_a_case_for_each_requirement() {
    let root = tempfile::tempdir().unwrap();
    let output = run(
        root.path(),
        "faults --adversary 2 --check --junit faults.xml --json -",
    );
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(output.stdout[0], b'{');
    let suite = suite(&root.path().join("faults.xml"));
    let name = "the adversary's trials: hazardous states";
    let case = suite.cases.iter().find(|case| case.name == name).unwrap();
    assert!(case.mark.is_none());
    // There were no pairs of attacks.
    let pairs = suite
        .cases
        .iter()
        .find(|case| case.name == "pairs: found")
        .unwrap();
    assert_eq!(pairs.mark.as_ref().unwrap().0, "skipped");
    assert_eq!(suite.count(Some("failure")), 0);
    assert_eq!(suite.properties["attack trials"], "2");
}

/// The floors are the checks; a single seed is not a check.
#[test]
fn blind_trials_have_a_case_for_each_floor_and_seed() {
    let root = tempfile::tempdir().unwrap();
    for (line, specimens, floor) in [
        (
            "blind --seeds 1 --junit blind.xml",
            "Specimens",
            "false discoveries",
        ),
        (
            "blind --motions --seeds 1 --junit blind.xml",
            "Motions",
            "false or missed",
        ),
    ] {
        assert_eq!(run(root.path(), line).status.code(), Some(0));
        let suite = suite(&root.path().join("blind.xml"));
        assert_eq!(suite.properties["specimens"], specimens);
        let of = |class: &str| {
            suite
                .cases
                .iter()
                .filter(|case| case.class == class)
                .count()
        };
        assert_eq!(of("hil.blind.seed"), 1);
        assert!(suite.cases.iter().any(|case| case.name == floor));
    }
}

/// The work broke off: the file of an earlier run is replaced by one with the text of the command's error.
#[track_caller]
fn says_why_it_broke_off(output: &Output, path: &Path) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let error = said.lines().find_map(|line| line.strip_prefix("error: "));
    let suite = suite(path);
    assert_eq!(suite.cases.len(), 1);
    let name = "the command runs to its end";
    assert_eq!(Some(suite.failure(name)), error, "{said}");
}

#[test]
fn a_run_without_its_board_replaces_the_file_of_the_run_before() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("run.xml");
    let before = "run --blocks 0.1:5:3 --out before --junit run.xml";
    assert_eq!(run(root.path(), before).status.code(), Some(0));
    assert_eq!(suite(&path).count(Some("failure")), 0);
    let output = run(root.path(), "run --on serial:/dev/nowhere --junit run.xml");
    says_why_it_broke_off(&output, &path);
    assert_eq!(suite(&path).name, "hil run");
    // Nothing else is written.
    assert!(!root.path().join("run-out").exists());

    // A command that is refused has not begun: it leaves every file.
    let left = fs::read(&path).unwrap();
    let output = run(root.path(), "run --blocks 0.1 --junit run.xml");
    assert_eq!(output.status.code(), Some(2));
    assert!(fs::read(&path).unwrap() == left);
}

/// The recording of the test may not grow to its whole size.
#[cfg(target_os = "linux")]
#[test]
fn a_run_that_breaks_off_replaces_the_file_of_the_run_before_and_keeps_its_recording() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("run.xml");
    let before = "run --blocks 0.1:5:3 --out before --junit run.xml";
    assert_eq!(run(root.path(), before).status.code(), Some(0));
    // In blocks of 512 bytes. The signal for the limit is ignored, which children of the shell inherit.
    let output = Command::new("sh")
        .arg("-c")
        .arg("trap '' XFSZ; ulimit -f 8; exec \"$0\" run --blocks 0.1:5:40 --junit run.xml")
        .arg(env!("CARGO_BIN_EXE_hil"))
        .current_dir(root.path())
        .output()
        .unwrap();
    says_why_it_broke_off(&output, &path);
    let recorded = "run-out/recording.partial.csv";
    let suite = suite(&path);
    let why = suite.failure("the command runs to its end");
    assert!(why.ends_with(recorded), "{why}");
    assert!(root.path().join(recorded).exists());
    assert!(!root.path().join("run-out/recording.csv.gz").exists());
}

/// Everything was counted, and then an output takes nothing.
#[cfg(target_os = "linux")]
#[test]
fn faults_and_blind_trials_that_break_off_say_so() {
    let root = tempfile::tempdir().unwrap();
    for line in [
        "faults --adversary 1",
        "blind --seeds 1",
        "blind --motions --seeds 1",
    ] {
        let line = format!("{line} --json /dev/full --junit broken.xml");
        says_why_it_broke_off(&run(root.path(), &line), &root.path().join("broken.xml"));
    }
}

#[test]
fn a_bench_without_its_tools_says_so() {
    let root = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_hil"))
        .args(["bench", "--junit", "bench.xml"])
        .current_dir(root.path())
        .env("PATH", root.path())
        .env_remove("RUSTC")
        .output()
        .unwrap();
    says_why_it_broke_off(&output, &root.path().join("bench.xml"));
}

#[test]
fn a_folder_takes_no_junit_file() {
    let root = tempfile::tempdir().unwrap();
    crate::refusal::refuses(
        root.path(),
        &["faults", "--part", "--junit", ".", "--check"],
        &["is a directory"],
    );
}
