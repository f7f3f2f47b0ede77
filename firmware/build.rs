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
    for (board, scripts) in BOARDS {
        let feature = board.to_uppercase().replace('-', "_");
        if env::var_os(format!("CARGO_FEATURE_{feature}")).is_none() {
            continue;
        }
        let folder = Path::new(&package).join("boards").join(board);
        println!("cargo:rustc-link-arg-bins=-L{}", folder.display());
        for script in *scripts {
            println!("cargo:rustc-link-arg-bins={script}");
        }
    }
}

/// The linker's arguments for each board.
const BOARDS: &[(&str, &[&str])] =
    &[("stm32f405", &["--nmagic", "-Tlink.x", "-Tdefmt.x"]), ("riscv-virt", &["-Tmemory.x", "-Tlink.x"])];
