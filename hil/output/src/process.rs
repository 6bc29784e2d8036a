//! Other programs that the commands start: a compiler, an emulator.
//!
//! On Unix each is a process group of its own. So everything that it starts in turn, such as the compilers of a build, ends with it.

use std::io::{self, Read};
use std::process::{
    Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Output, Stdio,
};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use crate::ending::{self, AtEnd};

/// A program that was started. When this is dropped before the program is over, and at an [end](crate::ending) of this program, it ends,
/// with all that it has started in its group.
#[derive(Debug)]
pub struct Process {
    /// Its standard input, if it is piped.
    pub stdin: Option<ChildStdin>,
    /// Its standard output, if it is piped.
    pub stdout: Option<ChildStdout>,
    /// Its standard error, if it is piped.
    pub stderr: Option<ChildStderr>,
    id: u32,
    started: Arc<Mutex<Started>>,
    _at_end: AtEnd,
}

/// The process itself.
#[derive(Debug)]
struct Started {
    child: Child,
    /// The system has told how it ended, and may give its number to another one.
    is_over: bool,
}

impl Process {
    /// Starts `command`.
    ///
    /// # Errors
    /// The program does not exist, or does not start.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        // No end comes between its start and its entry for the end.
        let _whole = ending::whole();
        let mut child = group::of_its_own(command).spawn()?;
        let (stdin, stdout, stderr) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let id = child.id();
        let started = Arc::new(Mutex::new(Started {
            child,
            is_over: false,
        }));
        let ended = started.clone();
        Ok(Self {
            stdin,
            stdout,
            stderr,
            id,
            started,
            _at_end: ending::at_end(move |_| locked(&ended).end()),
        })
    }

    /// Its number.
    pub fn id(&self) -> u32 {
        self.id
    }

    /// Waits until it ends. Its standard input is closed first.
    ///
    /// # Errors
    /// An error of the system.
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        drop(self.stdin.take());
        // Without the lock, which an end of this program needs meanwhile.
        group::wait(self.id)?;
        let mut started = locked(&self.started);
        let status = started.child.wait()?;
        started.is_over = true;
        Ok(status)
    }

    /// How it ended, if it has.
    ///
    /// # Errors
    /// An error of the system.
    pub fn try_wait(&mut self) -> io::Result<Option<ExitStatus>> {
        let mut started = locked(&self.started);
        let status = started.child.try_wait()?;
        started.is_over |= status.is_some();
        Ok(status)
    }

    /// Ends it at once, with all that it has started.
    pub fn end(&mut self) {
        locked(&self.started).end();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.end();
    }
}

fn locked(started: &Mutex<Started>) -> MutexGuard<'_, Started> {
    started.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Started {
    fn end(&mut self) {
        if self.is_over {
            return;
        }
        self.is_over = true;
        group::end(&self.child);
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
        group::wait_for_the_rest(&self.child);
    }
}

/// Runs `command` to its end, without standard input, and returns what it wrote.
///
/// # Errors
/// As [`Process::start`].
pub fn output(command: &mut Command) -> io::Result<Output> {
    let mut process = Process::start(
        command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped()),
    )?;
    // Both at a time, so that neither pipe fills up.
    let errors = process
        .stderr
        .take()
        .map(|errors| thread::spawn(|| all_of(errors)));
    let stdout = process.stdout.take().map_or(Ok(Vec::new()), all_of)?;
    let errors = errors.and_then(|errors| errors.join().ok());
    Ok(Output {
        stdout,
        stderr: errors.unwrap_or(Ok(Vec::new()))?,
        status: process.wait()?,
    })
}

