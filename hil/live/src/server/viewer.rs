//! One open page, over its WebSocket.
//!
//! Its thread waits for messages from the page, which are few, for at most a thirtieth of a second; then it sends the new data. So
//! a page receives at most thirty parts per second, and a page that stops reading delays only its own thread.

use std::io::{self, ErrorKind, Write as _};
use std::net::TcpStream;
use std::sync::atomic::Ordering::SeqCst;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tungstenite::protocol::{Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::{GOODBYE, Shared, lock};
use crate::frame;
use crate::history::{Delivered, Part, Place};

/// Time between parts.
const BETWEEN_PARTS: Duration = Duration::from_millis(33);
/// Most bytes of a message from a page.
const MOST_RECEIVED: usize = 1 << 10;

/// Sends the page at the other end of `stream` the `answer` to its request, the history, and all new data.
pub(super) fn show(stream: TcpStream, answer: &str, shared: &Shared) -> io::Result<()> {
    stream.set_read_timeout(Some(BETWEEN_PARTS))?;
    stream.set_write_timeout(Some(BETWEEN_PARTS))?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(MOST_RECEIVED))
        .max_frame_size(Some(MOST_RECEIVED));
    let mut viewer = Viewer {
        socket: WebSocket::from_raw_socket(stream, Role::Server, Some(config)),
        place: lock(&shared.history).join(),
        delivered: Delivered::default(),
        is_stalled: false,
    };
    shared.change(|viewers| {
        viewers.now += 1;
        viewers.ever += 1;
    });
    // It counts before it has its answer, because the server waits for pages with an answer. However it ends, it then counts as
    // gone.
    let _ = viewer.run(answer, shared);
    shared.change(|viewers| {
        viewers.now -= 1;
        viewers.gone.samples += viewer.delivered.samples;
        viewers.gone.missed += viewer.delivered.missed;
    });
    Ok(())
}

impl Shared {
    fn change(&self, change: impl FnOnce(&mut super::Viewers)) {
        change(&mut lock(&self.viewers));
        self.changed.notify_all();
    }
}

struct Viewer {
    socket: WebSocket<TcpStream>,
    place: Place,
    delivered: Delivered,
    /// A part of the data is not yet sent; nothing more is sent before it is.
    is_stalled: bool,
}

impl Viewer {
    fn run(&mut self, answer: &str, shared: &Shared) -> Result<(), Error> {
        self.socket.get_mut().write_all(answer.as_bytes())?;
        self.send(vec![text(&shared.about)])?;
        loop {
            self.receive()?;
            if shared.ended.load(SeqCst) {
                return Ok(());
            }
            if self.is_stalled {
                self.is_stalled = !goes(self.socket.flush())?;
                if self.is_stalled {
                    continue;
                }
            }
            let (part, is_closing) = {
                let history = lock(&shared.history);
                // Read before the part is taken: later data are not sent.
                let is_closing = shared.closing.load(SeqCst);
                (history.next(&mut self.place), is_closing)
            };
            let is_empty = part.is_empty();
            self.send_part(part)?;
            if is_closing && is_empty && !self.is_stalled {
                return self.say_goodbye();
            }
        }
    }

    fn send_part(&mut self, part: Part) -> Result<(), Error> {
        self.delivered.missed += part.missed;
        self.delivered.samples += part.samples.len() as u64;
        let mut messages = Vec::new();
        // Missed samples are reported, even if nothing follows them.
        if !part.samples.is_empty() || part.missed > 0 {
            messages.push(binary(frame::of_samples(
                &part.samples,
                self.delivered.missed,
            )));
        }
        if !part.cycles.is_empty() {
            messages.push(binary(frame::of_cycles(
                &part.cycles,
                self.delivered.missed,
            )));
        }
        for event in &part.events {
            messages.push(text(&json!({"type": "event", "event": event})));
        }
        if let Some(state) = &part.state {
            messages.push(text(&json!({"type": "state", "state": state.to_json()})));
        }
        self.send(messages)
    }

    fn send(&mut self, messages: Vec<Message>) -> Result<(), Error> {
        for message in messages {
            // Data that cannot be sent at once wait in the socket's buffer, which holds at most one part.
            goes(self.socket.write(message))?;
        }
        self.is_stalled = !goes(self.socket.flush())?;
        Ok(())
    }

    /// Waits for a message. The content does not matter, only whether the page leaves.
    fn receive(&mut self) -> Result<(), Error> {
        goes(self.socket.read().map(drop)).map(drop)
    }

    fn say_goodbye(&mut self) -> Result<(), Error> {
        goes(self.socket.close(None))?;
        let deadline = Instant::now() + GOODBYE;
        while Instant::now() < deadline {
            self.receive()?;
        }
        Ok(())
    }
}

/// Whether it succeeded. "Not yet" is no error.
fn goes(result: Result<(), Error>) -> Result<bool, Error> {
    match result {
        Ok(()) => Ok(true),
        Err(Error::Io(error))
            if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
        {
            Ok(false)
        }
        Err(error) => Err(error),
    }
}

fn text(value: &Value) -> Message {
    Message::text(value.to_string())
}

fn binary(bytes: Vec<u8>) -> Message {
    Message::binary(bytes)
}
