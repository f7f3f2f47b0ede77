//! Counts of a robot's frames.

use iibt_core::team::Counters;

/// Frames sent and received since the start. Every count stops at the largest number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkReport {
    /// Frames sent.
    pub sent: u32,
    /// Frames that the link did not take, and messages that no frame carries.
    pub unsent: u32,
    /// Runs of bytes that were too long for a frame.
    pub dropped: u32,
    /// The counts of received frames, accepted and refused.
    pub received: Counters,
}
