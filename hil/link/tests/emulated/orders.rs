//! Commands to a running emulator: QMP over a socket.

use std::io::{BufRead as _, BufReader, Write as _};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;

use tempfile::TempDir;

/// The socket of an emulator that was started with [`Orders::arguments`].
pub struct Orders {
    folder: TempDir,
}

impl Orders {
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("orders")
    }

    /// For the emulator.
    pub fn arguments(&self) -> [String; 2] {
        let socket = format!("unix:{},server=on,wait=off", self.path().display());
        ["-qmp".into(), socket]
    }

    /// Sends a command to the emulator, and waits until it is done.
    pub fn give(&self, what: &str) {
        let mut orders = UnixStream::connect(self.path()).unwrap();
        let mut answers = BufReader::new(orders.try_clone().unwrap());
        let mut answer = String::new();
        answers.read_line(&mut answer).unwrap();
        for what in ["qmp_capabilities", what] {
            writeln!(orders, "{{\"execute\": \"{what}\"}}").unwrap();
            loop {
                answer.clear();
                answers.read_line(&mut answer).unwrap();
                if answer.contains("\"return\"") {
                    break;
                }
            }
        }
    }
}
