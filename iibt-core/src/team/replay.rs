//! Replay protection: no frame counts twice, and none counts after a newer one.
//!
//! Frames carry no wall clock, which could be lost or set wrong, but a [`Stamp`]: how often the
//! sender has started, and the number of the frame since. A receiver takes only a stamp newer than
//! the newest it has taken. There is no window for late frames, as other protocols have: a message
//! is complete, so one that was overtaken has no use, and the newest stamp alone is a state
//! that cannot be got wrong.
//!
//! What this does not cover: a receiver that restarts has forgotten the stamps, and takes a
//! recorded frame of a peer until it has heard a newer one from the peer itself. The
//! [rounds](super::rounds) rely on none: a teammate must first
//! [answer](super::rounds::Protocol::has_answered) the new start.

/// The place of a frame in the sender's order: first by epoch, then by sequence. Never wraps.
#[doc(alias = "replay protection")]
#[doc(alias = "anti-replay")]
#[doc(alias = "incarnation")]
#[doc(alias = "boot count")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stamp {
    /// Counts the sender's starts.
    pub epoch: u32,
    /// Counts the sender's frames in this epoch.
    pub sequence: u32,
}

impl Stamp {
    /// The stamp after this one; `None` after the last of the epoch.
    #[must_use]
    pub const fn next(self) -> Option<Self> {
        match self.sequence.checked_add(1) {
            Some(sequence) => Some(Self { sequence, ..self }),
            None => None,
        }
    }
}

/// A sender's stamps, each once, in order.
///
/// The caller counts its starts in memory that survives them and passes the count as the epoch: a
/// sender that starts again with an epoch it had before is taken for a replay. After 2^32 frames
/// (13 years at 10 Hz) the sender is silent until it starts again: in another epoch it would be
/// another life to its team, which has decided with this one. The team goes on without it. Erased
/// flash often reads as `u32::MAX`: as an epoch it would be this sender's last.
///
/// ```
/// use iibt_core::team::{Numbering, Stamp};
///
/// let mut numbering = Numbering::new(2); // the second start of this robot
/// let first = numbering.next_stamp().expect("stamps are left");
/// let second = numbering.next_stamp().expect("stamps are left");
/// assert_eq!(first.epoch, 2);
/// assert!(second > first && first > Stamp { epoch: 1, sequence: 9000 });
/// assert_eq!(Stamp { epoch: 2, sequence: u32::MAX }.next(), None);
/// ```
#[doc(alias = "nonce")]
#[doc(alias = "sequence number")]
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Numbering {
    next: Option<Stamp>,
}

impl Numbering {
    /// The numbering of a sender that has just started for the `epoch`th time.
    #[must_use]
    pub const fn new(epoch: u32) -> Self {
        Self { next: Some(Stamp { epoch, sequence: 0 }) }
    }

    /// Whether all stamps of the epoch are used. The sender takes the next epoch by starting again:
    /// first the count is written, then everything begins in the new epoch alike.
    #[must_use]
    pub const fn is_exhausted(&self) -> bool {
        self.next.is_none()
    }

    /// Uses up all stamps of the epoch but the last `left`; there are never more than before.
    pub const fn use_up(&mut self, left: u32) {
        let Some(next) = self.next else { return };
        self.next = match u32::MAX.checked_sub(left) {
            Some(u32::MAX) => None,
            Some(last) if last.saturating_add(1) > next.sequence => {
                Some(Stamp { sequence: last.saturating_add(1), ..next })
            }
            _ => self.next,
        };
    }

    /// The stamp for the next frame, or `None` when all are used: the sender must fall silent.
    pub fn next_stamp(&mut self) -> Option<Stamp> {
        let stamp = self.next?;
        self.next = stamp.next();
        Some(stamp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn stamp(epoch: u32, sequence: u32) -> Stamp {
        Stamp { epoch, sequence }
    }

    #[test]
    fn a_restart_is_newer_than_everything_before() {
        assert!(stamp(2, 0) > stamp(1, u32::MAX));
        assert!(stamp(1, 1) > stamp(1, 0));
    }

    #[test]
    fn numbers_every_frame_once_and_in_order() {
        let mut numbering = Numbering::new(7);
        for sequence in 0..5 {
            assert_eq!(numbering.next_stamp(), Some(stamp(7, sequence)));
        }
    }

    #[test]
    fn is_silent_after_the_last_number_of_its_epoch() {
        let mut numbering = Numbering::new(7);
        numbering.use_up(1);
        numbering.use_up(2);
        assert!(!numbering.is_exhausted());
        assert_eq!(numbering.next_stamp(), Some(stamp(7, u32::MAX)));
        assert!(numbering.is_exhausted());
        assert_eq!([numbering.next_stamp(), numbering.next_stamp()], [None; 2], "epoch 8 is another start");
        numbering.use_up(9);
        assert!(numbering.is_exhausted());
        let mut other = Numbering::new(7);
        other.use_up(0);
        assert!(other.is_exhausted());
    }
}
