//! The first UART of the nRF52840 as the link to the teammates, at 115200 baud.

use super::{Disturbed, Line, Port, enable};
use cortex_m::peripheral::NVIC;
use nrf52840_hal::gpio::{Floating, Input, Output, Pin, PushPull};
use nrf52840_hal::pac::{Interrupt, UART0, interrupt};

/// The link to the teammates.
pub type TeamLink = &'static Line<LinkPort>;

static LINK: Line<LinkPort> = Line::new();

/// Begins to listen and to send.
pub(super) fn start(uart: UART0, txd: &Pin<Output<PushPull>>, rxd: &Pin<Input<Floating>>) -> TeamLink {
    let link = LINK.start(LinkPort::start(uart, txd, rxd));
    enable(Interrupt::UARTE0_UART0);
    link
}

#[interrupt]
fn UARTE0_UART0() {
    LINK.serve();
}

/// The port of the link, which receives and sends byte by byte.
pub struct LinkPort {
    uart: UART0,
    is_sending: bool,
}

impl LinkPort {
    fn start(uart: UART0, txd: &Pin<Output<PushPull>>, rxd: &Pin<Input<Floating>>) -> Self {
        // SAFETY: the numbers are those of pins.
        #[expect(unsafe_code, reason = "the HAL has no driver for this UART")]
        unsafe {
            uart.psel.txd.write(|w| w.bits(txd.psel_bits()));
            uart.psel.rxd.write(|w| w.bits(rxd.psel_bits()));
        }
        uart.baudrate.write(|w| w.baudrate().baud115200());
        uart.intenset.write(|w| w.rxdrdy().set());
        uart.enable.write(|w| w.enable().enabled());
        uart.tasks_starttx.write(|w| w.tasks_starttx().set_bit());
        uart.tasks_startrx.write(|w| w.tasks_startrx().set_bit());
        Self { uart, is_sending: false }
    }
}

impl Port for LinkPort {
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        let uart = &self.uart;
        if uart.events_rxdrdy.read().bits() == 0 {
            return None;
        }
        uart.events_rxdrdy.reset();
        let byte = uart.rxd.read().bits() as u8;
        let errors = uart.errorsrc.read();
        let is_disturbed = errors.bits() != 0;
        uart.errorsrc.write(|w| {
            w.overrun().clear_bit_by_one().framing().clear_bit_by_one().break_().clear_bit_by_one()
        });
        Some(if is_disturbed { Err(Disturbed) } else { Ok(byte) })
    }

    fn has_room(&mut self) -> bool {
        self.is_sending &= self.uart.events_txdrdy.read().bits() == 0;
        !self.is_sending
    }

    fn write(&mut self, byte: u8) {
        self.uart.events_txdrdy.reset();
        // SAFETY: the register takes any byte.
        #[expect(unsafe_code, reason = "the register has no safe way to write a byte")]
        self.uart.txd.write(|w| unsafe { w.txd().bits(byte) });
        self.is_sending = true;
    }

    fn ask_for_room(&mut self, asks: bool) {
        if asks {
            self.uart.intenset.write(|w| w.txdrdy().set());
        } else {
            self.uart.intenclr.write(|w| w.txdrdy().clear());
        }
    }

    fn pend(&mut self) {
        NVIC::pend(Interrupt::UARTE0_UART0);
    }
}
