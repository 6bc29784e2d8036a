//! Every command in the README and in `docs/` runs as written.
//!
//! A block of shell commands, fenced as `sh`, contains only commands of `hil`. They run page by page in an empty folder. A block that
//! cannot run in this way has the line `<!-- not run: REASON -->` before it.

use std::collections::HashMap;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A command of a page, of one or more lines.
#[derive(Clone, Debug, PartialEq)]
struct Step {
    /// The number of its first line, from 1.
    line: usize,
    text: String,
}

/// The commands of the blocks that run, and the errors in blocks.
fn steps(page: &str) -> (Vec<Step>, Vec<(usize, String)>) {
    let (mut steps, mut wrong) = (Vec::new(), Vec::new());
    let mut before = "";
    let mut lines = page.lines().zip(1..);
    while let Some((line, number)) = lines.next() {
        let Some(language) = line.trim_start().strip_prefix("```") else {
            if !line.trim().is_empty() {
                before = line.trim();
            }
            continue;
        };
        let body: Vec<(&str, usize)> = lines
            .by_ref()
            .take_while(|(line, _)| line.trim() != "```")
            .collect();
        let marked = before
            .strip_prefix("<!-- not run:")
            .and_then(|rest| rest.strip_suffix("-->"));
        before = "";
        if !matches!(language.trim(), "sh" | "shell" | "bash" | "console") {
            continue;
        }
        match marked {
            Some(reason) if reason.trim().is_empty() => {
                wrong.push((number, "\"not run\" gives no reason".to_owned()));
            }
            Some(_) => {}
            None => {
                let of_block = joined(&body);
                let other = of_block.iter().find(|step| !is_of_hil(&step.text));
                if let Some(other) = other {
                    wrong.push((
                        other.line,
                        format!("`{}` is no command of hil: put <!-- not run: REASON --> before the block", other.text),
                    ));
                } else {
                    steps.extend(of_block);
                }
            }
        }
    }
    (steps, wrong)
}

/// The commands of a block. A line that ends with a backslash continues in the next one.
fn joined(body: &[(&str, usize)]) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut goes_on = false;
    for &(line, number) in body {
        let text = line.trim();
        match steps.last_mut() {
            Some(step) if goes_on => step.text += &format!("\n{text}"),
            _ if text.is_empty() || text.starts_with('#') => continue,
            _ => steps.push(Step {
                line: number,
                text: text.to_owned(),
            }),
        }
        goes_on = text.ends_with('\\');
    }
    steps
}

fn is_of_hil(text: &str) -> bool {
    ["cargo hil ", "hil ", "cargo demo"]
        .iter()
        .any(|start| text.starts_with(start) || text.contains(&format!("| {start}")))
}

/// The seed option of a demo that writes to the default folder.
fn is_demo(text: &str) -> Option<&str> {
    let text = text.split(" #").next().unwrap_or(text).trim();
    let text = text.strip_suffix("--out demo-out").unwrap_or(text).trim();
    let text = text.strip_prefix("cargo ").unwrap_or(text);
    let rest = text
        .strip_prefix("hil ")
        .unwrap_or(text)
        .strip_prefix("demo")?
        .trim();
    let is_seed = rest
        .strip_prefix("--seed ")
        .is_some_and(|seed| seed.parse::<u64>().is_ok());
    (rest.is_empty() || is_seed).then_some(rest)
}

/// Runs the commands: folders side by side, and the demos that have been run.
struct Book {
    root: PathBuf,
    path: std::ffi::OsString,
    demos: Mutex<HashMap<String, PathBuf>>,
}

