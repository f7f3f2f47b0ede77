//! The self-test: prints what comes out of every vector, bit by bit, on chips of several kinds and
//! on the host. What it prints is the same everywhere.
//!
//! It asks nothing of a board: a chip prints by semihosting, which QEMU and debug probes have.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    firmware::bench::self_test::run(&mut |vector| println!("{vector}"));
}

#[cfg(target_os = "none")]
mod image {
    use core::panic::PanicInfo;
    use firmware::bench::self_test;
    use semihosting::println;
    use semihosting::process::exit;

    #[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
    #[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
    fn main() -> ! {
        self_test::run(&mut |vector| println!("{vector}"));
        println!("end");
        loop {
            core::hint::spin_loop();
        }
    }

    #[panic_handler]
    fn panic(info: &PanicInfo<'_>) -> ! {
        println!("{info}");
        exit(1)
    }
}
