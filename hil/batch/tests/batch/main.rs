//! Batches of recordings from outside: what is made, what is kept, what is refused.

mod compared;
mod lists;
mod resumed;
mod rows;
mod simulated;
mod varied;
