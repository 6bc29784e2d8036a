#![no_main]

/// Ticks of one input.
const TICKS: u32 = 1000;

libfuzzer_sys::fuzz_target!(|script: &[u8]| {
    mesh_damper_fuzz::rig::check(script, TICKS);
});
