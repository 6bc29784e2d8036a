//! A test while it runs: a page in the browser, and health, cycles and events over MQTT.
//!
//! The program that runs a test informs a [`Listener`] about every sample, the results of every cycle, every event and every change
//! of state. There are two listeners. [`LivePage`] serves a page on the loopback interface that plots them. [`MqttPublisher`] sends
//! them to a broker. Neither of them ever waits for a viewer: it drops and counts items that it cannot deliver.
//!
//! This crate does not know rigs. Its values are those of `values.rs`, in s, mm, kN, J and °C.
//!
//! ```
//! use mesh_damper_live::{About, Limits, Listener, LivePage, Sample, State};
//!
//! # fn main() -> Result<(), mesh_damper_output::error::InputError> {
//! let about = About { title: "a sine".into(), sample_rate: 1000.0, ..About::default() };
//! let mut page = LivePage::start(0, about, Limits::default())?;
//! println!("open {}", page.address());
//! for tick in 0..1000 {
//!     let time = f64::from(tick) * 1e-3;
//!     let displacement = 0.1 * (6.28 * time).sin() as f32;
//!     page.sample(&Sample { time, displacement, force: displacement, law_force: displacement });
//! }
//! page.state(&State::Finished { time: 1.0 });
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

pub mod decimate;
pub mod frame;
mod history;
mod mqtt;
mod server;
mod values;

pub use history::{Delivered, Limits};
pub use mqtt::{Broker, Delivery, MqttPublisher};
pub use server::LivePage;
pub use values::{About, CycleResult, Event, Listener, Sample, State};
