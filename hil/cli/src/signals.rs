//! SIGINT, SIGTERM, SIGHUP and SIGQUIT: the program ends as [`ending`] says, and then as it would without this.

use std::thread;

use mesh_damper_output::ending;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

const HEARD: [(i32, &str); 4] = [
    (SIGINT, "SIGINT"),
    (SIGTERM, "SIGTERM"),
    (SIGHUP, "SIGHUP"),
    (SIGQUIT, "SIGQUIT"),
];

/// Listens from now on. The second signal ends the program at once.
pub fn listen() {
    let ignored = ignored();
    let heard = HEARD.iter().map(|(signal, _)| *signal);
    let heard = heard.filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let Ok(mut signals) = Signals::new(heard) else {
        // They end the program as they come.
        return;
    };
    thread::spawn(move || {
        let mut signals = signals.forever();
        if let Some(signal) = signals.next() {
            thread::spawn(move || {
                ending::end(&format!("ended by {}", name(signal)));
                by_default(signal);
            });
        }
        signals.for_each(by_default);
    });
}

/// Ends the program as the signal does by default, so that a shell sees what ended it.
fn by_default(signal: i32) {
    // There is no way to go on if it fails, and it does not for these.
    let _ = emulate_default_handler(signal);
}

fn name(signal: i32) -> &'static str {
    let named = HEARD.iter().find(|(each, _)| *each == signal);
    named.map_or("a signal", |(_, name)| name)
}

/// The signals that the program was started to ignore, a bit for each from 1 on: `nohup` does that, and a shell for what it runs in the
/// background. On Linux; elsewhere none is known.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut lines = status.lines();
    let mask = lines.find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap_or_default()
}
