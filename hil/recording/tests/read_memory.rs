//! The memory that reading takes. The process runs this test only.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Write as _;

use mesh_damper_recording::Recording;

/// The peak memory of the process so far, bytes.
fn most_memory() -> usize {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line.unwrap().trim().trim_end_matches(" kB");
    1024 * kibibytes.parse::<usize>().unwrap()
}

/// The basis of the default read limit: at most twelve bytes per byte of the file, for rows of any length.
#[test]
fn is_in_proportion_to_the_file() {
    let names: String = (0..1000).map(|n| format!(",c{n}")).collect();
    let empty = ",".repeat(1000);
    let at_first = most_memory();
    let own = "time_s,displacement_mm,force_kN";
    // In another dialect, with and without the cells as written.
    let (plain, foreign) = (
        "Time [s],Disp [mm],Load [kN]",
        "Time [s];Disp [mm];Load [kN]",
    );
    for (header, names, empty, times) in [
        (own, &*names, &*empty, 1 << 13),
        (own, "", "", 1 << 19),
        (plain, "", "", 1 << 19),
        (foreign, "", "", 1 << 19),
    ] {
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut to = std::io::BufWriter::new(&file);
        writeln!(to, "{header}{names}").unwrap();
        let rows = format!("1,1,1{empty}\n2,2,2{empty}");
        let rows = if header == foreign {
            rows.replace(',', ";")
        } else {
            rows
        };
        for _ in 0..times {
            writeln!(to, "{rows}").unwrap();
        }
        drop(to);
        // Read to the end, where time runs backwards.
        let error = Recording::read(file.path()).unwrap_err().to_string();
        assert!(error.contains("runs backwards"), "{error}");
        let bytes = file.path().metadata().unwrap().len() as usize;
        let taken = most_memory() - at_first;
        assert!(taken < 12 * bytes, "{taken} bytes for {bytes}");
    }
}
