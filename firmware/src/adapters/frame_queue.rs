//! A queue of bytes for whole frames.

use heapless::Deque;

/// A queue of at most `N` bytes for a port, written frame by frame and read byte by byte.
///
/// A frame that does not fit is refused as a whole and counted: the far end never sees half of one.
/// Bytes of a frame that is still being written cannot be read.
///
/// ```
/// use firmware::adapters::FrameQueue;
///
/// let mut queue = FrameQueue::<4>::new();
/// assert!(queue.push(&[1, 2, 3]));
/// assert!(!queue.push(&[4, 5])); // no room for both bytes: refused as a whole
/// assert_eq!(queue.refused(), 1);
/// assert_eq!(queue.pop(), Some(1));
/// assert!(queue.push(&[4, 5]));
/// let rest: Vec<u8> = core::iter::from_fn(|| queue.pop()).collect();
/// assert_eq!(rest, [2, 3, 4, 5]);
/// ```
#[derive(Debug)]
pub struct FrameQueue<const N: usize> {
    bytes: Deque<u8, N>,
    open: usize,
    overflowed: bool,
    refused: u32,
}

impl<const N: usize> FrameQueue<N> {
    /// A queue without frames.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: Deque::new(), open: 0, overflowed: false, refused: 0 }
    }

    /// Adds one frame; returns whether it fitted.
    pub fn push(&mut self, frame: &[u8]) -> bool {
        self.extend(frame);
        self.finish()
    }

    /// Adds bytes to the frame that is being written, and begins one if there is none.
    pub fn extend(&mut self, part: &[u8]) {
        for &byte in part {
            self.overflowed |= self.overflowed || self.bytes.push_back(byte).is_err();
            self.open += usize::from(!self.overflowed);
        }
    }

    /// Ends the frame that is being written; returns whether it fitted.
    pub fn finish(&mut self) -> bool {
        let fitted = !core::mem::take(&mut self.overflowed);
        if !fitted {
            self.refused = self.refused.saturating_add(1);
            while self.open > 0 && self.bytes.pop_back().is_some() {
                self.open -= 1;
            }
        }
        self.open = 0;
        fitted
    }

    /// Takes the oldest byte of the finished frames.
    pub fn pop(&mut self) -> Option<u8> {
        if self.bytes.len() > self.open { self.bytes.pop_front() } else { None }
    }

    /// Returns how many more bytes fit.
    #[must_use]
    pub fn room(&self) -> usize {
        N.saturating_sub(self.bytes.len())
    }

    /// Returns bytes of the finished frames from the oldest on, all that lie in one piece; none if
    /// there are none.
    #[must_use]
    pub fn front(&self) -> &[u8] {
        let finished = self.bytes.len() - self.open;
        let (front, _) = self.bytes.as_slices();
        front.get(..finished).unwrap_or(front)
    }

    /// Drops the oldest `count` bytes of the finished frames, which have been sent.
    pub fn consume(&mut self, count: usize) {
        (0..count).for_each(|_| {
            self.pop();
        });
    }

    /// Returns the number of refused frames since the start.
    #[must_use]
    pub const fn refused(&self) -> u32 {
        self.refused
    }
}

impl<const N: usize> Default for FrameQueue<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn drain<const N: usize>(queue: &mut FrameQueue<N>) -> Vec<u8> {
        core::iter::from_fn(|| queue.pop()).collect()
    }

    #[test]
    fn gives_back_frames_in_order() {
        let mut queue = FrameQueue::<8>::new();
        assert!(queue.push(&[1, 2, 3]));
        assert!(queue.push(&[4]));
        assert_eq!(drain(&mut queue), [1, 2, 3, 4]);
    }

    #[test]
    fn refuses_a_frame_as_a_whole() {
        let mut queue = FrameQueue::<4>::new();
        assert!(queue.push(&[1, 2, 3]));
        assert!(!queue.push(&[4, 5]));
        assert_eq!((queue.refused(), queue.room()), (1, 1));
        assert!(queue.push(&[6]));
        assert_eq!(drain(&mut queue), [1, 2, 3, 6]);
    }

    #[test]
    fn a_late_part_that_would_fit_does_not_save_a_frame() {
        let mut queue = FrameQueue::<2>::new();
        queue.extend(&[1, 2, 3]);
        assert_eq!(queue.pop(), None);
        queue.extend(&[]);
        queue.extend(&[4]);
        assert!(!queue.finish());
        assert_eq!(drain(&mut queue), []);
    }

    #[test]
    fn gives_what_lies_in_one_piece_around_the_wrap() {
        let (mut queue, mut sent) = (FrameQueue::<7>::new(), Vec::<u8>::new());
        for frame in 0..50 {
            assert!(queue.push(&[frame; 4]));
            while !queue.front().is_empty() {
                let count = queue.front().len().min(3);
                sent.extend(&queue.front()[..count]);
                queue.consume(count);
            }
        }
        assert!(sent.iter().copied().eq((0..50).flat_map(|frame| [frame; 4])));
    }

    #[test]
    fn an_open_frame_cannot_be_read() {
        let mut queue = FrameQueue::<4>::new();
        queue.extend(&[1]);
        assert_eq!((queue.pop(), queue.front()), (None, &[][..]));
        assert!(queue.finish());
        assert_eq!(queue.pop(), Some(1));
    }
}
