//! Health, cycles and events over MQTT, as JSON with the units in the names.
//!
//! | topic | what | retained |
//! |---|---|---|
//! | `mesh-damper/RIG/status` | how the test is; `offline` is the last will | yes |
//! | `mesh-damper/RIG/health` | once a second: where the test is, extremes, temperature, what was named so far | yes |
//! | `mesh-damper/RIG/cycle` | the results of a cycle | no |
//! | `mesh-damper/RIG/event` | what the monitor named | no |
//!
//! Everything is sent at least once (QoS 1). Without a broker messages wait in a queue of bounded length; the oldest go first, and are
//! counted.

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

/// Messages that wait at most.
const MOST_WAITING: usize = 4096;
/// From a health message to the next.
const BETWEEN_HEALTH: Duration = Duration::from_secs(1);

/// What has become of the messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Delivery {
    /// The broker has them.
    pub delivered: u64,
    /// Too many waited, or the test was over before there was a broker.
    pub dropped: u64,
}

/// Sends what it is told of to a broker, from a thread of its own.
///
/// Dropped without [`MqttPublisher::close`] it leaves without a word, so that the broker says `offline`.
#[derive(Debug)]
pub struct MqttPublisher {
    shared: Arc<Shared>,
    topics: Topics,
    about: Value,
    health: Health,
    health_sent: Option<Instant>,
    thread: Option<JoinHandle<()>>,
}

/// Of one rig.
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

/// What the two threads share.
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
    /// With the broker, which has not said yet that it has them; in the order in which they were sent.
    sent: VecDeque<Message>,
    /// The status as it is: said again whenever there is a connection, as the broker may have said `offline` meanwhile.
    status: Option<Message>,
    delivery: Delivery,
    /// The last word has been said.
    is_closing: bool,
    /// The connection has ended as it should.
    is_closed: bool,
    /// Why there is no connection.
    trouble: Option<String>,
    /// There has been one.
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
    /// Sends to `broker` what is told of the test that is `about`. It begins at once, and goes on to try where there is no broker.
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

    /// Waits until there is a connection, for `most` at most; otherwise why there is none.
    ///
    /// # Errors
    /// Why there is none so far, in words.
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

    /// Waits until the broker has everything, for `most` at most, ends the connection as it should be ended, and says what has become of
    /// the messages. The last will is not sent then.
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
        // It may be in the middle of a connection that is not coming about: the process does not wait for that.
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

/// Samples from look to look at the clock.
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
