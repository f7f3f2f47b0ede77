//! The radio of the nRF52840 as a link: one packet of IEEE 802.15.4 is one frame.
//!
//! A packet is a physical one: its length, the frame, and the check sequence of the hardware. It
//! has no header of the MAC layer, for which the longest frame leaves no room; other networks on
//! the channel discard such packets, and this one discards theirs. The robots share one channel,
//! listen before they talk, and try again a few times, a millisecond apart, while it is busy.
//!
//! The driver of the HAL waits while it receives, so this one works by interrupt on the registers.
//!
//! ```text
//!             a packet has come: keep it, listen on
//!              ┌────────┐
//!            ┌─┴────────▼─┐  to send, and no packet is coming   ┌─────────┐
//!  start ───►│ Listening  ├────────────────────────────────────►│ Turning │
//!            └─────▲──────┘                                     └────┬────┘
//!                  │ sent, or the channel is busy: disabled          │ disabled
//!                  │                                            ┌────▼────┐
//!                  └────────────────────────────────────────────┤ Sending │
//!                                                               └─────────┘
//! ```

use super::enable;
use super::shared::{Shared, Slot};
use crate::adapters::{PacketLink, PacketQueue, PacketRadio};
use core::sync::atomic::{AtomicU8, Ordering, compiler_fence};
use iibt_core::team::MAX_PACKET;
use nrf52840_hal::pac::{Interrupt, RADIO, interrupt};

/// The channel, 11 to 26. Those of Wi-Fi reach hardly as far as the last one.
const CHANNEL: u8 = 26;

/// Bytes of received packets that may wait to be read.
const INBOX: usize = 1024;

/// How often a packet is tried to be sent on a busy channel.
const TRIES: u8 = 8;

/// The bytes of the hardware's check sequence, which the length counts and the memory does not
/// have.
const CHECK: usize = 2;

/// What the hardware reads and writes: a length, a packet, and the quality of the link.
type Buffer = [AtomicU8; 1 + MAX_PACKET + CHECK];

static RECEIVED: Buffer = [const { AtomicU8::new(0) }; 1 + MAX_PACKET + CHECK];
static OUTGOING: Buffer = [const { AtomicU8::new(0) }; 1 + MAX_PACKET + CHECK];
static DRIVER: Shared<Slot<Driver>> = Shared::new(Slot::Empty);

/// The link to the teammates.
pub type TeamLink = PacketLink<Antenna>;

/// The radio of the board.
#[derive(Clone, Copy, Debug)]
pub struct Antenna(());

/// The packet before is not sent yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy;

/// Begins to listen. The crystal of 32 MHz must run.
pub(super) fn start(radio: RADIO) -> TeamLink {
    let driver = Driver { radio, state: State::Listening, tries: 0, inbox: PacketQueue::new() };
    driver.set_up();
    driver.listen();
    DRIVER.with(|slot| *slot = Slot::Full(driver));
    enable(Interrupt::RADIO);
    PacketLink::new(Antenna(()))
}

impl PacketRadio for Antenna {
    type Error = Busy;

    fn send(&mut self, packet: &[u8]) -> Result<(), Busy> {
        with_driver(|driver| driver.take(packet)).unwrap_or(Err(Busy))
    }

    fn receive(&mut self, packet: &mut [u8]) -> Option<usize> {
        with_driver(|driver| driver.inbox.pop(packet)).flatten()
    }
}

/// Tries again to send a packet that has found the channel busy. The interrupt of the clock calls
/// this every millisecond.
pub(super) fn try_again() {
    with_driver(Driver::try_again);
}

#[interrupt]
fn RADIO() {
    with_driver(Driver::serve);
}

fn with_driver<T>(act: impl FnOnce(&mut Driver) -> T) -> Option<T> {
    DRIVER.with(|driver| driver.as_mut().map(act)).flatten()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Listening,
    Turning,
    Sending,
}

struct Driver {
    radio: RADIO,
    state: State,
    /// How often the packet in `OUTGOING` may still be tried; zero when there is none.
    tries: u8,
    inbox: PacketQueue<INBOX>,
}

