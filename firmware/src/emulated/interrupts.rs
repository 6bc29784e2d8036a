//! No interrupts. cortex-m-rt wants one at least, and fills 1 KiB where it is told of none.

#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 1] = [default_handler];

unsafe extern "C" {
    /// The image's, as cortex-m-rt names it for the vector table.
    #[link_name = "DefaultHandler"]
    fn default_handler();
}
