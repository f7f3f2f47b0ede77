//! Links the images: those for the board with the memory map at the root of the workspace, that for
//! RISC-V with its own.

use std::env;
use std::path::Path;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let package = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let package = Path::new(&package);
    let (folder, memory, arguments) = if env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("riscv32") {
        (package.join("riscv"), "virt.x", &["-Tvirt.x", "-Tlink.x"][..])
    } else {
        let root = package.parent().expect("the package lies inside the workspace");
        (root.to_path_buf(), "memory.x", &["--nmagic", "-Tlink.x", "-Tdefmt.x"][..])
    };
    println!("cargo:rerun-if-changed={}", folder.join(memory).display());
    println!("cargo:rustc-link-search={}", folder.display());
    for argument in arguments {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
