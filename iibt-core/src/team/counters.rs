//! Counts of the frames that a roster received.

use super::{DecodeError, Heard, Refused};

/// The number of frames accepted, and of frames refused for each reason. Every count stops at the
/// largest number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Frames accepted into the roster.
    pub accepted: u32,
    /// [`DecodeError::TooLong`].
    pub too_long: u32,
    /// [`DecodeError::Cobs`].
    pub cobs: u32,
    /// [`DecodeError::TooShort`].
    pub too_short: u32,
    /// [`DecodeError::Version`].
    pub version: u32,
    /// [`DecodeError::Tag`].
    pub tag: u32,
    /// [`DecodeError::Body`] and [`DecodeError::Trailing`].
    pub body: u32,
    /// [`DecodeError::Sender`] and [`DecodeError::Invalid`].
    pub invalid: u32,
    /// [`Refused::Own`].
    pub own: u32,
    /// [`Refused::Twin`].
    pub twin: u32,
    /// [`Refused::Unknown`].
    pub unknown: u32,
    /// [`Refused::Foreign`].
    pub foreign: u32,
    /// [`Refused::Duplicate`].
    pub duplicate: u32,
    /// [`Refused::Outdated`].
    pub outdated: u32,
}

impl Counters {
    pub(super) const NONE: Self = Self {
        accepted: 0,
        too_long: 0,
        cobs: 0,
        too_short: 0,
        version: 0,
        tag: 0,
        body: 0,
        invalid: 0,
        own: 0,
        twin: 0,
        unknown: 0,
        foreign: 0,
        duplicate: 0,
        outdated: 0,
    };

    /// The number of refused frames, for all reasons together.
    #[must_use]
    pub fn refused(&self) -> u32 {
        let decoding =
            [self.too_long, self.cobs, self.too_short, self.version, self.tag, self.body, self.invalid];
        let hearing = [self.own, self.twin, self.unknown, self.foreign, self.duplicate, self.outdated];
        decoding.into_iter().chain(hearing).fold(0, u32::saturating_add)
    }

    pub(super) fn count(&mut self, outcome: Result<Heard, Refused>) {
        let counter = self.counter(outcome);
        *counter = counter.saturating_add(1);
    }

    fn counter(&mut self, outcome: Result<Heard, Refused>) -> &mut u32 {
        match outcome {
            Ok(_) => &mut self.accepted,
            Err(Refused::Frame(error)) => self.decoding(error),
            Err(Refused::Own) => &mut self.own,
            Err(Refused::Twin) => &mut self.twin,
            Err(Refused::Unknown) => &mut self.unknown,
            Err(Refused::Foreign(_)) => &mut self.foreign,
            Err(Refused::Duplicate) => &mut self.duplicate,
            Err(Refused::Outdated) => &mut self.outdated,
        }
    }

    fn decoding(&mut self, error: DecodeError) -> &mut u32 {
        match error {
            DecodeError::TooLong => &mut self.too_long,
            DecodeError::Cobs => &mut self.cobs,
            DecodeError::TooShort => &mut self.too_short,
            DecodeError::Version(_) => &mut self.version,
            DecodeError::Tag => &mut self.tag,
            DecodeError::Body | DecodeError::Trailing => &mut self.body,
            DecodeError::Sender | DecodeError::Invalid(_) => &mut self.invalid,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team::Invalid;

    #[test]
    fn counts_every_reason_once() {
        let reasons = [
            Refused::Frame(DecodeError::TooLong),
            Refused::Frame(DecodeError::Cobs),
            Refused::Frame(DecodeError::TooShort),
            Refused::Frame(DecodeError::Version(0)),
            Refused::Frame(DecodeError::Tag),
            Refused::Frame(DecodeError::Body),
            Refused::Frame(DecodeError::Invalid(Invalid(""))),
            Refused::Own,
            Refused::Twin,
            Refused::Unknown,
            Refused::Foreign(Invalid("")),
            Refused::Duplicate,
            Refused::Outdated,
        ];
        let mut counters = Counters::default();
        for reason in reasons {
            counters.count(Err(reason));
        }
        counters.count(Ok(Heard::First));
        let expected = Counters {
            accepted: 1,
            too_long: 1,
            cobs: 1,
            too_short: 1,
            version: 1,
            tag: 1,
            body: 1,
            invalid: 1,
            own: 1,
            twin: 1,
            unknown: 1,
            foreign: 1,
            duplicate: 1,
            outdated: 1,
        };
        assert_eq!(counters, expected);
        assert_eq!(counters.refused(), 13);
    }

    #[test]
    fn stays_at_the_largest_number() {
        let mut counters = Counters { tag: u32::MAX, own: 1, ..Counters::default() };
        counters.count(Err(Refused::Frame(DecodeError::Tag)));
        assert_eq!(counters.tag, u32::MAX);
        assert_eq!(counters.refused(), u32::MAX);
    }
}
