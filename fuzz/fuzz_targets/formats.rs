#![no_main]

libfuzzer_sys::fuzz_target!(|script: &[u8]| {
    mesh_damper_fuzz::formats::check(script);
});
