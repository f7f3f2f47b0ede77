//! The memory of a running image, through the debugger's port of QEMU (the remote protocol of GDB).

use crate::qemu::PATIENCE;
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

/// The lowest address of the stack; see `firmware/boards/stm32f405/memory.x`.
const STACK_END: u32 = 0x2000_0000;

/// What a word of the stack holds that nothing has been written to.
const PAINT: u32 = 0xcccc_cccc;

/// The words that are written or read at a time.
const BLOCK: u32 = 128;

/// A paused image; it runs on when this is dropped.
#[derive(Debug)]
pub struct Paused(UnixStream);

impl Paused {
    /// Pauses the image whose debugger listens at `socket`.
    ///
    /// # Panics
    /// When QEMU does not answer.
    #[must_use]
    pub fn at(socket: &Path) -> Self {
        let started = Instant::now();
        let stream = loop {
            match UnixStream::connect(socket) {
                Ok(stream) => break stream,
                Err(error) => assert!(started.elapsed() < PATIENCE, "{}: {error}", socket.display()),
            }
            std::thread::sleep(Duration::from_millis(1));
        };
        stream.set_read_timeout(Some(PATIENCE)).expect("the time-out is not zero");
        Self(stream)
    }

    /// The stack pointer.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn stack_pointer(&mut self) -> u32 {
        word_at(&self.ask("g"), 13)
    }

    /// Paints the stack below the stack pointer, and returns that.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn paint(&mut self) -> u32 {
        let top = self.stack_pointer();
        self.paint_between(STACK_END, top);
        top
    }

    /// Paints the memory from one address to another.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn paint_between(&mut self, from: u32, top: u32) {
        for at in (from..top).step_by(4 * BLOCK as usize) {
            let words = (top - at).div_ceil(4).min(BLOCK);
            let paint = format!("{:08x}", PAINT.swap_bytes()).repeat(words as usize);
            assert_eq!(self.ask(&format!("M{at:x},{:x}:{paint}", 4 * words)), "OK");
        }
    }

    /// The lowest address of the stack that has been written to since it was painted.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn lowest_used(&mut self) -> u32 {
        self.lowest_used_from(STACK_END)
    }

    /// The same for a stack whose lowest address is `from`.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn lowest_used_from(&mut self, from: u32) -> u32 {
        let mut at = from;
        loop {
            let words = self.ask(&format!("m{at:x},{:x}", 4 * BLOCK));
            if let Some(used) = (0..BLOCK as usize).find(|&word| word_at(&words, word) != PAINT) {
                return at + 4 * used as u32;
            }
            at += 4 * BLOCK;
        }
    }

    /// A word of memory, or a register of a peripheral.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn word(&mut self, address: u32) -> u32 {
        word_at(&self.ask(&format!("m{address:x},4")), 0)
    }

    /// Has the image go on at an address.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn jump(&mut self, address: u32) {
        let mut registers = self.ask("g");
        registers.replace_range(8 * 15..8 * 16, &format!("{:08x}", address.swap_bytes()));
        assert_eq!(self.ask(&format!("G{registers}")), "OK");
    }

    /// Whether the core sleeps until the next interrupt: it is behind a `wfi`.
    ///
    /// # Panics
    /// When QEMU does not answer.
    pub fn is_asleep(&mut self) -> bool {
        let next = word_at(&self.ask("g"), 15);
        self.memory(next.wrapping_sub(2), 2) == [0x30, 0xbf]
    }

    /// Bytes of the memory.
    ///
    /// # Panics
    /// When QEMU does not answer, or there is no such memory.
    pub fn memory(&mut self, at: u32, len: usize) -> Vec<u8> {
        let digits = self.ask(&format!("m{at:x},{len:x}"));
        let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
        let bytes: Option<Vec<u8>> = digits.as_bytes().chunks(2).map(byte).collect();
        bytes.filter(|bytes| bytes.len() == len).unwrap_or_else(|| panic!("{len} bytes at {at:#x}: {digits}"))
    }

    fn ask(&mut self, question: &str) -> String {
        let sum = question.bytes().fold(0_u8, u8::wrapping_add);
        write!(self.0, "${question}#{sum:02x}").expect("QEMU takes the question");
        loop {
            let answer = self.packet();
            // That it has paused, QEMU says without being asked.
            if !answer.starts_with('T') {
                return answer;
            }
        }
    }

    /// What comes between the next dollar sign and the two digits of its sum.
    fn packet(&mut self) -> String {
        let mut answer = Vec::new();
        let mut byte = [0];
        while answer.len() < 4 || answer[answer.len() - 3] != b'#' {
            self.0.read_exact(&mut byte).expect("QEMU answers");
            let is_acknowledgement = answer.is_empty() && byte[0] != b'$';
            answer.extend((!is_acknowledgement).then_some(byte[0]));
        }
        self.0.write_all(b"+").expect("QEMU takes the acknowledgement");
        String::from_utf8_lossy(&answer[1..answer.len() - 3]).into_owned()
    }
}

impl Drop for Paused {
    fn drop(&mut self) {
        let _ = self.0.write_all(b"$D#44");
        let _ = self.0.read(&mut [0; 8]);
    }
}

/// A word of memory in hexadecimal digits, its lowest byte first.
fn word_at(digits: &str, word: usize) -> u32 {
    let digits = digits.get(8 * word..8 * word + 8).and_then(|digits| u32::from_str_radix(digits, 16).ok());
    digits.expect("eight hexadecimal digits").swap_bytes()
}
