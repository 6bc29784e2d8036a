//! The elastic porous metal mesh damper at a fixed tick.
#![no_std]
#![forbid(unsafe_code)]

pub mod adc;
pub mod converter;
pub mod crossing;
pub mod cycle;
pub mod dac;
pub mod effects;
pub mod error;
pub mod law;
pub mod limits;
pub mod observer;
pub mod power;
pub mod real;
pub mod rig;
pub mod sine;
mod sum;
pub mod table;
