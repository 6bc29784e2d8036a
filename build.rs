//! Gives the linker of an image its board's memory map.

use std::env;
use std::path::Path;

fn main() -> std::io::Result<()> {
    println!("cargo:rerun-if-changed=boards");
    let variable = |name: &str| env::var(name).unwrap_or_default();
    if variable("CARGO_CFG_TARGET_OS") != "none" {
        return Ok(());
    }
    let board = if variable("TARGET").starts_with("thumbv6m") {
        "microbit"
    } else if env::var_os("CARGO_FEATURE_STM32F405").is_some() {
        "stm32f405"
    } else {
        "mps2-an386"
    };
    // A memory.x in the workspace's root would be found before this one.
    let out = variable("OUT_DIR");
    std::fs::copy(
        format!("boards/{board}/memory.x"),
        Path::new(&out).join("memory.x"),
    )?;
    // The firmware has no interrupts to be named.
    std::fs::write(Path::new(&out).join("device.x"), "")?;
    println!("cargo:rustc-link-search={out}");
    // The log's messages are symbols, which this keeps out of the flash.
    println!("cargo:rustc-link-arg-bin=firmware=-Tdefmt.x");
    Ok(())
}
