//! The live page and the publisher from outside.

mod broker;
mod common;
mod dashboard;
mod mqtt;
mod page;
mod server;