impl Book {
    /// A book in `root`, with a `hil` and a `cargo` that calls it.
    fn new(root: &Path) -> Self {
        let tools = root.join("tools");
        fs::create_dir(&tools).unwrap();
        let hil = Path::new(env!("CARGO_BIN_EXE_hil"));
        std::os::unix::fs::symlink(hil, tools.join("hil")).unwrap();
        let cargo = format!(
            "#!/bin/sh\ncase $1 in\nhil) shift; exec hil \"$@\";;\ndemo) exec hil \"$@\";;\n*) exec '{}' \"$@\";;\nesac\n",
            env!("CARGO")
        );
        let shim = tools.join("cargo");
        fs::write(&shim, cargo).unwrap();
        fs::set_permissions(&shim, fs::Permissions::from_mode(0o755)).unwrap();
        let others = std::env::var_os("PATH").unwrap_or_default();
        let all = [tools].into_iter().chain(std::env::split_paths(&others));
        Self {
            root: root.to_owned(),
            path: std::env::join_paths(all).unwrap(),
            demos: Mutex::default(),
        }
    }

    /// Runs `text` in `folder`; the error is the output of the command.
    fn run(&self, text: &str, folder: &Path) -> Result<(), String> {
        let output = Command::new("sh")
            .args(["-e", "-c", text])
            .current_dir(folder)
            .env("PATH", &self.path)
            // A page must not write into the user's home.
            .env("HOME", folder)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        if output.status.success() {
            return Ok(());
        }
        let error = String::from_utf8_lossy(&output.stderr);
        Err(format!("{}: {}", output.status, error.trim()))
    }

    /// The results of a demo, which runs once.
    fn demo(&self, seed: &str) -> Result<PathBuf, String> {
        let mut demos = self.demos.lock().unwrap();
        if let Some(made) = demos.get(seed) {
            return Ok(made.clone());
        }
        let folder = self.root.join(format!("demo{}", seed.replace(' ', "")));
        fs::create_dir(&folder).unwrap();
        self.run(&format!("hil demo {seed}"), &folder)?;
        let made = folder.join("demo-out");
        demos.insert(seed.to_owned(), made.clone());
        Ok(made)
    }

    /// Runs a page's commands in a separate folder, up to the first that fails.
    fn page(&self, name: &str, steps: &[Step]) -> Result<(), String> {
        let folder = self.root.join(name.replace(['/', '.'], "-"));
        fs::create_dir(&folder).unwrap();
        for step in steps {
            let run = match is_demo(&step.text) {
                Some(seed) => self.demo(seed).map(|made| {
                    let out = folder.join("demo-out");
                    fs::create_dir_all(&out).unwrap();
                    for entry in fs::read_dir(made).unwrap() {
                        let entry = entry.unwrap();
                        fs::copy(entry.path(), out.join(entry.file_name())).unwrap();
                    }
                }),
                None => self.run(&step.text, &folder),
            };
            run.map_err(|error| format!("{name}:{}: `{}`: {error}", step.line, step.text))?;
        }
        Ok(())
    }
}

/// The README and the pages of `docs/`, by their paths from the repository's root.
pub fn pages() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut folders = vec![root.join("docs")];
    let mut paths = vec![root.join("README.md")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                paths.push(path);
            }
        }
    }
    paths.sort();
    paths
        .into_iter()
        .map(|path| {
            let name = path.strip_prefix(&root).unwrap();
            let name = name.display().to_string();
            (name, fs::read_to_string(&path).unwrap())
        })
        .collect()
}

#[test]
fn every_block_of_the_book_is_a_command_or_says_why_it_does_not_run() {
    let mut failures = Vec::new();
    let mut count = 0;
    for (name, text) in pages() {
        let (steps, wrong) = steps(&text);
        let each = wrong.into_iter();
        failures.extend(each.map(|(line, what)| format!("{name}:{line}: {what}")));
        count += steps.len();
    }
    assert!(failures.is_empty(), "\n{}\n", failures.join("\n"));
    // A reader that finds no block would also pass.
    assert!(count > 5, "{count}");
}

