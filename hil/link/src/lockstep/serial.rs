//! A board at a serial port.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::time::Duration;

use mesh_damper::frame::{Extent, extent};
use mesh_damper_output::error::InputError;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, flock};
use rustix::termios::{OptionalActions, QueueSelector, speed, tcflush, tcgetattr, tcsetattr};

use super::LinkError;
use super::emulator::Wire;

/// Time without any byte before a request is repeated: at 115 200 baud the longest answer takes 45 ms.
const PATIENCE: Duration = Duration::from_millis(100);
/// Number of times that a request is sent: two seconds, enough for a board to restart.
const MOST_TRIES: u32 = 20;

/// A serial port with a board at its other end. The speed is 115 200 baud, 8 bits, no parity; a port over USB has no speed.
#[derive(Debug)]
pub struct Serial {
    port: File,
    path: String,
    /// Bytes of an incomplete frame.
    begun: Vec<u8>,
}

impl Serial {
    /// Opens the port at `path`, and drops the bytes that are there already.
    ///
    /// # Errors
    /// A path that is not a serial port, or that cannot be opened.
    pub fn open(path: &Path) -> Result<Self, InputError> {
        let name = path.display().to_string();
        let failed = |problem: String| {
            let remedy = "name the device that the board shows as, such as /dev/ttyACM0, and see that you may open it";
            InputError::new(name.clone(), problem, remedy)
        };
        let port = OpenOptions::new()
            .read(true)
            .write(true)
            .custom_flags(rustix::fs::OFlags::NOCTTY.bits() as i32)
            .open(path)
            .map_err(|error| failed(format!("cannot be opened: {error}")))?;
        // With two users a reply could reach the wrong one.
        flock(&port, FlockOperation::NonBlockingLockExclusive)
            .map_err(|_| failed("another program has it open".into()))?;
        let no_port = |error: rustix::io::Errno| failed(format!("is no serial port: {error}"));
        let mut settings = tcgetattr(&port).map_err(no_port)?;
        settings.make_raw();
        settings.set_speed(speed::B115200).map_err(no_port)?;
        tcsetattr(&port, OptionalActions::Now, &settings).map_err(no_port)?;
        tcflush(&port, QueueSelector::IOFlush).map_err(no_port)?;
        Ok(Self {
            port,
            path: name,
            begun: Vec::new(),
        })
    }

    fn gone(&self, problem: &std::io::Error) -> LinkError {
        LinkError::PortGone {
            port: self.path.clone(),
            problem: problem.to_string(),
        }
    }

    /// The first whole frame received; bytes that cannot be a frame are dropped.
    fn take(&mut self) -> Option<Vec<u8>> {
        loop {
            match extent(&self.begun) {
                Extent::More => return None,
                Extent::Frame(bytes) => return Some(self.begun.drain(..bytes).collect()),
                Extent::Junk(bytes) => drop(self.begun.drain(..bytes)),
            }
        }
    }
}

impl Wire for Serial {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        self.port
            .write_all(frame)
            .map_err(|error| self.gone(&error))
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, LinkError> {
        loop {
            if let Some(bytes) = self.take() {
                let (place, _) = buffer.split_at_mut(bytes.len().min(buffer.len()));
                place.copy_from_slice(&bytes[..place.len()]);
                return Ok(place.len());
            }
            let patience = Timespec::try_from(PATIENCE).ok();
            let mut waiting = [PollFd::new(&self.port, PollFlags::IN)];
            match poll(&mut waiting, patience.as_ref()) {
                Ok(0) => {
                    // After an idle line in the middle of a frame its end is lost.
                    self.begun.clear();
                    return Ok(0);
                }
                Ok(_) => {}
                Err(rustix::io::Errno::INTR) => continue,
                Err(error) => return Err(self.gone(&error.into())),
            }
            let mut piece = [0; 1024];
            match self.port.read(&mut piece) {
                Ok(0) => {
                    return Err(self.gone(&std::io::Error::from(ErrorKind::UnexpectedEof)));
                }
                Ok(came) => self.begun.extend(&piece[..came]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.gone(&error)),
            }
        }
    }

    fn most_tries(&self) -> u32 {
        MOST_TRIES
    }

    fn silence(&self) -> LinkError {
        LinkError::SilentBoard(self.path.clone())
    }
}
