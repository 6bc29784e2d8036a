//! The memory that reading takes for all formats, damaged files included. The process runs this test only.
#![cfg(all(feature = "formats", target_os = "linux"))]

use std::fs;
use std::path::Path;

use mesh_damper_tables::files::{self, Kept, Reading, Source, Wanted};
use mesh_damper_tables::read_limit::ReadLimit;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Damaged copies of each file.
const COPIES: usize = 40;
const LIMIT: u64 = 1 << 20;

/// The peak memory of the process so far, bytes.
fn most_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line.unwrap().trim().trim_end_matches(" kB");
    1024 * kibibytes.parse::<u64>().unwrap()
}

/// Reads everything in a file.
fn read(bytes: &[u8]) {
    let reading = Reading::from(ReadLimit::new(LIMIT));
    let open = || {
        let source = Source::of(Path::new("spoilt"), bytes, reading.limit).ok()?;
        files::opened(source, &reading).ok()
    };
    let Some((_, file)) = open() else { return };
    for index in 0..file.tables().len().min(4) {
        let Some((_, file)) = open() else { return };
        let columns = file.tables()[index].columns.len().min(8);
        let each = |column| Wanted {
            column,
            must_be_numeric: false,
        };
        let wanted: Vec<Wanted> = (0..columns).map(each).collect();
        let _ = file.read(index, &wanted, Kept::Channels);
    }
}

/// The budget's six bytes for each byte of the limit, and the libraries' own memory.
#[test]
fn is_in_proportion_to_the_limit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats");
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    files.sort();
    let at_first = most_memory();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for path in files {
        let good = fs::read(&path).unwrap();
        read(&good);
        for _ in 0..COPIES {
            let mut bytes = good.clone();
            for _ in 0..random.random_range(1..6) {
                let at = random.random_range(0..bytes.len());
                // Counts and places are large if their high bytes are.
                bytes[at] = [0, 1, 0x7f, 0xff, random.random()][random.random_range(0..5)];
            }
            read(&bytes);
            let taken = most_memory() - at_first;
            assert!(
                taken < 6 * LIMIT + (10 << 20),
                "{taken} bytes of a copy of {}",
                path.display()
            );
        }
    }
}
