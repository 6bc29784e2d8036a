//! Links the images by cortex-m-rt's script. It includes the memory.x of the folder that cargo runs the linker in, the
//! workspace's.

fn main() {
    for argument in ["-Tlink.x", "--nmagic"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    // The log's messages are symbols, which this keeps out of the flash.
    println!("cargo::rustc-link-arg-bin=firmware=-Tdefmt.x");
}