#[test]
#[ignore = "minutes; the full tier runs it"]
fn every_command_of_the_book_runs() {
    let root = tempfile::tempdir().unwrap();
    let book = Book::new(root.path());
    let todo: Vec<(String, Vec<Step>)> = (pages().into_iter())
        .map(|(name, text)| (name, steps(&text).0))
        .collect();
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some((name, steps)) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if let Err(failure) = book.page(name, steps) {
                        found.lock().unwrap().push(failure);
                    }
                }
            });
        }
    });
    let mut failures = found.into_inner().unwrap();
    failures.sort();
    assert!(failures.is_empty(), "\n{}\n", failures.join("\n"));
}

#[test]
fn blocks_are_read_as_they_are_meant() {
    let page = "\
text
```sh
cargo hil demo --seed 4   # a comment
# only a comment
hil trace a.csv \\
    --out b
find . | cargo hil batch -
```
<!-- not run: needs a board -->
```sh
make
```
<!-- not run: -->

```sh
make
```

- in a list
  ```sh
  hil paper
  git clone x
  ```
```text
anything
```
";
    let (steps, wrong) = steps(page);
    let lines: Vec<(usize, &str)> = steps
        .iter()
        .map(|step| (step.line, &step.text[..]))
        .collect();
    assert_eq!(
        lines,
        [
            (3, "cargo hil demo --seed 4   # a comment"),
            (5, "hil trace a.csv \\\n--out b"),
            (7, "find . | cargo hil batch -"),
        ]
    );
    let wrong_lines: Vec<usize> = wrong.iter().map(|(line, _)| *line).collect();
    assert_eq!(wrong_lines, [15, 22], "{wrong:?}");
    assert_eq!(
        is_demo("cargo hil demo --seed 4   # a comment"),
        Some("--seed 4")
    );
    assert_eq!(
        is_demo("hil demo --seed 7 --out demo-out"),
        Some("--seed 7")
    );
    assert_eq!(is_demo("cargo demo"), Some(""));
    assert_eq!(is_demo("hil demo --seed 7 --out x"), None);
    assert_eq!(is_demo("hil demo --seed 7 --json x"), None);
}

#[test]
fn a_failure_names_page_line_and_what_the_command_said() {
    let root = tempfile::tempdir().unwrap();
    let book = Book::new(root.path());
    let (steps, _) = steps("a\n```sh\nhil inspect none.csv\n```\n");
    let failure = book.page("docs/a.md", &steps).unwrap_err();
    assert!(
        failure
            .starts_with("docs/a.md:3: `hil inspect none.csv`: exit status: 2: error: none.csv: "),
        "{failure}"
    );
}

/// Lines of prose with more than one sentence. With one sentence a line, a change of a sentence appears as a change of one line.
fn double_sentences(page: &str) -> Vec<usize> {
    let (mut is_code, mut is_html) = (false, false);
    let mut found = Vec::new();
    for (line, number) in page.lines().zip(1..) {
        let text = line.trim();
        if text.starts_with("```") {
            is_code = !is_code;
        }
        is_html |= text.starts_with("<!--");
        if !is_code && !is_html && !text.starts_with(['|', '#']) {
            let ends = text.match_indices(". ").any(|(at, _)| {
                let (before, after) = (&text[..at], &text[at + 2..]);
                // Not within a code span, not a number of a list, and not an abbreviation.
                before.matches('`').count() % 2 == 0
                    && before.len() > 2
                    && after.starts_with(char::is_uppercase)
                    && !["e.g", "i.e", "vs", "approx"]
                        .iter()
                        .any(|short| before.ends_with(short))
            });
            if ends {
                found.push(number);
            }
        }
        if text.ends_with("-->") {
            is_html = false;
        }
    }
    found
}

#[test]
fn a_line_holds_one_sentence() {
    let found: Vec<String> = pages()
        .into_iter()
        .flat_map(|(name, text)| {
            let lines = double_sentences(&text);
            lines.into_iter().map(move |line| format!("{name}:{line}"))
        })
        .collect();
    assert!(
        found.is_empty(),
        "more than one sentence: {}",
        found.join(", ")
    );
    assert_eq!(
        double_sentences("One. Two.\n| a. B |\n```\nA. B\n```\n`a. B` c.\n"),
        [1]
    );
}
