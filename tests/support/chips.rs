//! Emulated chips with different cores, which print by semihosting.

use crate::elf::Elf;
use crate::gdb::Paused;
use crate::qemu::{PATIENCE, directory, image_for};
use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};

/// A chip that QEMU emulates.
#[derive(Clone, Copy, Debug)]
pub struct Chip {
    /// Its core.
    pub core: &'static str,
    /// What images for it are built for.
    pub target: &'static str,
    /// The emulator and its machine.
    emulator: &'static [&'static str],
}

/// One chip for each kind of core.
pub const CHIPS: [Chip; 3] = [
    Chip {
        core: "Cortex-M4F",
        target: "thumbv7em-none-eabihf",
        emulator: &["qemu-system-arm", "-M", "netduinoplus2"],
    },
    Chip {
        core: "Cortex-M0",
        target: "thumbv6m-none-eabi",
        emulator: &["qemu-system-arm", "-M", "microbit"],
    },
    Chip {
        core: "RV32IMC",
        target: "riscv32imc-unknown-none-elf",
        emulator: &["qemu-system-riscv32", "-M", "virt", "-bios", "none"],
    },
];

/// The console of a run: by way of a character device, as QEMU prints some of it as errors else.
const CONSOLE: [&str; 6] = [
    "-chardev",
    "stdio,id=console",
    "-semihosting-config",
    "enable=on,target=native,chardev=console",
    "-serial",
    "null",
];

/// What an image printed until its line `end`.
#[derive(Clone, Debug)]
pub struct Printed {
    /// The lines before that.
    pub lines: Vec<String>,
    /// The bytes of the stack that it had used by then.
    pub stack: u64,
}

impl Chip {
    /// Builds an image of the package `firmware` with a feature, and runs it until it prints `end`.
    ///
    /// # Panics
    /// When it does not build, or ends or falls silent before.
    #[must_use]
    pub fn run(self, name: &str, feature: &str) -> Printed {
        let image = image_for(name, "firmware", self.target, feature);
        let elf = Elf::read(&image);
        let [bottom, top] = ["_stack_end", "_stack_start"].map(|symbol| elf.value_of(symbol) as u32);
        let sockets = directory();
        let debugger = sockets.join("gdb");
        let mut command = Command::new(self.emulator[0]);
        command.args(&self.emulator[1..]).args(["-display", "none", "-monitor", "none", "-no-reboot", "-S"]);
        command.args(["-gdb", &format!("unix:{},server=on,wait=off", debugger.display())]).args(CONSOLE);
        command.arg("-kernel").arg(&image).stdin(Stdio::null()).stdout(Stdio::piped());
        let qemu = command.spawn();
        let mut qemu = Ending(
            qemu.unwrap_or_else(|error| panic!("{}: {error}; `tests/run` installs it", self.emulator[0])),
        );
        let lines = lines(qemu.0.stdout.take().expect("it is piped"));
        Paused::at(&debugger).paint_between(bottom, top);
        let mut printed = Vec::new();
        loop {
            let line = lines.recv_timeout(PATIENCE);
            let line = line.unwrap_or_else(|_| panic!("{}: no end after {:#?}", self.core, printed.last()));
            if line == "end" {
                break;
            }
            printed.push(line);
        }
        let stack = u64::from(top - Paused::at(&debugger).lowest_used_from(bottom));
        let _ = std::fs::remove_dir_all(&sockets);
        Printed { lines: printed, stack }
    }
}

/// Ends QEMU when it is dropped.
struct Ending(Child);

impl Drop for Ending {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Reads lines on a thread of its own, so that waiting for them can end.
fn lines(output: ChildStdout) -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        BufReader::new(output).lines().map_while(Result::ok).try_for_each(|line| sender.send(line))
    });
    receiver
}
