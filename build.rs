//! Gives the linker of an image its board's memory map. Whoever uses the library links as if this were not there.

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
    // The images name no interrupts.
    std::fs::write(Path::new(&out).join("device.x"), "")?;
    // For this package's own binaries only: a search path or a script for all who link would reach the firmware that uses
    // the library, and hide the memory.x and the device.x of its board.
    for argument in [&format!("-L{out}"), "-Tlink.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    // The log's messages are symbols, which this keeps out of the flash.
    println!("cargo:rustc-link-arg-bin=firmware=-Tdefmt.x");
    Ok(())
}
