//! A link over a radio that sends and receives whole packets.

use super::packet_error::{PacketCounters, without_padding};
use crate::hardware::Link;

/// The driver of a radio that broadcasts packets of up to
/// [`MAX_PACKET`](iibt_core::team::MAX_PACKET) bytes and receives those of others: ESP-NOW, IEEE
/// 802.15.4, nRF ESB, CAN-FD.
///
/// Neither call waits. The radio needs no acknowledgements and no order: every frame is complete,
/// authenticated and numbered.
pub trait PacketRadio {
    /// The reason why a packet was not sent.
    type Error;

    /// Hands a packet to the radio, which broadcasts it as soon as the channel is free.
    ///
    /// # Errors
    /// The radio's own, when it does not take the packet: its queue is full, or it is off.
    fn send(&mut self, packet: &[u8]) -> Result<(), Self::Error>;

    /// Moves the next received packet to the front of `packet`; returns its length, or `None` if
    /// there is none.
    ///
    /// A packet that is longer than `packet` may be cut off: no frame is as long as `packet`.
    fn receive(&mut self, packet: &mut [u8]) -> Option<usize>;
}

/// A radio of two closures, one that sends and one that receives.
impl<S, E, R> PacketRadio for (S, R)
where
    S: FnMut(&[u8]) -> Result<(), E>,
    R: FnMut(&mut [u8]) -> Option<usize>,
{
    type Error = E;

    fn send(&mut self, packet: &[u8]) -> Result<(), E> {
        (self.0)(packet)
    }

    fn receive(&mut self, packet: &mut [u8]) -> Option<usize> {
        (self.1)(packet)
    }
}

/// A [`Link`] over a [`PacketRadio`]: each packet is one frame without its delimiters.
///
/// A packet that is too long, too short, or more than one frame is refused and
/// [counted](Self::counters) by its name. Zeros at the end of a packet are padding, as CAN-FD has
/// it. The controller takes at most 16 packets a tick, so a
/// radio on a busy channel puts a [`PacketQueue`](super::PacketQueue) between its interrupt and
/// this.
///
/// ```
/// use firmware::adapters::PacketLink;
/// use firmware::hardware::Link;
/// use std::cell::RefCell;
/// use std::collections::VecDeque;
///
/// // What a driver has: a queue in each direction, and calls that do not wait.
/// let (air, heard) = (RefCell::new(Vec::new()), RefCell::new(VecDeque::<Vec<u8>>::new()));
/// let send = |packet: &[u8]| -> Result<(), &str> {
///     air.borrow_mut().push(packet.to_vec());
///     Ok(())
/// };
/// let receive = |packet: &mut [u8]| {
///     let next = heard.borrow_mut().pop_front()?;
///     packet[..next.len()].copy_from_slice(&next);
///     Some(next.len())
/// };
/// let mut link = PacketLink::new((send, receive));
///
/// let frame = [0, 12, 2, 1, 1, 1, 1, 9, 9, 9, 9, 9, 9, 0]; // of the controller, with delimiters
/// assert!(link.send(&frame));
/// assert_eq!(air.borrow()[0], frame[1..13]);
///
/// heard.borrow_mut().extend([frame[1..].to_vec(), frame.to_vec()]);
/// let mut packet = [0; 127];
/// assert_eq!(link.receive_packet(&mut packet), Some(12));
/// assert_eq!(link.receive_packet(&mut packet), Some(0)); // refused: it begins with a delimiter
/// assert_eq!(link.receive_packet(&mut packet), None);
/// assert_eq!(link.counters().delimiter, 1);
/// ```
#[derive(Clone, Debug)]
pub struct PacketLink<R> {
    /// The radio.
    pub radio: R,
    counters: PacketCounters,
}

impl<R> PacketLink<R> {
    /// Creates a link over a radio.
    pub const fn new(radio: R) -> Self {
        Self { radio, counters: PacketCounters::NONE }
    }

    /// Returns the counts of received packets, taken and refused. Packets that the radio does not
    /// send are counted by the controller.
    #[must_use]
    pub const fn counters(&self) -> &PacketCounters {
        &self.counters
    }
}

impl<R: PacketRadio> Link for PacketLink<R> {
    fn receive(&mut self) -> Option<u8> {
        None
    }

    fn receive_packet(&mut self, packet: &mut [u8]) -> Option<usize> {
        let length = self.radio.receive(packet)?;
        let received = without_padding(packet.get(..length).unwrap_or(packet));
        Some(if self.counters.check(received).is_ok() { received.len() } else { 0 })
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        let [0, packet @ .., 0] = frame else { return false };
        self.radio.send(packet).is_ok()
    }
}
