//! The image's log, decoded.
//!
//! Its channel is the emulator's standard error, where the emulator itself may have written before: text up to the first
//! zero byte, which the image sends before its first message.

use std::io::Read;
use std::thread::JoinHandle;

use defmt_decoder::{DecodeError, Table};
use mesh_damper_recording::error::InputError;

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// What goes on.
    Info,
    /// Something was refused.
    Warn,
    /// The rig stopped.
    Error,
}

impl LogLevel {
    /// Its name as logs write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Info => "INFO",
            Self::Warn => "WARN",
            Self::Error => "ERROR",
        }
    }
}

/// A message of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// Ticks of the rig when it was written.
    pub tick: u32,
    /// How much it matters.
    pub level: LogLevel,
    /// What it says.
    pub text: String,
}

/// Who gets the messages.
pub type LogSink = Box<dyn FnMut(LogLine) + Send>;

/// What the messages' numbers mean, out of an image's file.
pub struct LogDecoder {
    table: Table,
    sink: LogSink,
}

impl LogDecoder {
    /// For the image whose ELF file's bytes are `elf`.
    ///
    /// # Errors
    /// An image without log messages, or of another version of defmt.
    pub fn new(elf: &[u8], sink: LogSink) -> Result<Self, InputError> {
        let failed =
            |problem: String| InputError::new("the image's log", problem, "build the image again");
        let table = Table::parse(elf)
            .map_err(|error| failed(error.to_string()))?
            .ok_or_else(|| failed("the image has no messages".into()))?;
        Ok(Self { table, sink })
    }

    /// Decodes what comes out of `stream` in a thread of its own, until its end.
    pub(super) fn follow(mut self, mut stream: impl Read + Send + 'static) -> LogThread {
        LogThread(Some(std::thread::spawn(move || {
            let mut said = Vec::new();
            let mut begun = false;
            let mut decoder = self.table.new_stream_decoder();
            let mut buffer = [0; 1024];
            // An error is an end, too.
            while let Ok(came @ 1..) = stream.read(&mut buffer) {
                let mut bytes = &buffer[..came];
                if !begun {
                    let end = bytes.iter().position(|&byte| byte == 0);
                    said.extend(&bytes[..end.unwrap_or(came)]);
                    begun = end.is_some();
                    bytes = end.map_or(&[], |end| &bytes[end + 1..]);
                }
                decoder.received(bytes);
                loop {
                    match decoder.decode() {
                        Ok(frame) => {
                            if let Some(line) = line_of(&frame) {
                                (self.sink)(line);
                            }
                        }
                        Err(DecodeError::Malformed) => {}
                        Err(DecodeError::UnexpectedEof) => break,
                    }
                }
            }
            String::from_utf8_lossy(&said).trim().to_owned()
        })))
    }
}

fn line_of(frame: &defmt_decoder::Frame<'_>) -> Option<LogLine> {
    let level = match frame.level()?.as_str() {
        "error" => LogLevel::Error,
        "warn" => LogLevel::Warn,
        _ => LogLevel::Info,
    };
    Some(LogLine {
        tick: frame.display_timestamp()?.to_string().parse().ok()?,
        level,
        text: frame.display_message().to_string(),
    })
}

/// The thread that decodes.
#[derive(Debug)]
pub(super) struct LogThread(Option<JoinHandle<String>>);

impl LogThread {
    /// Waits for the end of the log, and gives what the emulator itself said.
    pub(super) fn end(&mut self) -> String {
        let ended = self.0.take().and_then(|thread| thread.join().ok());
        ended.unwrap_or_default()
    }
}
