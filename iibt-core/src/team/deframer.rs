//! The deframer, which cuts a byte stream into frames.

use super::MAX_FRAME;

/// Collects bytes up to the next delimiter (0x00).
///
/// Noise ends at the next delimiter, wherever the receiver came in. Every frame begins with a
/// delimiter, so noise between two frames spoils neither. What is longer than a frame can be is
/// dropped as it comes and counted. A byte costs constant time; how many bytes to feed in a tick is
/// the caller's bound on its work.
///
/// ```
/// use iibt_core::team::Deframer;
///
/// let mut deframer = Deframer::new();
/// let line = [7, 9, 0, 1, 2, 0]; // noise, a delimiter, two bytes, a delimiter
/// let frames: Vec<Vec<u8>> =
///     line.iter().filter_map(|&byte| deframer.feed(byte).map(<[u8]>::to_vec)).collect();
/// assert_eq!(frames, [vec![7, 9], vec![1, 2]]); // the decoder rejects the noise
/// assert_eq!(deframer.dropped(), 0);
/// ```
#[doc(alias = "COBS")]
#[doc(alias = "framing")]
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Deframer {
    buffer: [u8; MAX_FRAME - 2],
    length: usize,
    overlong: bool,
    dropped: u32,
}

impl Deframer {
    /// A deframer that has received nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; MAX_FRAME - 2], length: 0, overlong: false, dropped: 0 }
    }

    /// Takes one byte; at a delimiter, returns the bytes since the last one, without delimiters,
    /// unless they are none or too many for a frame.
    pub fn feed(&mut self, byte: u8) -> Option<&[u8]> {
        self.take(&mut &[byte][..])
    }

    /// Takes bytes from the front of `bytes` up to a delimiter at which [`feed`](Self::feed)
    /// returns a frame, and returns that; or all of them.
    ///
    /// ```
    /// use iibt_core::team::Deframer;
    ///
    /// let (mut deframer, mut bytes) = (Deframer::new(), &[1, 2, 0, 0, 3, 0, 4][..]);
    /// assert_eq!(deframer.take(&mut bytes), Some(&[1, 2][..]));
    /// assert_eq!(deframer.take(&mut bytes), Some(&[3][..]));
    /// assert_eq!((deframer.take(&mut bytes), bytes), (None, &[][..]));
    /// ```
    pub fn take(&mut self, bytes: &mut &[u8]) -> Option<&[u8]> {
        while let Some(end) = bytes.iter().position(|&byte| byte == 0) {
            let (run, rest) = bytes.split_at_checked(end)?;
            *bytes = rest.get(1..).unwrap_or_default();
            self.push(run);
            if let Some(length) = self.cut() {
                return self.buffer.get(..length);
            }
        }
        self.push(core::mem::take(bytes));
        None
    }

    /// The number of dropped stretches that were too long for a frame; saturates at the largest
    /// number.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }

    fn push(&mut self, run: &[u8]) {
        let room = self.buffer.get_mut(self.length..).unwrap_or_default();
        self.overlong |= run.len() > room.len();
        self.length += run.len().min(room.len());
        room.iter_mut().zip(run).for_each(|(place, &byte)| *place = byte);
    }

    /// The length of what a delimiter ends, unless it is nothing or too long.
    fn cut(&mut self) -> Option<usize> {
        let length = core::mem::take(&mut self.length);
        let is_overlong = core::mem::take(&mut self.overlong);
        self.dropped = self.dropped.saturating_add(is_overlong.into());
        Some(length).filter(|&length| length > 0 && !is_overlong)
    }
}

impl Default for Deframer {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn frames(deframer: &mut Deframer, stream: &[u8]) -> Vec<Vec<u8>> {
        stream.iter().filter_map(|&byte| deframer.feed(byte).map(<[u8]>::to_vec)).collect()
    }

    #[test]
    fn cuts_at_delimiters() {
        let mut deframer = Deframer::new();
        assert_eq!(frames(&mut deframer, &[1, 2, 0, 3, 0, 0, 0, 4]), [std::vec![1, 2], std::vec![3]]);
        assert_eq!(frames(&mut deframer, &[5, 0]), [[4, 5]]);
    }

    #[test]
    fn drops_and_counts_what_is_too_long() {
        let mut deframer = Deframer::new();
        let longest = [7; MAX_FRAME - 2];
        for (extra, kept, dropped) in [(0, 1, 0), (1, 0, 1), (1000, 0, 2)] {
            let stream = [&longest[..], &std::vec![9; extra], &[0]].concat();
            assert_eq!(frames(&mut deframer, &stream).len(), kept, "{extra} bytes too long");
            assert_eq!(deframer.dropped(), dropped);
        }
        assert_eq!(frames(&mut deframer, &[1, 2, 0]), [[1, 2]], "and goes on");
    }
    #[test]
    fn runs_of_any_length_are_cut_as_single_bytes_are() {
        let mut random = 1_u32;
        let mut draw = |below: u32| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 16) % below
        };
        let mut byte = |_| {
            let one_in = [60, 260][draw(2) as usize];
            if draw(one_in) == 0 { 0 } else { 1 + draw(255) as u8 }
        };
        let stream: Vec<u8> = (0..60_000).map(&mut byte).collect();
        let (mut by_bytes, mut by_runs) = (Deframer::new(), Deframer::new());
        let expected = frames(&mut by_bytes, &stream);
        let (mut rest, mut cut) = (&stream[..], Vec::new());
        while !rest.is_empty() {
            let (mut run, others) = rest.split_at(rest.len().min(draw(300) as usize));
            rest = others;
            while let Some(frame) = by_runs.take(&mut run) {
                cut.push(frame.to_vec());
            }
            assert!(run.is_empty());
        }
        assert_eq!((cut.len(), by_runs.dropped()), (expected.len(), by_bytes.dropped()));
        assert!(cut == expected && by_runs.dropped() > 20 && cut.len() > 200);
    }
}
