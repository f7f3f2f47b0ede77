//! What several tests share: references to compare with, the paper's data, and an emulated board.

pub mod dense;
pub mod elf;
pub mod paper;
pub mod qemu;
pub mod rig;
pub mod team;
