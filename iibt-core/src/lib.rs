//! Robots that decide together on their own microcontrollers.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod actions;
mod bounded;
pub mod grid;
pub mod iibt;
pub mod inference;
pub mod math;
pub mod team;
pub mod time;
pub mod tree;
