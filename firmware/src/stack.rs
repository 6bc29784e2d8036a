//! The amount of stack that was used.

/// The value with which cortex-m-rt fills the stack before `main`.
pub const PAINT: u32 = 0xCCCC_CCCC;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Most bytes of stack used since the start.
pub fn used() -> u32 {
    let top = &raw const _stack_start;
    (top as u32).wrapping_sub(deepest())
}

/// The lowest possible word of the stack, at the end of the variables.
pub fn lowest() -> *mut u32 {
    (&raw const _stack_end).cast_mut()
}

/// Address of the lowest used word.
pub fn deepest() -> u32 {
    let mut word = lowest().cast_const();
    let top = &raw const _stack_start;
    // SAFETY: from the linker's end of the variables to the beginning of the stack, nobody else uses the memory.
    while word < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    word as u32
}
