//! Joint plans on a 32-bit RISC-V without a floating-point unit: prints the digests of the plans
//! and decisions for the random problems of `joint_plans`, to be compared with those of other
//! targets.
//!
//! It runs in QEMU's machine `virt`: a serial port, and a device that ends the emulation.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image runs in QEMU's machine `virt` for RISC-V; the tests build and start it.");
}

#[cfg(target_os = "none")]
mod image {
    use core::fmt::{self, Write};
    use core::panic::PanicInfo;
    use firmware::bench::joint_plans::{List, Planner, Plans, plan_all};

    /// The transmit register of the machine's serial port.
    const SERIAL: *mut u8 = 0x1000_0000 as *mut u8;

    /// The register whose value ends the emulation.
    const FINISHER: *mut u32 = 0x10_0000 as *mut u32;

    struct Serial;

    impl Write for Serial {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            for byte in text.bytes() {
                #[expect(unsafe_code, reason = "a register of the machine; QEMU takes bytes at any time")]
                unsafe {
                    SERIAL.write_volatile(byte);
                }
            }
            Ok(())
        }
    }

    #[riscv_rt::entry]
    fn main() -> ! {
        let (mut planner, mut list) = (Planner::new(), List::new());
        for robots in [2, 4, 8] {
            print("plans", robots, &plan_all(robots, |problem| (problem.plan(&mut planner), 0)));
            print("decisions", robots, &plan_all(robots, |problem| (problem.decide(&mut list), 0)));
        }
        end(0x5555)
    }

    fn print(what: &str, robots: usize, plans: &Plans) {
        let Plans { units, digest, .. } = plans;
        // The port takes all there is.
        let _ = writeln!(Serial, "{what} of {robots} robots: {units} units, digest {digest:08x}");
    }

    /// Ends the emulation with success (0x5555) or a failure.
    fn end(how: u32) -> ! {
        #[expect(unsafe_code, reason = "a register of the machine that nothing else writes")]
        unsafe {
            FINISHER.write_volatile(how);
        }
        loop {
            core::hint::spin_loop();
        }
    }

    #[panic_handler]
    fn panic(info: &PanicInfo<'_>) -> ! {
        let _ = writeln!(Serial, "{info}");
        end(0x1_3333) // exit status 1
    }
}
