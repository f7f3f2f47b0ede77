//! The form of a frame, as far as it shows without a key.

use super::{DecodeError, MAX_FRAME, TAG_BYTES, VERSION};

/// The longest frame in bytes without its delimiters: what one packet carries.
pub const MAX_PACKET: usize = MAX_FRAME - 2;

/// Checks the form of a frame, which is given without its delimiters: length, COBS, version.
///
/// What it refuses [`decode`](super::decode) refuses for the same reason. It needs no key, no
/// memory and one look at each byte, so that an interrupt can keep noise out of a queue.
///
/// ```
/// use iibt_core::team::{DecodeError, check_form};
///
/// let frame = [13, 2, 1, 1, 1, 1, 9, 9, 9, 9, 9, 9, 9]; // the tag is not looked at
/// assert_eq!(check_form(&frame), Ok(()));
/// assert_eq!(check_form(&frame[1..]), Err(DecodeError::Cobs));
/// assert_eq!(check_form(&[1]), Err(DecodeError::TooShort));
/// assert_eq!(check_form(&[7; 200]), Err(DecodeError::TooLong));
/// ```
///
/// # Errors
/// [`DecodeError`] up to the version: the first check that failed.
pub fn check_form(frame: &[u8]) -> Result<(), DecodeError> {
    if frame.is_empty() {
        return Err(DecodeError::TooShort);
    }
    if frame.len() > MAX_PACKET {
        return Err(DecodeError::TooLong);
    }
    if frame.contains(&0) || end_of_runs(frame) != frame.len() {
        return Err(DecodeError::Cobs);
    }
    // The first byte of the content follows the first distance, or is the zero that it leads to.
    let version = match frame {
        [1, ..] => 0,
        [_, version, ..] => *version,
        _ => return Err(DecodeError::TooShort),
    };
    let content = frame.len() - 1;
    match content {
        ..=TAG_BYTES => Err(DecodeError::TooShort),
        _ if version != VERSION => Err(DecodeError::Version(version)),
        _ if content < 1 + 1 + TAG_BYTES => Err(DecodeError::TooShort),
        _ => Ok(()),
    }
}

/// Where the last run of COBS ends: at the end of the frame, unless it is damaged.
fn end_of_runs(frame: &[u8]) -> usize {
    let mut next = 0;
    while let Some(&distance) = frame.get(next) {
        // There is no zero: every step leads on.
        next += usize::from(distance);
    }
    next
}

#[cfg(test)]
mod tests {
    use super::super::{Context, Key, SipHash64, decode};
    use super::*;
    use std::vec::Vec;

    /// Anything from noise to what has a frame's form, so that every reason occurs.
    fn bytes(seed: u32) -> Vec<u8> {
        let mut random = seed;
        let mut draw = |below: usize| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> 16) as usize % below
        };
        let mut plain: Vec<u8> = (0..draw(130)).map(|_| draw(256) as u8).collect();
        if let (Some(version), true) = (plain.first_mut(), draw(4) > 0) {
            *version = VERSION;
        }
        let mut frame: Vec<u8> = match draw(4) {
            0 => return plain,
            _ => plain
                .split(|&byte| byte == 0)
                .flat_map(|run| [&[run.len() as u8 + 1], run].concat())
                .collect(),
        };
        if draw(4) == 0 {
            let at = draw(frame.len());
            frame[at] = draw(256) as u8;
        }
        frame
    }

    #[test]
    fn what_has_no_form_is_what_the_decoder_refuses_before_it_needs_a_key() {
        use DecodeError::{Cobs, TooLong, TooShort, Version};
        let auth = SipHash64::new(Key::new([7; 16]));
        let mut seen = [0_u32; 5];
        for seed in 0..200_000 {
            let frame = bytes(seed);
            let decoded = decode::<()>(&frame, &auth, Context::NONE).map(|_| ());
            let form = check_form(&frame);
            let expected = match decoded {
                Err(error @ (TooLong | Cobs | TooShort | Version(_))) => Err(error),
                _ => Ok(()),
            };
            assert_eq!(form, expected, "{frame:?}");
            let kind = match form {
                Ok(()) => 0,
                Err(TooLong) => 1,
                Err(Cobs) => 2,
                Err(TooShort) => 3,
                Err(_) => 4,
            };
            seen[kind] += 1;
        }
        assert!(seen.iter().all(|&count| count > 1_000), "{seen:?}");
    }
}
