//! The live page and the MQTT broker of a running test. The test never waits for either.

use std::time::Duration;

use clap::Args;
use mesh_damper::health::Event;
use mesh_damper::rig::{CycleReport, Telemetry};
use mesh_damper_live::{
    About, Broker, CycleResult, Limits, Listener, LivePage, MqttPublisher, Sample, State,
};
use mesh_damper_output::error::InputError;
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
        let publisher = broker
            .as_ref()
            .map(|broker| MqttPublisher::start(broker, &about));
        if let (Some(publisher), Some(broker)) = (&publisher, &broker)
            && let Err(why) = publisher.wait_until_connected(FOR_A_BROKER)
        {
            warn(&format!(
                "no broker at {broker} yet ({why}); the test goes on, and hil keeps trying to connect"
            ));
        }
        if let Some(page) = &page {
            eprintln!("The live page is {}", page.address());
            let wait = Duration::from_secs_f64(self.live_wait);
            if !wait.is_zero() && !page.wait_for_viewer(wait) {
                warn("nobody opened the live page; the test begins");
            }
        }
        let mut live = Live {
            page,
            publisher,
            broker,
            tick_rate,
            temperature: f32::NAN,
            hold: Duration::from_secs_f64(self.live_hold),
            mqtt: None,
        };
        live.state(&State::Running);
        Ok(live)
    }
}

/// The viewers of a test.
pub(super) struct Live {
    page: Option<LivePage>,
    publisher: Option<MqttPublisher>,
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
    fn tell(&mut self, tell: impl Fn(&mut dyn Listener)) {
        if let Some(page) = &mut self.page {
            tell(page);
        }
        if let Some(publisher) = &mut self.publisher {
            tell(publisher);
        }
    }

    pub(super) fn tick(&mut self, telemetry: &Telemetry, time: f64, temperature: f64) {
        if self.page.is_none() && self.publisher.is_none() {
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

    fn state(&mut self, state: &State) {
        self.tell(|listener| listener.state(state));
    }

    /// The test ended with `state`: sends the state to the broker and closes the connection.
    pub(super) fn end(&mut self, state: &State) {
        self.state(state);
        if let (Some(publisher), Some(broker)) = (self.publisher.take(), &self.broker) {
            let delivery = publisher.close(TO_THE_END);
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
        self.page.as_ref().map(|page| LiveRow {
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
        let Some(page) = self.page else { return };
        if !self.hold.is_zero() {
            eprintln!(
                "The live page stays at {} for {} s; Ctrl-C ends it earlier",
                page.address(),
                self.hold.as_secs_f64()
            );
            std::thread::sleep(self.hold);
        }
        let delivered = page.close(TO_THE_END);
        if delivered.missed > 0 {
            warn(&format!(
                "{} of {} samples were dropped for pages that were too slow",
                delivered.missed,
                delivered.missed + delivered.samples
            ));
        }
    }
}
