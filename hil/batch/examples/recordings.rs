//! Writes recordings of a few seconds into a folder, each of a different simulated specimen, as material for a batch.
//!
//! `cargo run --release -p mesh-damper-batch --example recordings -- recordings 1000`

#[path = "../tests/batch/simulated.rs"]
#[allow(dead_code, reason = "the tests need more of it")]
mod simulated;

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(count)) = (arguments.next(), arguments.next()) else {
        return Err("give a folder and how many recordings it shall have".into());
    };
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    for seed in 0..count.parse()? {
        let path = folder.join(format!("specimen-{seed:04}.csv"));
        std::fs::write(&path, simulated::drawn(seed).to_file(&path)?)?;
    }
    Ok(())
}
