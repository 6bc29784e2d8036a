//! The image's log, decoded.
//!
//! Its channel is the emulator's standard error, to which the emulator itself may have written before: text up to the first zero
//! byte, which the image sends before its first message.

use std::io::Read;
use std::thread::JoinHandle;

use defmt_decoder::{DecodeError, Table};
use mesh_damper_output::error::InputError;

/// Severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// Normal operation.
    Info,
    /// Something was refused.
    Warn,
    /// The rig stopped.
    Error,
}

impl LogLevel {
    /// Its name in logs.
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
    /// Its severity.
    pub level: LogLevel,
    /// Its text.
    pub text: String,
}

/// Receiver of the messages.
pub type LogSink = Box<dyn FnMut(LogLine) + Send>;

/// Meaning of the message numbers, from an image's file.
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

    /// Decodes the output of `stream` in its own thread, until its end.
    pub(super) fn follow(mut self, mut stream: impl Read + Send + 'static) -> LogThread {
        LogThread(Some(std::thread::spawn(move || {
            let mut said = Vec::new();
            let mut begun = false;
            let mut decoder = self.table.new_stream_decoder();
            let mut buffer = [0; 1024];
            // An error counts as the end too.
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

/// The decoding thread.
#[derive(Debug)]
pub(super) struct LogThread(Option<JoinHandle<String>>);

impl LogThread {
    /// Waits for the end of the log, and returns the emulator's own output.
    pub(super) fn end(&mut self) -> String {
        let ended = self.0.take().and_then(|thread| thread.join().ok());
        ended.unwrap_or_default()
    }
}
