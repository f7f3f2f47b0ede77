//! Packets that are no frames.

use iibt_core::team::{DecodeError, MAX_PACKET, check_form};

/// The reason why a packet is not one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PacketError {
    /// More bytes than the longest frame has.
    #[error("longer than {MAX_PACKET} bytes, the longest frame")]
    TooLong,
    /// Fewer bytes than the shortest frame has.
    #[error("too short for a frame")]
    TooShort,
    /// A delimiter inside: several frames, or one with its delimiters.
    #[error("a delimiter inside: several frames, or one with its delimiters")]
    Delimiter,
    /// Not the form of a frame of this version: a packet of another network, or damaged.
    #[error("not the form of a frame of this version")]
    Form,
}

/// A packet without the zeros at its end, with which CAN-FD fills packets up: no frame ends in one.
pub(super) fn without_padding(packet: &[u8]) -> &[u8] {
    let length = packet.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    packet.get(..length).unwrap_or(packet)
}

/// Checks that a packet has the form of one frame.
fn check(packet: &[u8]) -> Result<(), PacketError> {
    check_form(packet).map_err(|error| match error {
        DecodeError::TooLong => PacketError::TooLong,
        DecodeError::TooShort => PacketError::TooShort,
        DecodeError::Cobs if packet.contains(&0) => PacketError::Delimiter,
        _ => PacketError::Form,
    })
}

/// The number of packets taken, and of those refused for each reason. Every count stops at the
/// largest number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PacketCounters {
    /// Packets that have the form of a frame.
    pub taken: u32,
    /// [`PacketError::TooLong`].
    pub too_long: u32,
    /// [`PacketError::TooShort`].
    pub too_short: u32,
    /// [`PacketError::Delimiter`].
    pub delimiter: u32,
    /// [`PacketError::Form`].
    pub form: u32,
}

impl PacketCounters {
    /// No packets.
    pub const NONE: Self = Self { taken: 0, too_long: 0, too_short: 0, delimiter: 0, form: 0 };

    /// Checks a packet and counts it.
    ///
    /// # Errors
    /// The first [`PacketError`] found.
    pub fn check(&mut self, packet: &[u8]) -> Result<(), PacketError> {
        let checked = check(packet);
        let counter = match checked {
            Ok(()) => &mut self.taken,
            Err(PacketError::TooLong) => &mut self.too_long,
            Err(PacketError::TooShort) => &mut self.too_short,
            Err(PacketError::Delimiter) => &mut self.delimiter,
            Err(PacketError::Form) => &mut self.form,
        };
        *counter = counter.saturating_add(1);
        checked
    }

    /// Returns the number of refused packets, for all reasons together.
    #[must_use]
    pub fn refused(&self) -> u32 {
        [self.too_long, self.too_short, self.delimiter, self.form].into_iter().fold(0, u32::saturating_add)
    }
}
