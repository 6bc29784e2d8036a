//! The live page and the MQTT broker of a running test. The test never waits for either.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use clap::Args;
use mesh_damper::health::Event;
use mesh_damper::rig::{CycleReport, Telemetry};
use mesh_damper_live::{
    About, Broker, CycleResult, Delivered, Delivery, Limits, Listener, LivePage, MqttPublisher,
    Sample, State,
};
use mesh_damper_output::ending::{self, AtEnd};
use mesh_damper_output::error::InputError;
use mesh_damper_output::terminal::tell;
use schemars::JsonSchema;
use serde::Serialize;

use super::events::EventRow;
use crate::commands::warn;

/// Options to show a test while it runs.
#[derive(Args, Debug)]
#[command(next_help_heading = "While it runs")]
pub(super) struct LiveOptions {
    /// Show the test on a web page at this port of 127.0.0.1; without a number, at a free port
    ///
    /// The address is printed to standard error. The command ends with the test; an open page keeps its data.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "0")]
    live: Option<u16>,
    /// Before the rig starts, wait at most this long for someone to open the page, in s, 0 to 86400
    #[arg(
        long,
        value_name = "S",
        default_value_t = 0.0,
        requires = "live",
        allow_negative_numbers = true
    )]
    live_wait: f64,
    /// Serve the page for this long after the results are written, in s, 0 to 86400; Ctrl-C ends it earlier
    #[arg(
        long,
        value_name = "S",
        default_value_t = 0.0,
        requires = "live",
        allow_negative_numbers = true
    )]
    live_hold: f64,
    /// Send health, cycles and events to an MQTT broker, as mqtt://[USER[:PASSWORD]@]HOST[:PORT][/RIG]
    ///
    /// The password may be in the environment variable HIL_MQTT_PASSWORD instead, where other users of the machine do not see it.
    #[arg(long, value_name = "URL")]
    mqtt: Option<String>,
}

/// Longest wait at the end until pages and broker have all data.
const TO_THE_END: Duration = Duration::from_secs(3);
/// Longest wait at the start for an answer of the broker.
const FOR_A_BROKER: Duration = Duration::from_secs(2);
/// Longest allowed wait for a page, s.
const LONGEST_WAIT: f64 = 86_400.0;
/// The environment variable with the password of the broker's user.
const PASSWORD: &str = "HIL_MQTT_PASSWORD";

impl LiveOptions {
    /// Whether the page is requested.
    pub(super) fn has_page(&self) -> bool {
        self.live.is_some()
    }

    /// Checks the options before anything moves.
    ///
    /// # Errors
    /// A URL that is not valid, or a time that is too long.
    pub(super) fn check(&self) -> Result<(), InputError> {
        for (option, seconds) in [
            ("--live-wait", self.live_wait),
            ("--live-hold", self.live_hold),
        ] {
            if !(0.0..=LONGEST_WAIT).contains(&seconds) {
                return Err(InputError::new(
                    option,
                    format!("{seconds} s is outside its range"),
                    format!("give 0 to {LONGEST_WAIT}"),
                ));
            }
        }
        self.broker().map(drop)
    }

    fn broker(&self) -> Result<Option<Broker>, InputError> {
        // Other users of the machine see a process's arguments, and not its environment.
        let password = std::env::var(PASSWORD).ok();
        let parse = |url: &String| {
            let broker = url.parse::<Broker>();
            broker.map(|broker| broker.with_password(password))
        };
        // The message does not contain the URL, because it may contain a password.
        self.mqtt.as_ref().map(parse).transpose().map_err(|said| {
            let remedy = "see docs/live.md for the parts of such a URL";
            InputError::new("--mqtt", said, remedy)
        })
    }

    /// Opens the page and the connection for the test `about`, at `tick_rate` Hz. After that the rig may start.
    ///
    /// # Errors
    /// As [`LiveOptions::check`], and a port that is in use. If the broker does not answer, the test continues with a warning.
    pub(super) fn start(&self, about: About, tick_rate: f64) -> Result<Live, InputError> {
        self.check()?;
        let page = match self.live {
            Some(port) => Some(LivePage::start(port, about.clone(), Limits::default())?),
            None => None,
        };
        let broker = self.broker()?;
        // No end comes between the connection and its entry for the end.
        let whole = ending::whole();
        let publisher = broker
            .as_ref()
            .map(|broker| MqttPublisher::start(broker, &about));
        let viewers = Arc::new(Mutex::new(Viewers {
            page: None,
            publisher,
            is_over: false,
        }));
        let at_end = ending::at_end({
            let viewers = viewers.clone();
            move |cause| locked(&viewers).leave(cause)
        });
        drop(whole);
        let unconnected = locked(&viewers).unconnected();
        if let (Some(why), Some(broker)) = (unconnected, &broker) {
            warn(&format!(
                "no broker at {broker} yet ({why}); the test goes on, and hil keeps trying to connect"
            ));
        }
        if let Some(page) = page {
            tell(&format!("The live page is {}", page.address()));
            let wait = Duration::from_secs_f64(self.live_wait);
            if !wait.is_zero() && !page.wait_for_viewer(wait) {
                warn("nobody opened the live page; the test begins");
            }
            // It is waited for without the lock: an end in the meantime has nothing to tell it.
            locked(&viewers).page = Some(page);
        }
        locked(&viewers).tell(|listener| listener.state(&State::Running));
        Ok(Live {
            is_watched: self.live.is_some() || broker.is_some(),
            viewers,
            _at_end: at_end,
            broker,
            tick_rate,
            temperature: f32::NAN,
            hold: Duration::from_secs_f64(self.live_hold),
            mqtt: None,
        })
    }
}

