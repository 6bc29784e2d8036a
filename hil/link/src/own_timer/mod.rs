//! A board on its own timer: nobody gives it its ticks, and it sends what it measures.

mod beside;
mod record;

pub use beside::EmulatedBoard;
pub use record::{BoardRun, Lost, RecordError, Times, record};
