//! The thread that talks to the broker. The thread of the test only uses a queue.

use std::sync::atomic::Ordering::SeqCst;
use std::time::Duration;

use rumqttc::{Client, Connection, Event, MqttOptions, Outgoing, Packet, QoS};

use super::Shared;

/// Messages that the broker has not confirmed, at most.
const MOST_UNCONFIRMED: usize = 64;
/// How long new items may wait while the thread listens to the broker.
const BETWEEN_LOOKS: Duration = Duration::from_millis(30);
/// Time between attempts to connect: the first and the longest.
const RETRY: [Duration; 2] = [Duration::from_millis(250), Duration::from_secs(5)];

/// Sends the queue until the publisher has gone.
pub(super) fn run(options: MqttOptions, shared: &Shared) {
    let (client, mut connection) = Client::new(options, 2 * MOST_UNCONFIRMED);
    let [first, longest] = RETRY;
    let mut retry = first;
    while !shared.gone.load(SeqCst) {
        // An attempt to connect must not be interrupted: it has its own time limit.
        match connection.recv() {
            Ok(Ok(_)) => {
                retry = first;
                match talk(&client, &mut connection, shared) {
                    Ended::Done => return,
                    Ended::Lost(why) => lost(shared, why),
                }
            }
            Ok(Err(error)) => lost(shared, error.to_string()),
            Err(_) => return,
        }
        drop(shared.wait(retry, |_| shared.gone.load(SeqCst)));
        retry = (2 * retry).min(longest);
    }
}

/// How a connection ended.
enum Ended {
    /// Everything was sent.
    Done,
    /// The connection was lost.
    Lost(String),
}

/// Sends over a new connection until it ends.
fn talk(client: &Client, connection: &mut Connection, shared: &Shared) -> Ended {
    {
        let mut queue = shared.lock();
        queue.was_connected = true;
        queue.trouble = None;
        let status = queue.status.clone();
        let is_next = |status: &super::Message| {
            let waiting = queue.waiting.iter();
            waiting.clone().any(|message| message.topic == status.topic)
        };
        if let Some(status) = status.filter(|status| !is_next(status)) {
            queue.waiting.push_front(status);
        }
    }
    shared.changed.notify_all();
    let mut says_goodbye = false;
    loop {
        if shared.gone.load(SeqCst) {
            return Ended::Done;
        }
        says_goodbye = says_goodbye || send(client, shared);
        match connection.recv_timeout(BETWEEN_LOOKS) {
            Ok(Ok(Event::Incoming(Packet::PubAck(_)))) => {
                let mut queue = shared.lock();
                // A broker confirms messages in the order of sending.
                if queue.sent.pop_front().is_some() {
                    queue.delivery.delivered += 1;
                }
            }
            Ok(Ok(Event::Outgoing(Outgoing::Disconnect))) => {
                shared.lock().is_closed = true;
                shared.changed.notify_all();
                return Ended::Done;
            }
            Ok(Ok(_)) | Err(rumqttc::RecvTimeoutError::Timeout) => {}
            Ok(Err(error)) => return Ended::Lost(error.to_string()),
            Err(rumqttc::RecvTimeoutError::Disconnected) => return Ended::Done,
        }
    }
}

/// Gives the client the messages that may be sent now. Returns whether the goodbye was among them.
fn send(client: &Client, shared: &Shared) -> bool {
    let mut queue = shared.lock();
    while queue.sent.len() < MOST_UNCONFIRMED {
        let Some(message) = queue.waiting.pop_front() else {
            break;
        };
        let given = client.try_publish(
            &message.topic,
            QoS::AtLeastOnce,
            message.retained,
            message.payload.as_bytes(),
        );
        if given.is_err() {
            queue.waiting.push_front(message);
            break;
        }
        queue.sent.push_back(message);
    }
    queue.is_closing && queue.is_empty() && client.try_disconnect().is_ok()
}

/// There is no connection: unconfirmed messages are sent again, before the rest.
fn lost(shared: &Shared, why: String) {
    let mut queue = shared.lock();
    while let Some(message) = queue.sent.pop_back() {
        queue.waiting.push_front(message);
    }
    queue.trouble = Some(why);
    drop(queue);
    shared.changed.notify_all();
}
