//! Names that C and Rust accept.

/// Words that cannot name a Rust module, including those of later editions.
const KEYWORDS: &str = "abstract as async await become box break const continue crate do dyn else enum extern false final fn for gen if \
    impl in let loop macro match mod move mut override priv pub ref return self static struct super trait true try type typeof unsafe \
    unsized use virtual where while yield";

/// `name` with only ASCII letters, digits and single `_`, and no digit at its beginning, so that anything may be appended:
/// `Mount 4 (new)` becomes `Mount_4_new`. A name without letters, or with a digit first, gets the prefix `model`.
pub fn c_identifier(name: &str) -> String {
    let parts = name.split(|c: char| !c.is_ascii_alphanumeric());
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    let joined = parts.join("_");
    match joined.chars().next() {
        None => "model".into(),
        Some(first) if first.is_ascii_digit() => format!("model_{joined}"),
        Some(_) => joined,
    }
}

/// `name` as the name of a Rust module: in lower case, with a `_` after a keyword.
pub fn rust_module(name: &str) -> String {
    let module = c_identifier(name).to_ascii_lowercase();
    if KEYWORDS.split_whitespace().any(|word| word == module) {
        return module + "_";
    }
    module
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_no_identifier_becomes_one() {
        for (name, c, rust) in [
            ("mount", "mount", "mount"),
            ("Mount-4 (new)", "Mount_4_new", "mount_4_new"),
            ("Dämpfer", "D_mpfer", "d_mpfer"),
            ("3g", "model_3g", "model_3g"),
            ("", "model", "model"),
            ("質量", "model", "model"),
            ("__a__b__", "a_b", "a_b"),
            ("type", "type", "type_"),
            ("Self", "Self", "self_"),
            ("*/ int main", "int_main", "int_main"),
        ] {
            assert_eq!((&*c_identifier(name), &*rust_module(name)), (c, rust));
        }
    }
}
