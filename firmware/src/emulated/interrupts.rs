//! No interrupts. cortex-m-rt needs at least one, and fills 1 KiB if it is given none.

#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 1] = [default_handler];

unsafe extern "C" {
    /// The image's handler, as cortex-m-rt names it for the vector table.
    #[link_name = "DefaultHandler"]
    fn default_handler();
}
