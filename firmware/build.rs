//! Gives the linker the interrupt names of an emulated board, which has none. The package of a chip's registers brings its own.

fn main() {
    println!("cargo::rerun-if-changed=src/emulated/device.x");
    if std::env::var_os("CARGO_FEATURE_EMULATED").is_some() {
        let root = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
        println!("cargo::rustc-link-search={root}/src/emulated");
    }
}
