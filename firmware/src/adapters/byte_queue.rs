//! A queue of received bytes.

/// A queue of at most `N` bytes, written byte by byte and read many at a time.
///
/// ```
/// use firmware::adapters::ByteQueue;
///
/// let mut queue = ByteQueue::<4>::new();
/// assert!([1, 2, 3, 4].map(|byte| queue.push(byte)) == [true; 4] && !queue.push(5));
/// let mut bytes = [0; 3];
/// assert_eq!((queue.read(&mut bytes), bytes), (3, [1, 2, 3]));
/// assert!(queue.push(6) && queue.push(7));
/// assert_eq!((queue.read(&mut bytes), bytes), (3, [4, 6, 7]));
/// assert_eq!(queue.read(&mut bytes), 0);
/// ```
#[derive(Clone, Debug)]
pub struct ByteQueue<const N: usize> {
    bytes: [u8; N],
    first: usize,
    length: usize,
}

impl<const N: usize> ByteQueue<N> {
    /// Returns a queue without bytes.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: [0; N], first: 0, length: 0 }
    }

    /// Returns the number of bytes.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.length
    }

    /// Returns whether there is no byte.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }

    /// Adds a byte; returns whether there was room for it.
    pub fn push(&mut self, byte: u8) -> bool {
        let end = self.first + self.length;
        let place = self.bytes.get_mut(if end < N { end } else { end - N }).filter(|_| self.length < N);
        place.is_some_and(|place| {
            *place = byte;
            self.length += 1;
            true
        })
    }

    /// Takes the oldest bytes, as many as there are and fit; returns how many.
    pub fn read(&mut self, to: &mut [u8]) -> usize {
        let before_the_wrap = self.read_run(to);
        before_the_wrap + self.read_run(to.get_mut(before_the_wrap..).unwrap_or_default())
    }

    /// The same up to the end of the memory, where the queue wraps around.
    fn read_run(&mut self, to: &mut [u8]) -> usize {
        let run = self.bytes.get(self.first..).unwrap_or_default();
        let count = run.len().min(self.length).min(to.len());
        to.iter_mut().zip(run).take(count).for_each(|(to, &byte)| *to = byte);
        self.first = if self.first + count < N { self.first + count } else { 0 };
        self.length -= count;
        count
    }
}

impl<const N: usize> Default for ByteQueue<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;

    #[test]
    fn gives_what_a_queue_of_any_length_gives_around_the_wrap() {
        let (mut queue, mut expected) = (ByteQueue::<7>::new(), VecDeque::new());
        let mut random = 1_u32;
        for _ in 0..20_000 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let byte = (random >> 24) as u8;
            if random >> 31 == 0 {
                let has_room = expected.len() < 7;
                assert_eq!(queue.push(byte), has_room);
                expected.extend(Some(byte).filter(|_| has_room));
            } else {
                let mut bytes = [0; 5];
                let wanted = usize::from(byte % 6);
                let count = queue.read(&mut bytes[..wanted]);
                assert!(bytes[..count].iter().copied().eq(expected.drain(..wanted.min(expected.len()))));
            }
        }
    }
}
