//! Links an example with the memory map of the STM32F405.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo:rerun-if-changed=../stm32f405.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let package = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let map = Path::new(&package).join("../../firmware/boards/stm32f405");
    println!("cargo:rerun-if-changed={}", map.join("memory.x").display());
    println!("cargo:rustc-link-arg-bins=-L{}", map.display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
