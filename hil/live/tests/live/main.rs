//! The live page and the publisher from outside.

mod common;
mod dashboard;
mod mqtt;
mod page;
mod server;
