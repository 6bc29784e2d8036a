//! Writes the report of a trace on the simulated rig as `report.html` into the given folder:
//! `cargo run --release -p mesh-damper-report --example report -- OUT`.

use std::error::Error;
use std::path::PathBuf;

use mesh_damper_demo::demo;
use mesh_damper_output::Plan;
use mesh_damper_report::{ReportData, render};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("name a folder")?;
    let path = PathBuf::from(folder).join("report.html");
    let mut outputs = Plan::new().writes([&path]).begin()?;
    let demo = demo(3, &|step| eprintln!("{step}"))?;
    let facts = vec![("Hidden".into(), demo.drawn.effect.family().into())];
    let data = ReportData::of_trace("A simulated test", facts, demo.trace);
    outputs.add(path, render(&data));
    Ok(outputs.write()?)
}
