//! Names in a message, and options to type.

use mesh_damper_output::error::quoted;
use mesh_damper_output::shell;

/// Largest number of names in a message.
pub(super) const MOST: usize = 12;

/// `--option quantity=name`, as a shell takes it.
pub(super) fn option(option: &str, quantity: &str, name: &str) -> String {
    format!("--{option} {quantity}={}", shell::word(name))
}

/// The names in quotes, as many as a message holds.
pub(super) fn listed(names: &[&str]) -> String {
    let mut shown: Vec<String> = names.iter().take(MOST).map(|name| quoted(name)).collect();
    if names.len() > MOST {
        shown.push(format!("and {} more", names.len() - MOST));
    }
    shown.join(", ")
}
