//! Batches of recordings from outside: their results, their stored data and their errors.

mod compared;
mod lists;
mod resumed;
mod rows;
mod simulated;
mod varied;