fn all_of(mut pipe: impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    pipe.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A process group, known by its first process.
#[cfg(unix)]
mod group {
    use std::io;
    use std::os::unix::process::CommandExt as _;
    use std::process::{Child, Command};
    use std::thread;
    use std::time::{Duration, Instant};

    use rustix::io::Errno;
    use rustix::process::{
        Pid, Signal, WaitId, WaitIdOptions, kill_process_group, test_kill_process_group, waitid,
    };

    /// Longest wait for a group whose processes are all killed, and the time between two looks. It takes milliseconds, unless nobody
    /// takes the dead ones away.
    const LONGEST: Duration = Duration::from_secs(1);
    const BETWEEN_LOOKS: Duration = Duration::from_millis(2);

    pub fn of_its_own(command: &mut Command) -> &mut Command {
        command.process_group(0)
    }

    fn number(id: u32) -> Option<Pid> {
        Pid::from_raw(id.cast_signed())
    }

    /// Waits until the process `id` is over, and leaves its number to it.
    pub fn wait(id: u32) -> io::Result<()> {
        let Some(process) = number(id) else {
            return Ok(());
        };
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOWAIT;
        loop {
            match waitid(WaitId::Pid(process), options) {
                Err(Errno::INTR) => {}
                // It has been over for longer.
                Err(Errno::CHILD) => return Ok(()),
                waited => return Ok(waited.map(drop)?),
            }
        }
    }

    /// Ends all processes of the group.
    pub fn end(first: &Child) {
        if let Some(first) = number(first.id()) {
            // It fails only if there is nothing to end.
            let _ = kill_process_group(first, Signal::KILL);
        }
    }

    /// Waits until those are gone that [`end`] has ended.
    pub fn wait_for_the_rest(first: &Child) {
        let begun = Instant::now();
        let is_there =
            || number(first.id()).is_some_and(|first| test_kill_process_group(first).is_ok());
        while is_there() && begun.elapsed() < LONGEST {
            thread::sleep(BETWEEN_LOOKS);
        }
    }
}

/// Only the first process is known.
#[cfg(not(unix))]
mod group {
    use std::io;
    use std::process::{Child, Command};

    pub fn of_its_own(command: &mut Command) -> &mut Command {
        command
    }

    pub fn wait(_: u32) -> io::Result<()> {
        Ok(())
    }

    pub fn end(_: &Child) {}

    pub fn wait_for_the_rest(_: &Child) {}
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    fn lives(id: &str) -> bool {
        let status = std::fs::read_to_string(format!("/proc/{id}/status"));
        status.is_ok_and(|status| !status.contains("State:\tZ"))
    }

    /// A shell that writes the number of a program that it has started, and waits for it.
    fn parent() -> (Process, String) {
        use std::io::BufRead as _;
        let mut shell = Command::new("sh");
        shell
            .args(["-c", "sleep 1000 & echo $!; wait"])
            .stdout(Stdio::piped());
        let mut shell = Process::start(&mut shell).unwrap();
        let mut child = String::new();
        let mut said = io::BufReader::new(shell.stdout.take().unwrap());
        said.read_line(&mut child).unwrap();
        (shell, child.trim().to_owned())
    }

    #[test]
    fn what_a_program_started_ends_with_it() {
        let (shell, child) = parent();
        let id = shell.id().to_string();
        assert!(lives(&id) && lives(&child));
        drop(shell);
        assert!(!lives(&id) && !lives(&child));
    }

    #[test]
    fn a_program_that_has_ended_is_not_ended_again() {
        let mut shell = Process::start(Command::new("sh").args(["-c", "exit 3"])).unwrap();
        assert_eq!(shell.wait().unwrap().code(), Some(3));
        assert_eq!(shell.try_wait().unwrap().unwrap().code(), Some(3));
        assert!(locked(&shell.started).is_over);
    }

    #[test]
    fn all_that_a_program_writes_is_kept() {
        let script = "head -c 300000 /dev/zero; head -c 200000 /dev/zero >&2; exit 4";
        let output = output(Command::new("sh").args(["-c", script])).unwrap();
        assert_eq!(
            (output.stdout.len(), output.stderr.len()),
            (300_000, 200_000)
        );
        assert_eq!(output.status.code(), Some(4));
        let missing = output_of_nothing().unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
    }

    fn output_of_nothing() -> io::Result<Output> {
        output(&mut Command::new("no such program"))
    }
}