impl Driver {
    /// Sets the mode of IEEE 802.15.4: 250 kbit/s, a length of a byte that counts the check
    /// sequence.
    fn set_up(&self) {
        let radio = &self.radio;
        radio.power.write(|w| w.power().disabled()); // to the values after a reset
        radio.power.write(|w| w.power().enabled());
        radio.mode.write(|w| w.mode().ieee802154_250kbit());
        radio.crccnf.write(|w| w.len().two().skipaddr().ieee802154());
        radio.ccactrl.write(|w| w.ccamode().carrier_mode());
        // SAFETY: the radio is off, and the numbers are those of the standard.
        #[expect(unsafe_code, reason = "the peripheral crate takes any bits")]
        unsafe {
            radio.crcpoly.write(|w| w.crcpoly().bits(0x1_1021));
            radio.crcinit.write(|w| w.crcinit().bits(0));
            radio.pcnf0.write(|w| w.plen()._32bit_zero().crcinc().include().lflen().bits(8));
            radio.pcnf1.write(|w| w.maxlen().bits((MAX_PACKET + CHECK) as u8));
            radio.sfd.write(|w| w.sfd().bits(0xa7));
            radio.frequency.write(|w| w.frequency().bits(5 * (CHANNEL - 10)));
        }
        radio.intenset.write(|w| w.phyend().set().disabled().set());
    }

    /// Receives from now on. The radio is disabled.
    fn listen(&self) {
        self.radio.shorts.write(|w| w.rxready_start().set_bit());
        self.point_at(&RECEIVED);
        self.radio.tasks_rxen.write(|w| w.tasks_rxen().set_bit());
    }

    /// Sends as soon as the channel is found free. The radio is disabled.
    fn transmit(&self) {
        self.radio.shorts.write(|w| {
            w.rxready_ccastart().set_bit().ccaidle_txen().set_bit().txready_start().set_bit();
            w.ccabusy_disable().set_bit().phyend_disable().set_bit()
        });
        self.point_at(&OUTGOING);
        self.radio.tasks_rxen.write(|w| w.tasks_rxen().set_bit());
    }

    fn point_at(&self, buffer: &'static Buffer) {
        self.radio.events_phyend.reset();
        self.radio.events_framestart.reset();
        self.radio.events_ccabusy.reset();
        // SAFETY: the buffer lies in the RAM for ever, is as long as the longest packet, and is
        // looked at only while the hardware does not use it.
        #[expect(unsafe_code, reason = "the peripheral takes an address")]
        self.radio.packetptr.write(|w| unsafe { w.packetptr().bits(buffer.as_ptr() as u32) });
        compiler_fence(Ordering::SeqCst);
    }

    /// Takes a packet to send, unless one waits.
    fn take(&mut self, packet: &[u8]) -> Result<(), Busy> {
        if self.tries > 0 || packet.len() > MAX_PACKET {
            return Err(Busy);
        }
        let length = (packet.len() + CHECK) as u8;
        let bytes = [length].into_iter().chain(packet.iter().copied());
        OUTGOING.iter().zip(bytes).for_each(|(to, byte)| to.store(byte, Ordering::Relaxed));
        self.tries = TRIES;
        self.try_again();
        Ok(())
    }

    /// Turns to sending what waits, unless a packet is coming in: it is received first.
    fn try_again(&mut self) {
        let is_coming = self.radio.events_framestart.read().bits() != 0;
        if self.tries > 0 && self.state == State::Listening && !is_coming {
            self.tries -= 1;
            self.state = State::Turning;
            self.radio.shorts.reset();
            self.radio.tasks_disable.write(|w| w.tasks_disable().set_bit());
        }
    }

    fn serve(&mut self) {
        if self.radio.events_phyend.read().bits() != 0 && self.state == State::Listening {
            self.keep();
            self.point_at(&RECEIVED);
            self.radio.tasks_start.write(|w| w.tasks_start().set_bit());
        }
        self.radio.events_phyend.reset();
        if self.radio.events_disabled.read().bits() != 0 {
            self.radio.events_disabled.reset();
            self.go_on();
        }
    }

    /// What comes after the radio was disabled.
    fn go_on(&mut self) {
        if self.state == State::Turning {
            self.state = State::Sending;
            return self.transmit();
        }
        if self.radio.events_ccabusy.read().bits() == 0 {
            self.tries = 0; // it is sent
        }
        self.state = State::Listening;
        self.listen();
    }

    /// Keeps the packet that has come, if the hardware has found it undamaged.
    fn keep(&mut self) {
        compiler_fence(Ordering::SeqCst);
        let mut bytes = [0; 1 + MAX_PACKET];
        bytes.iter_mut().zip(&RECEIVED).for_each(|(to, byte)| *to = byte.load(Ordering::Relaxed));
        let [length, packet @ ..] = &bytes;
        let length = usize::from(*length).checked_sub(CHECK);
        let packet = length.and_then(|length| packet.get(..length));
        if let Some(packet) = packet.filter(|_| self.radio.crcstatus.read().crcstatus().is_crcok()) {
            // The queue counts what it refuses.
            let _ = self.inbox.push(packet);
        }
    }
}
