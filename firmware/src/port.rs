//! Frames over a serial port.

use mesh_damper::frame::{Extent, extent};

use crate::board::{Link, Port};

/// Polls of the port before a line counts as idle within a frame: longer than any gap between two bytes of one.
const IDLE: u32 = 2_000_000;
/// The same between two frames, some seconds: a harness that requests ticks sends more within that time.
const SILENT: u32 = 20_000_000;

/// Drops the first `junk` of `came` bytes; returns the number of remaining bytes.
fn drop_first(buffer: &mut [u8], came: usize, junk: usize) -> usize {
    let left = came.saturating_sub(junk);
    for at in 0..left {
        let next = buffer.get(at + junk).copied().unwrap_or_default();
        if let Some(place) = buffer.get_mut(at) {
            *place = next;
        }
    }
    left
}

/// Adds `byte` to the `came` bytes of an incomplete frame in `buffer`, and drops bytes that cannot belong to one. Returns whether
/// the frame is complete.
pub(crate) fn add(byte: u8, buffer: &mut [u8], came: &mut usize) -> bool {
    if let Some(place) = buffer.get_mut(*came) {
        *place = byte;
        *came += 1;
    }
    loop {
        match extent(buffer.get(..*came).unwrap_or_default()) {
            Extent::More => return false,
            Extent::Frame(_) => return true,
            Extent::Junk(junk) => *came = drop_first(buffer, *came, junk),
        }
    }
}

/// The link over a serial port, by polling.
pub struct PortLink<P>(P);

impl<P: Port> Link for PortLink<P> {
    fn open() -> Self {
        Self(P::open())
    }

    /// A frame; or the bytes before the line was idle, which are no frame.
    fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let mut came = 0;
        let mut waited = 0;
        while waited < if came > 0 { IDLE } else { SILENT } {
            match self.0.take() {
                Some(byte) if add(byte, buffer, &mut came) => break,
                Some(_) => waited = 0,
                None => waited += 1,
            }
        }
        buffer.get(..came).unwrap_or_default()
    }

    fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            while !self.0.put(*byte) {}
        }
    }
}
