//! The link to the teammates: USART2, emptied and filled by its interrupt.

use super::serial::{enable, feed};
use super::shared::Shared;
use crate::adapters::{ByteQueue, FrameQueue};
use crate::hardware::Link;
use cortex_m::peripheral::NVIC;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::Read;
use stm32f4xx_hal::interrupt;
use stm32f4xx_hal::pac::{Interrupt, USART2};
use stm32f4xx_hal::serial::{Rx, RxListen, Serial, Tx};

/// Bytes that may wait to be read: 177 ms of a busy line.
const INBOX: usize = 2048;

/// Bytes that may wait to be sent.
const OUTBOX: usize = 512;

// Apart from the port, so that they are all zeros and take no flash.
static QUEUES: Shared<Queues> = Shared::new(Queues::new());
static PORT: Shared<Option<Port>> = Shared::new(None);

/// The [`Link`] over USART2. It never waits: a frame for which there is no room is refused.
#[derive(Debug)]
pub struct TeamLink(());

impl TeamLink {
    pub(super) fn start(serial: Serial<USART2>) -> Self {
        let (tx, mut rx) = serial.split();
        rx.listen();
        PORT.with(|port| *port = Some(Port { rx, tx }));
        enable(Interrupt::USART2);
        Self(())
    }

    /// The number of received bytes lost since the start, to a full queue or a disturbed line.
    #[must_use]
    pub fn lost(&self) -> u32 {
        QUEUES.with(|queues| queues.lost).unwrap_or(0)
    }
}

impl Link for TeamLink {
    fn receive(&mut self) -> Option<u8> {
        let mut byte = [0];
        (self.read(&mut byte) == 1).then_some(byte[0])
    }

    fn read(&mut self, bytes: &mut [u8]) -> usize {
        QUEUES.with(|queues| queues.inbox.read(bytes)).unwrap_or(0)
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let queued = QUEUES.with(|queues| queues.outbox.push(frame)).unwrap_or(false);
        NVIC::pend(Interrupt::USART2);
        queued
    }
}

struct Port {
    rx: Rx<USART2>,
    tx: Tx<USART2>,
}

struct Queues {
    inbox: ByteQueue<INBOX>,
    outbox: FrameQueue<OUTBOX>,
    lost: u32,
}

impl Queues {
    const fn new() -> Self {
        Self { inbox: ByteQueue::new(), outbox: FrameQueue::new(), lost: 0 }
    }

    fn receive(&mut self, rx: &mut Rx<USART2>) {
        let kept = match rx.read() {
            Ok(byte) => self.inbox.push(byte),
            Err(nb::Error::WouldBlock) => true,
            Err(nb::Error::Other(_)) => false,
        };
        self.lost = self.lost.saturating_add(u32::from(!kept));
    }

    fn serve(&mut self, port: &mut Port) {
        self.receive(&mut port.rx);
        feed(&mut port.tx, &mut self.outbox);
    }
}

#[interrupt]
fn USART2() {
    PORT.with(|port| port.as_mut().map(|port| QUEUES.with(|queues| queues.serve(port))));
}
