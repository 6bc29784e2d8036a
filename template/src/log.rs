//! The log over RTT: the debug probe reads it from the chip's memory while the rig runs. `cargo run` shows it.

use mesh_damper_firmware::Log;
use rtt_target::{UpChannel, rtt_init};

/// The channel.
pub struct Rtt(UpChannel);

impl Log for Rtt {
    fn open() -> Self {
        // Where no probe reads it, it fills and what comes later is lost. It never waits.
        let channels = rtt_init! {
            up: {
                0: {
                    size: 1024,
                    mode: rtt_target::ChannelMode::NoBlockSkip,
                    name: "defmt"
                }
            }
        };
        Self(channels.up.0)
    }

    fn send(&mut self, message: &[u8]) -> bool {
        self.0.write(message) == message.len()
    }
}
