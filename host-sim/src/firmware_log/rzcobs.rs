//! Reverse zero-compressing COBS: the form in which defmt frames contain no zero.

/// Decodes a frame without the zero at its end; `None` when bytes are missing. Up to six zeros may
/// follow what was encoded.
///
/// A frame is read from its end. A code of 1 to 127 stands for seven bytes, and tells which of them
/// are zeros; 128 to 254 for 7 to 133 bytes and a zero after them; 255 for 134 bytes.
pub(super) fn decode(frame: &[u8]) -> Option<Vec<u8>> {
    let mut rest = frame.iter().rev().copied();
    let mut bytes = Vec::new();
    while let Some(code) = rest.next() {
        match code {
            0 => return None,
            0x01..=0x7f => {
                for bit in (0..7).rev() {
                    bytes.push(if code >> bit & 1 == 1 { 0 } else { rest.next()? });
                }
            }
            0x80..=0xfe => {
                bytes.push(0);
                for _ in 0..(code & 0x7f) + 7 {
                    bytes.push(rest.next()?);
                }
            }
            0xff => {
                for _ in 0..134 {
                    bytes.push(rest.next()?);
                }
            }
        }
    }
    bytes.reverse();
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_decoded_from_their_end() {
        // Seven bytes without a zero would need the code 0, so that there is one more run length.
        assert_eq!(decode(&[1, 2, 3, 4, 5, 6, 0x01]).as_deref(), Some(&[0, 1, 2, 3, 4, 5, 6][..]));
        assert_eq!(decode(&[9, 0x7e]).as_deref(), Some(&[9, 0, 0, 0, 0, 0, 0][..]));
        assert_eq!(decode(&[1, 2, 3, 4, 5, 6, 7, 0x80]).as_deref(), Some(&[1, 2, 3, 4, 5, 6, 7, 0][..]));
        let long = [[7; 134].as_slice(), &[0xff]].concat();
        assert_eq!(decode(&long).as_deref(), Some(&[7; 134][..]));
        assert_eq!(decode(&[]).as_deref(), Some(&[][..]));
    }

    #[test]
    fn a_frame_that_lacks_bytes_is_refused() {
        for frame in [&[0x01][..], &[1, 2, 0x80], &[5, 0xff], &[1, 2, 3, 4, 5, 0x01], &[0]] {
            assert_eq!(decode(frame), None, "{frame:?}");
        }
    }
}
