//! The library from outside, through the standard's functions.

mod description;
mod force;
mod master;
mod order;
mod resources;
mod states;
mod steps;
