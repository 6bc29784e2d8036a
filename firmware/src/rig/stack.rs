//! How much of the stack was used.

/// What cortex-m-rt fills the stack with before `main`.
const PAINT: u32 = 0xCCCC_CCCC;

/// Most bytes of stack used since the start.
pub fn used() -> u32 {
    unsafe extern "C" {
        static _stack_end: u32;
        static _stack_start: u32;
    }
    let mut word = &raw const _stack_end;
    let top = &raw const _stack_start;
    // SAFETY: from the linker's end of the variables to the beginning of the stack it is memory of nobody else.
    while word < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    (top as u32).wrapping_sub(word as u32)
}
