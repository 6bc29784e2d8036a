//! A board on its own timer: it generates its ticks itself, and sends its measurements.

mod beside;
mod record;

pub use beside::EmulatedBoard;
pub use record::{BoardRun, Lost, RecordError, Times, record};