/// Those who watch a test. An end of the program needs their lock, so that nothing is said while it is held.
struct Viewers {
    page: Option<LivePage>,
    publisher: Option<MqttPublisher>,
    /// They know how the test ended.
    is_over: bool,
}

fn locked(viewers: &Mutex<Viewers>) -> MutexGuard<'_, Viewers> {
    viewers.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Viewers {
    fn tell(&mut self, tell: impl Fn(&mut dyn Listener)) {
        if let Some(page) = &mut self.page {
            tell(page);
        }
        if let Some(publisher) = &mut self.publisher {
            tell(publisher);
        }
    }

    /// Waits for the connection to the broker, if there is one; the reason if it does not come.
    fn unconnected(&self) -> Option<String> {
        let publisher = self.publisher.as_ref()?;
        publisher.wait_until_connected(FOR_A_BROKER).err()
    }

    /// The test ended with `state`, which the broker gets before the connection is closed. Returns what became of the messages.
    fn end(&mut self, state: &State) -> Option<Delivery> {
        self.tell(|listener| listener.state(state));
        self.is_over = true;
        let publisher = self.publisher.take();
        publisher.map(|publisher| publisher.close(TO_THE_END))
    }

    /// Gives the pages the rest of the data, and ends them. Returns what they got.
    fn close_page(&mut self) -> Option<Delivered> {
        self.page.take().map(|page| page.close(TO_THE_END))
    }

    /// A signal ends the command: `cause`.
    fn leave(&mut self, cause: &str) {
        if !self.is_over {
            self.end(&State::BrokenOff {
                cause: cause.to_owned(),
            });
        }
        self.close_page();
    }
}

/// The viewers of a test. They also learn of an end by a signal.
pub(super) struct Live {
    is_watched: bool,
    viewers: Arc<Mutex<Viewers>>,
    _at_end: AtEnd,
    broker: Option<Broker>,
    tick_rate: f64,
    /// The last measured temperature, °C.
    temperature: f32,
    hold: Duration,
    /// Known after the connection is closed.
    mqtt: Option<MqttRow>,
}

/// The live page, as JSON.
#[derive(JsonSchema, Serialize)]
pub(super) struct LiveRow {
    /// Address of the page, as a URL on this machine.
    address: String,
    /// Number of pages that were opened until the end of the test.
    viewers: u64,
}

/// The MQTT broker, as JSON.
#[derive(Clone, JsonSchema, Serialize)]
pub(super) struct MqttRow {
    /// Host and port of the broker.
    broker: String,
    /// Number of messages that the broker received.
    delivered: u64,
    /// Number of messages that the broker did not receive.
    dropped: u64,
}

impl Live {
    fn tell(&self, tell: impl Fn(&mut dyn Listener)) {
        locked(&self.viewers).tell(tell);
    }

    pub(super) fn tick(&mut self, telemetry: &Telemetry, time: f64, temperature: f64) {
        if !self.is_watched {
            return;
        }
        self.temperature = temperature as f32;
        let sample = Sample {
            time,
            displacement: telemetry.displacement,
            force: telemetry.measured_force,
            law_force: telemetry.model_force,
        };
        self.tell(|listener| listener.sample(&sample));
    }

    pub(super) fn cycle(&mut self, report: &CycleReport, time: f64) {
        let (measured, model) = (&report.measured, &report.model);
        let cycle = CycleResult {
            time,
            block: report.block as u32,
            cycle: report.cycle,
            ramp: report.ramp,
            amplitude: measured.amplitude,
            frequency: self.tick_rate as f32 / measured.ticks,
            stiffness: measured.stiffness,
            loss_factor: measured.loss_factor,
            energy: measured.energy,
            law_stiffness: model.stiffness,
            law_loss_factor: model.loss_factor,
            error: report.nrmse,
            temperature: self.temperature,
        };
        self.tell(|listener| listener.cycle(&cycle));
    }

    pub(super) fn event(&mut self, event: &Event, time: f64) {
        let event = EventRow::new(&(time, *event)).live();
        self.tell(|listener| listener.event(&event));
    }

    /// The test ended with `state`: sends the state to the broker and closes the connection.
    pub(super) fn end(&mut self, state: &State) {
        let delivery = locked(&self.viewers).end(state);
        if let (Some(delivery), Some(broker)) = (delivery, &self.broker) {
            if delivery.dropped > 0 {
                warn(&format!(
                    "{} messages did not reach the broker at {broker}",
                    delivery.dropped
                ));
            }
            self.mqtt = Some(MqttRow {
                broker: broker.to_string(),
                delivered: delivery.delivered,
                dropped: delivery.dropped,
            });
        }
    }

    pub(super) fn page_row(&self) -> Option<LiveRow> {
        locked(&self.viewers).page.as_ref().map(|page| LiveRow {
            address: page.address(),
            viewers: page.viewers_so_far(),
        })
    }

    /// `None` before [`Live::end`].
    pub(super) fn mqtt_row(&self) -> Option<MqttRow> {
        self.mqtt.clone()
    }

    /// The results are written: serves the page for the requested time, then gives the pages the rest of the data.
    pub(super) fn close(self) {
        if let Some(page) = self.page_row()
            && !self.hold.is_zero()
        {
            tell(&format!(
                "The live page stays at {} for {} s; Ctrl-C ends it earlier",
                page.address,
                self.hold.as_secs_f64()
            ));
            std::thread::sleep(self.hold);
        }
        let delivered = locked(&self.viewers).close_page();
        if let Some(delivered) = delivered
            && delivered.missed > 0
        {
            warn(&format!(
                "{} of {} samples were dropped for pages that were too slow",
                delivered.missed,
                delivered.missed + delivered.samples
            ));
        }
    }
}
