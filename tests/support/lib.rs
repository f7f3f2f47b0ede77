//! Support shared by several tests: references to compare with, and an emulated board.

pub mod budgets;
pub mod chips;
pub mod dense;
pub mod elf;
pub mod gdb;
pub mod ground;
pub mod handling;
pub mod judge;
pub mod nor_flash;
pub mod oracle;
pub mod package;
pub mod peers;
pub mod qemu;
pub mod rig;
