//! Links the images by cortex-m-rt's script. It includes the memory.x of the folder that cargo runs the linker in, the
//! workspace's.

fn main() {
    for argument in ["-Tlink.x", "--nmagic"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
