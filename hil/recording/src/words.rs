//! Numbers of things in words.

/// `1 sample`, `5 samples`.
pub(crate) fn counted(samples: usize) -> String {
    let plural = if samples == 1 { "" } else { "s" };
    format!("{samples} sample{plural}")
}
