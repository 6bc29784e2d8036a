//! Numbers of things in words.

/// `1 sample`, `5 samples`.
pub(crate) fn counted(samples: usize) -> String {
    let plural = if samples == 1 { "" } else { "s" };
    format!("{samples} sample{plural}")
}

/// A number without the last digits of its binary form: `0.05`, not 0.049999999999999996.
pub(crate) fn plain(value: f64) -> String {
    let rounded: Result<f64, _> = format!("{value:.11e}").parse();
    rounded.unwrap_or(value).to_string()
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn a_number_has_the_digits_that_were_meant() {
        let cases = [
            (0.15 - 0.1, "0.05"),
            (0.1 + 0.2, "0.3"),
            (1_700_000_000.25, "1700000000.25"),
            (0.0, "0"),
            (-1.0 / 8.0, "-0.125"),
        ];
        for (value, text) in cases {
            assert_eq!(plain(value), text);
        }
    }
}
