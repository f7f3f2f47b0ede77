//! Links the images of this package with the memory map of their board.
//!
//! The arguments are for the images alone. `rustc-link-search` would reach the packages that depend
//! on this one: such a package without a memory map of its own would link with ours, in silence.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=boards");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let package = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    for board in BOARDS {
        let feature = board.to_uppercase().replace('-', "_");
        if env::var_os(format!("CARGO_FEATURE_{feature}")).is_none() {
            continue;
        }
        let folder = Path::new(&package).join("boards").join(board);
        println!("cargo:rustc-link-arg-bins=-L{}", folder.display());
        let arguments = if *board == "riscv-virt" { RISC_V } else { CORTEX_M };
        for argument in arguments {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
}

/// The folders of `boards`; the features of the package have the same names.
const BOARDS: &[&str] = &["stm32f405", "nrf52840", "rp2040", "riscv-virt"];

const CORTEX_M: &[&str] = &["--nmagic", "-Tlink.x", "-Tdefmt.x"];

const RISC_V: &[&str] = &["-Tmemory.x", "-Tlink.x"];
