//! Robots that decide together on their own microcontrollers: behavior trees, one kind of whose
//! leaves chooses policies by minimising free energy over the robot's beliefs and its teammates'
//! announced intentions.
//!
//! | to | begin with |
//! |---|---|
//! | use behavior trees alone | [`mod@tree`] |
//! | use active inference alone | [`inference`] |
//! | have a team go to goals on a grid | [`navigation::Mission`], in a `firmware::Controller` |
//! | bring a task of your own | [`iibt::Task`], which [`iibt::InferenceNode`] runs as Algorithm 1 |
//!
//! The modules, each of which knows only those above it:
//!
//! | module | what lives there |
//! |---|---|
//! | [`math`], [`time`] | logarithms and softmax; ticks that may wrap |
//! | [`actions`] | sequences of action codes |
//! | [`grid`], [`mod@tree`] | maps and planners; trees as tables |
//! | [`inference`] | beliefs, free energies, policies |
//! | [`team`] | messages of any task, authenticated frames, the roster of teammates |
//! | [`iibt`] | where trees and inference meet: the node, the task, logic and preferences |
//! | [`navigation`] | the task of a team on a grid: intentions, agreement on one joint plan |
//!
//! Without the default feature `inference`, the library is [`mod@tree`] and [`time`] and depends on
//! nothing.
//!
//! No clock, no I/O, no heap, no `std`: time and bytes come in as arguments, and every table has
//! its size in its type.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

/// The code in the package's README is compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(feature = "inference")]
pub mod actions;
#[cfg(feature = "inference")]
mod bounded;
#[cfg(feature = "inference")]
pub mod grid;
#[cfg(feature = "inference")]
pub mod iibt;
#[cfg(feature = "inference")]
pub mod inference;
#[cfg(feature = "inference")]
pub mod math;
#[cfg(feature = "inference")]
pub mod navigation;
#[cfg(feature = "inference")]
pub mod team;
pub mod time;
pub mod tree;
