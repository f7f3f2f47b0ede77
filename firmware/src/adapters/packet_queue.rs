//! A queue of received frames.

use super::packet_error::{PacketCounters, PacketError, without_padding};
use heapless::Deque;
use iibt_core::team::{Deframer, MAX_PACKET};

/// A queue of received packets, which take a byte more than they have, in `N` bytes; the oldest
/// give way to new ones.
///
/// Put it between a receiver, an interrupt or a task, and a robot that listens once a tick. What
/// does not have the [form](iibt_core::team::check_form) of one frame stays out and is counted. So
/// traffic of others and noise do not displace what teammates send: random bytes pass once in some
/// hundred thousand times. A message replaces those before it, so the newest packets are the ones
/// to keep.
///
/// ```
/// use firmware::adapters::{PacketError, PacketQueue};
///
/// let frame = |last| [12, 2, 1, 1, 1, 1, 9, 9, 9, 9, 9, last];
/// let mut queue = PacketQueue::<130>::new(); // room for ten packets of twelve bytes
/// assert_eq!(queue.push(b"hello"), Err(PacketError::Form));
/// (1..=11).for_each(|last| queue.push(&frame(last)).unwrap());
/// assert_eq!(queue.displaced(), 1);
///
/// let mut packet = [0; 127];
/// assert_eq!(queue.pop(&mut packet), Some(12));
/// assert_eq!(packet[..12], frame(2));
/// ```
#[derive(Debug)]
pub struct PacketQueue<const N: usize> {
    bytes: Deque<u8, N>,
    counters: PacketCounters,
    displaced: u32,
}

impl<const N: usize> PacketQueue<N> {
    /// A queue without packets. One that is too small for the longest frame fails the build.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(N > MAX_PACKET, "the longest frame does not fit the queue") }
        Self { bytes: Deque::new(), counters: PacketCounters::NONE, displaced: 0 }
    }

    /// Adds a packet, and drops the oldest as long as there is no room for it.
    ///
    /// # Errors
    /// The [`PacketError`] that tells why the packet is no frame.
    pub fn push(&mut self, packet: &[u8]) -> Result<(), PacketError> {
        let packet = without_padding(packet);
        self.counters.check(packet)?;
        while N - self.bytes.len() <= packet.len() && self.drop_oldest() {}
        // There is room, and no packet that passes is longer than a byte can say.
        let _ = self.bytes.push_back(packet.len() as u8);
        packet.iter().for_each(|&byte| self.bytes.push_back(byte).unwrap_or_default());
        Ok(())
    }

    /// Moves the oldest packet to the front of `packet`, as much of it as fits; returns its length.
    pub fn pop(&mut self, packet: &mut [u8]) -> Option<usize> {
        let length = usize::from(self.bytes.pop_front()?);
        for at in 0..length {
            let byte = self.bytes.pop_front();
            if let (Some(byte), Some(place)) = (byte, packet.get_mut(at)) {
                *place = byte;
            }
        }
        Some(length)
    }

    /// Returns the counts of packets taken and refused since the start.
    #[must_use]
    pub const fn counters(&self) -> &PacketCounters {
        &self.counters
    }

    /// Returns the number of packets that gave way to newer ones since the start.
    #[must_use]
    pub const fn displaced(&self) -> u32 {
        self.displaced
    }

    fn drop_oldest(&mut self) -> bool {
        let dropped = self.pop(&mut []).is_some();
        self.displaced = self.displaced.saturating_add(dropped.into());
        dropped
    }
}

impl<const N: usize> Default for PacketQueue<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A [`PacketQueue`] for a stream of bytes, which it cuts into frames as they come.
///
/// A robot that listens to it has the frames of its teammates however much noise the line carries
/// between two ticks; in a queue of bytes, noise takes the room of frames.
///
/// ```
/// use firmware::adapters::FrameInbox;
///
/// let mut inbox = FrameInbox::<512>::new();
/// inbox.feed(&[7, 7, 7]); // noise
/// inbox.feed(&[0, 12, 2, 1, 1, 1, 1, 9]); // a frame comes in two parts
/// inbox.feed(&[9, 9, 9, 9, 9, 0]);
/// assert_eq!(inbox.packets.pop(&mut [0; 127]), Some(12));
/// assert_eq!(inbox.packets.counters().form, 1);
/// ```
#[derive(Debug, Default)]
pub struct FrameInbox<const N: usize> {
    deframer: Deframer,
    /// The frames that came.
    pub packets: PacketQueue<N>,
}

impl<const N: usize> FrameInbox<N> {
    /// An inbox that has received nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { deframer: Deframer::new(), packets: PacketQueue::new() }
    }

    /// Takes received bytes.
    pub fn feed(&mut self, mut bytes: &[u8]) {
        while let Some(frame) = self.deframer.take(&mut bytes) {
            // The queue counts what it refuses.
            let _ = self.packets.push(frame);
        }
    }

    /// Returns the number of runs of bytes that were too long for a frame.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        self.deframer.dropped()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;
    use std::vec::Vec;

    /// A packet with the form of a frame.
    fn frame(length: usize, byte: u8) -> Vec<u8> {
        let mut frame = std::vec![byte; length];
        (frame[0], frame[1]) = (length as u8, 2);
        frame
    }

    #[test]
    fn keeps_the_newest_packets_whole_and_in_order() {
        let (mut queue, mut expected) = (PacketQueue::<300>::new(), VecDeque::new());
        let mut random = 1_u32;
        for _ in 0..20_000 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let length = 11 + (random >> 16) as usize % 115;
            if random >> 30 > 0 {
                let new = frame(length, (random >> 8) as u8 | 1);
                assert_eq!(queue.push(&new), Ok(()));
                expected.push_back(new);
                while expected.iter().map(|packet: &Vec<u8>| packet.len() + 1).sum::<usize>() > 300 {
                    expected.pop_front();
                }
            } else {
                let mut packet = [0; 127];
                let popped = queue.pop(&mut packet).map(|length| packet[..length].to_vec());
                assert_eq!(popped, expected.pop_front());
            }
        }
        assert!(queue.displaced() > 1_000);
    }

    #[test]
    fn refuses_by_name_what_is_not_one_frame() {
        let mut queue = PacketQueue::<300>::new();
        let two = [&frame(20, 5)[..], &[0], &frame(20, 5)].concat();
        let delimited = [&[0], &frame(20, 5)[..], &[0]].concat();
        let other_version = [&[20, 3][..], &frame(20, 5)[2..]].concat();
        for (packet, error) in [
            (&frame(126, 5), PacketError::TooLong),
            (&frame(250, 5), PacketError::TooLong),
            (&Vec::new(), PacketError::TooShort),
            (&frame(10, 5), PacketError::TooShort),
            (&two, PacketError::Delimiter),
            (&delimited, PacketError::Delimiter),
            (&frame(20, 5)[1..].to_vec(), PacketError::Form),
            (&other_version, PacketError::Form),
        ] {
            assert_eq!(queue.push(packet), Err(error), "{packet:?}");
        }
        let expected = PacketCounters { taken: 0, too_long: 2, too_short: 2, delimiter: 2, form: 2 };
        assert_eq!((*queue.counters(), queue.counters().refused()), (expected, 8));
        assert_eq!(queue.pop(&mut [0; 127]), None);
        assert_eq!(queue.push(&frame(125, 5)), Ok(()));
        assert_eq!(queue.push(&frame(11, 5)), Ok(()));
    }
}
