//! Measures recordings per second and memory of `hil batch` over its number of workers, as a table and a picture; and a batch that
//! is killed half way. Fails if that batch, started again, computes a recording twice or leaves one out.
//!
//! `cargo run --release -p mesh-damper-batch --example throughput -- target/release/hil recordings batch-throughput.svg`

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use mesh_damper_report::over_time::{Panel, Value, picture};

type Failed = Box<dyn std::error::Error>;

const WORKERS: [usize; 3] = [1, 2, 4];
/// Time between two checks of a process. The system keeps its peak memory.
const LOOK: Duration = Duration::from_millis(20);

fn start(hil: &str, folder: &str, out: &Path, workers: usize) -> Result<Child, Failed> {
    let mut command = Command::new(hil);
    command.args(["batch", folder, "--jobs", &workers.to_string(), "--json"]);
    command
        .arg(out.with_extension("json"))
        .arg("--out")
        .arg(out);
    Ok(command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?)
}

/// Waits for the process to end; returns its peak memory, MiB.
fn wait(mut child: Child) -> Result<f64, Failed> {
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0.0;
    while child.try_wait()?.is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        if let Some(kib) =
            line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok())
        {
            peak = kib / 1024.0;
        }
        thread::sleep(LOOK);
    }
    Ok(peak)
}

fn summary(out: &Path) -> Result<serde_json::Value, Failed> {
    Ok(serde_json::from_slice(&fs::read(
        out.with_extension("json"),
    )?)?)
}

fn main() -> Result<(), Failed> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [hil, folder, svg] = &arguments[..] else {
        return Err("give the command, a folder of recordings, and where the picture goes".into());
    };
    let folder_of_batches = tempfile::tempdir()?;
    let root = folder_of_batches.path();
    let mut measured = Vec::new();
    println!(
        "| workers | recordings | s | a second | peak of memory, MiB |\n|---|---|---|---|---|"
    );
    for workers in WORKERS {
        let out = root.join(format!("with-{workers}"));
        let memory = wait(start(hil, folder, &out, workers)?)?;
        let summary = summary(&out)?;
        let count = summary["computed"].as_f64().ok_or("no count")?;
        let seconds = summary["seconds"].as_f64().ok_or("no time")?;
        println!(
            "| {workers} | {count} | {seconds:.1} | {:.1} | {memory:.0} |",
            count / seconds
        );
        measured.push((workers as f64, count / seconds, memory));
    }

    let out = root.join("killed");
    let total = fs::read_dir(folder)?.count();
    let journal = out.join("journal.jsonl");
    let lines = || {
        fs::read(&journal).map_or(0, |bytes| {
            bytes.iter().filter(|&&byte| byte == b'\n').count()
        })
    };
    let mut child = start(hil, folder, &out, 2)?;
    while lines() <= total / 2 && child.try_wait()?.is_none() {
        thread::sleep(LOOK);
    }
    child.kill()?;
    child.wait()?;
    // Below the head; a cut last line is made again.
    let kept = lines().saturating_sub(1);
    wait(start(hil, folder, &out, 2)?)?;
    let made = summary(&out)?["computed"].as_u64().ok_or("no count")? as usize;
    println!(
        "\nKilled with {kept} of {total} rows kept; then {made} were made, {} of them again.",
        (kept + made).saturating_sub(total)
    );
    if kept == 0 || kept >= total {
        return Err("the batch was not killed half way: give more recordings".into());
    }
    // A line for each finished trace, in the order in which they were made.
    let text = fs::read_to_string(&journal)?;
    let rows: Vec<serde_json::Value> = text
        .lines()
        .skip(1)
        .map(serde_json::from_str)
        .collect::<Result<_, _>>()?;
    let distinct: BTreeSet<&str> = rows.iter().filter_map(|row| row["id"].as_str()).collect();
    if kept + made != total || rows.len() != total || distinct.len() != total {
        return Err(format!(
            "of {total} recordings, {kept} were kept and {made} made after the kill; the journal has {} rows of {} recordings",
            rows.len(),
            distinct.len()
        )
        .into());
    }

    let panel = |title: &str, unit: &str, of: fn(&(f64, f64, f64)) -> f64| Panel {
        title: title.into(),
        name: title.into(),
        unit: unit.into(),
        changed: false,
        p: None,
        values: measured
            .iter()
            .map(|one| Value {
                time: one.0,
                value: of(one),
                interval: None,
            })
            .collect(),
    };
    let panels = [
        panel("recordings a second", "", |one| one.1),
        panel("peak of memory", "MiB", |one| one.2),
    ];
    fs::write(
        svg,
        picture("Throughput of a batch over its workers", "workers", &panels),
    )?;
    Ok(())
}
