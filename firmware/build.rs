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
    let boards = BOARDS.iter().copied().filter(|(board, _)| is_enabled(board));
    for (board, arguments) in boards.chain(is_enabled("self-test").then(self_test)) {
        let package = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
        let folder = Path::new(&package).join("boards").join(board);
        println!("cargo:rustc-link-arg-bins=-L{}", folder.display());
        for argument in arguments {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
}

/// The folders of `boards`, which the features of the package have the names of, and the arguments
/// of the linker.
const BOARDS: [(&str, &[&str]); 6] = [
    ("stm32f405", CORTEX_M),
    ("nrf51822", CORTEX_M),
    ("nrf52840", NRF52840),
    ("rp2040", CORTEX_M),
    ("esp32c3", ESP32C3),
    ("riscv-virt", RISC_V),
];

const CORTEX_M: &[&str] = &["--nmagic", "-Tlink.x", "-Tdefmt.x"];

/// The HAL of the nRF52840 has a memory map as well, and the linker finds that one first: the stack
/// begins at the end of the RAM, below the record of a failure.
const NRF52840: &[&str] = &[
    "--nmagic",
    "-Tlink.x",
    "-Tdefmt.x",
    "--defsym=_stack_start=0x2003fff0",
    "--defsym=_failure_record=0x2003fff0",
];

/// The memory map is that of the HAL.
const ESP32C3: &[&str] = &["-Tlinkall.x", "-Tdefmt.x"];

const RISC_V: &[&str] = &["-Tmemory.x", "-Tlink.x", "-Tdefmt.x"];

/// The self-test has no log, and no board but the memory of a chip with the target's core.
fn self_test() -> (&'static str, &'static [&'static str]) {
    match env::var("TARGET").as_deref() {
        Ok("thumbv6m-none-eabi") => ("microbit", &["--nmagic", "-Tlink.x"]),
        Ok("riscv32imc-unknown-none-elf") => ("riscv-virt", &["-Tmemory.x", "-Tlink.x"]),
        _ => ("stm32f405", &["--nmagic", "-Tlink.x"]),
    }
}

fn is_enabled(feature: &str) -> bool {
    let feature = feature.to_uppercase().replace('-', "_");
    env::var_os(format!("CARGO_FEATURE_{feature}")).is_some()
}
