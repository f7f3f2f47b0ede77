//! A board of one's own: the MPS2 with the image AN386, which QEMU has, and for which there is no
//! HAL.
#![no_std]
#![no_main]

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use firmware::board::{self, Disturbed, Irq, Line, LogPort, Port, systick::Milliseconds};
use firmware::{adapters::Absent, page::Slots, team_member};

/// A UART of the chip, by its number.
struct Uart(u16);

impl Uart {
    /// Data, state, control, interrupts to clear, divider of the baud rate.
    fn register(&self, index: usize) -> &AtomicU32 {
        unsafe { AtomicU32::from_ptr((0x4000_4000 + 0x1000 * usize::from(self.0) + 4 * index) as *mut u32) }
    }
}

impl Port for Uart {
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        (self.register(1).load(Relaxed) & 2 != 0).then(|| Ok(self.register(0).load(Relaxed) as u8))
    }
    fn has_room(&mut self) -> bool {
        self.register(1).load(Relaxed) & 1 == 0
    }
    fn write(&mut self, byte: u8) {
        self.register(0).store(byte.into(), Relaxed);
    }
    fn ask_for_room(&mut self, asks: bool) {
        self.register(2).store(if asks { 0b1111 } else { 0b1011 }, Relaxed);
    }
    fn pend(&mut self) {
        Irq(2 * self.0).pend();
    }
}

static LOG: LogPort<Uart> = LogPort::new();
static LINK: Line<Uart> = Line::new();
static MEMORY: team_member::Memory<&Line<Uart>, Milliseconds, Absent, Absent> = team_member::Memory::new();

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(_: i16) {
    (0..2).for_each(|uart| Uart(uart).register(3).store(3, Relaxed));
    LOG.serve();
    LINK.serve();
}

#[board::entry]
fn main() -> ! {
    let Some(core) = cortex_m::Peripherals::take() else { board::restart() };
    let clock = Milliseconds::start(core.SYST, 25_000);
    (0..2).for_each(|uart| Uart(uart).register(4).store(217, Relaxed));
    (0..2).for_each(|uart| Uart(uart).ask_for_room(false));
    LOG.start(Uart(0));
    board::begin(|| {}, false);
    (0..4).for_each(|interrupt| board::enable(Irq(interrupt)));
    let mut storage = unsafe { board::mapped(0, 4 << 20, Slots { first: 0x20_0000, second: 0x20_2000 }) };
    let started = MEMORY.start(LINK.start(Uart(1)), clock, |_| Absent, Absent, &mut storage);
    board::run(started, Absent, || clock.cycles())
}
