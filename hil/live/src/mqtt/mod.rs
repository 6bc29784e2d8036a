//! Health, cycles and events over MQTT, as JSON with the units in the names.
//!
//! | topic | content | retained |
//! |---|---|---|
//! | `mesh-damper/RIG/status` | the state of the test; `offline` is the last will | yes |
//! | `mesh-damper/RIG/health` | once a second: progress, extremes, temperature, causes named so far | yes |
//! | `mesh-damper/RIG/cycle` | the results of a cycle | no |
//! | `mesh-damper/RIG/event` | a cause that the monitor named | no |
//!
//! Everything is sent at least once (QoS 1). Without a broker, messages wait in a queue of limited length; when it is full, the
//! oldest are dropped and counted.

mod broker;
mod connection;
mod health;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde::Serialize;
use serde_json::{Value, json};

pub use broker::Broker;

use crate::values::{About, CycleResult, Event, Listener, Sample, State};
use health::Health;

/// Most waiting messages.
const MOST_WAITING: usize = 4096;
/// From a health message to the next.
const BETWEEN_HEALTH: Duration = Duration::from_secs(1);

/// The number of delivered and dropped messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Delivery {
    /// The broker has them.
    pub delivered: u64,
    /// Too many were waiting, or the test ended before there was a broker.
    pub dropped: u64,
}

/// Sends its input to a broker from a separate thread.
///
/// If it is dropped without [`MqttPublisher::close`], it leaves without a goodbye, so that the broker publishes `offline`.
#[derive(Debug)]
pub struct MqttPublisher {
    shared: Arc<Shared>,
    topics: Topics,
    about: Value,
    health: Health,
    health_sent: Option<Instant>,
    thread: Option<JoinHandle<()>>,
}

/// The topics of one rig.
#[derive(Clone, Debug)]
struct Topics {
    status: String,
    health: String,
    cycle: String,
    event: String,
}

impl Topics {
    fn of(rig: &str) -> Self {
        let topic = |name: &str| format!("mesh-damper/{rig}/{name}");
        Self {
            status: topic("status"),
            health: topic("health"),
            cycle: topic("cycle"),
            event: topic("event"),
        }
    }
}

#[derive(Clone, Debug)]
struct Message {
    topic: String,
    payload: String,
    retained: bool,
}

/// The state shared by the two threads.
#[derive(Debug, Default)]
struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
    /// The publisher has gone.
    gone: AtomicBool,
}

#[derive(Debug, Default)]
struct Queue {
    waiting: VecDeque<Message>,
    /// Sent but unconfirmed messages, in the order of sending.
    sent: VecDeque<Message>,
    /// The current status. It is sent again with every new connection, because the broker may have published `offline` meanwhile.
    status: Option<Message>,
    delivery: Delivery,
    /// The last message was queued.
    is_closing: bool,
    /// The connection ended properly.
    is_closed: bool,
    /// The reason for having no connection.
    trouble: Option<String>,
    /// There was a connection.
    was_connected: bool,
}

impl Queue {
    fn push(&mut self, message: Message) {
        if self.waiting.len() == MOST_WAITING {
            self.waiting.pop_front();
            self.delivery.dropped += 1;
        }
        self.waiting.push_back(message);
    }

    fn is_empty(&self) -> bool {
        self.waiting.is_empty() && self.sent.is_empty()
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait(&self, most: Duration, is_so: impl Fn(&Queue) -> bool) -> MutexGuard<'_, Queue> {
        let waited = self
            .changed
            .wait_timeout_while(self.lock(), most, |queue| !is_so(queue));
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

impl MqttPublisher {
    /// Sends to `broker` the data of the test that `about` describes. It starts at once, and keeps trying if there is no broker.
    pub fn start(broker: &Broker, about: &About) -> Self {
        let topics = Topics::of(broker.rig());
        let shared = Arc::new(Shared::default());
        let mut publisher = Self {
            shared: shared.clone(),
            about: json!(about),
            topics,
            health: Health::default(),
            health_sent: None,
            thread: None,
        };
        publisher.say_status(&State::Waiting);
        let will =
            publisher.status_payload(&json!({"state": "offline", "time_s": null, "cause": null}));
        let options = broker.options(&publisher.topics.status, &will);
        publisher.thread = Some(std::thread::spawn(move || {
            connection::run(options, &shared)
        }));
        publisher
    }

    /// Waits up to `most` for a connection.
    ///
    /// # Errors
    /// The reason why there is no connection so far, as text.
    pub fn wait_until_connected(&self, most: Duration) -> Result<(), String> {
        let queue = self
            .shared
            .wait(most, |queue| queue.was_connected || queue.trouble.is_some());
        match (&queue.trouble, queue.was_connected) {
            (_, true) => Ok(()),
            (Some(trouble), false) => Err(trouble.clone()),
            (None, false) => Err("it does not answer".into()),
        }
    }

    /// Waits up to `most` until the broker has everything, ends the connection properly, and reports the fate of the messages. The
    /// last will is not sent then.
    pub fn close(mut self, most: Duration) -> Delivery {
        self.say_health();
        self.shared.lock().is_closing = true;
        let queue = self.shared.wait(most, |queue| queue.is_closed);
        let mut delivery = queue.delivery;
        delivery.dropped += (queue.waiting.len() + queue.sent.len()) as u64;
        drop(queue);
        self.leave();
        delivery
    }

    fn leave(&mut self) {
        self.shared.gone.store(true, SeqCst);
        self.shared.changed.notify_all();
        // The thread may be in the middle of an attempt to connect: the process does not wait for it.
        drop(self.thread.take());
    }

    fn status_payload(&self, state: &Value) -> String {
        let mut payload = state.clone();
        payload["format"] = "mesh-damper mqtt".into();
        payload["version"] = 1.into();
        payload["about"] = self.about.clone();
        payload.to_string()
    }

    fn say_status(&mut self, state: &State) {
        let message = Message {
            topic: self.topics.status.clone(),
            payload: self.status_payload(&state.to_json()),
            retained: true,
        };
        let mut queue = self.shared.lock();
        queue.status = Some(message.clone());
        queue.push(message);
    }

    fn say_health(&mut self) {
        self.health_sent = Some(Instant::now());
        let dropped = self.shared.lock().delivery.dropped;
        let payload = self.health.take(dropped).to_string();
        self.say(self.topics.health.clone(), payload, true);
    }

    fn say(&self, topic: String, payload: String, retained: bool) {
        self.shared.lock().push(Message {
            topic,
            payload,
            retained,
        });
    }
}

impl Drop for MqttPublisher {
    fn drop(&mut self) {
        self.leave();
    }
}

/// Samples between two checks of the clock.
const SAMPLES_PER_LOOK: u64 = 64;

impl Listener for MqttPublisher {
    fn sample(&mut self, sample: &Sample) {
        self.health.sample(sample);
        if !self.health.samples().is_multiple_of(SAMPLES_PER_LOOK) {
            return;
        }
        let since = self.health_sent.map(|sent| sent.elapsed());
        if since.is_none_or(|since| since >= BETWEEN_HEALTH) {
            self.say_health();
        }
    }

    fn cycle(&mut self, cycle: &CycleResult) {
        self.health.cycle(cycle);
        self.say(self.topics.cycle.clone(), json!(cycle).to_string(), false);
    }

    fn event(&mut self, event: &Event) {
        self.health.event(event);
        self.say(self.topics.event.clone(), json!(event).to_string(), false);
    }

    fn state(&mut self, state: &State) {
        self.health.state(state);
        self.say_status(state);
    }
}
