//! Links the images with cortex-m-rt's script. The script includes the memory.x of the folder in which cargo runs the linker, the
//! workspace's.

fn main() {
    for argument in ["-Tlink.x", "--nmagic"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    // The log's messages are symbols; this keeps them out of the flash.
    println!("cargo::rustc-link-arg-bin=firmware=-Tdefmt.x");
}
