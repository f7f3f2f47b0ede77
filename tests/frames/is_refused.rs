use super::*;

#[test]
fn every_truncation() {
    let mut random = Random::new(4);
    for _ in 0..tries(5_000) {
        let frame = framed(&intention(&mut random));
        let body = body_of(&frame);
        for cut in 0..body.len() {
            assert!(decode(&body[..cut], &AUTH).is_err(), "first {cut} bytes");
            assert!(decode(&body[cut + 1..], &AUTH).is_err(), "without the first {}", cut + 1);
        }
    }
}

#[test]
fn every_flip_of_a_single_bit() {
    let mut random = Random::new(5);
    for _ in 0..tries(5_000) {
        let frame = framed(&intention(&mut random));
        for bit in 0..8 * body_of(&frame).len() {
            let mut damaged = body_of(&frame).to_vec();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(decode(&damaged, &AUTH).is_err(), "bit {bit}");
        }
    }
}

#[test]
fn every_splice_of_two_frames() {
    let mut random = Random::new(6);
    for _ in 0..tries(2_000) {
        let frames = [framed(&intention(&mut random)), framed(&intention(&mut random))];
        let [first, second] = frames.each_ref().map(|frame| body_of(frame));
        for cut in 1..first.len() {
            for splice in [cut, random.below(second.len() - 1) + 1] {
                let spliced = [&first[..cut], second.get(splice..).unwrap_or(&[])].concat();
                if spliced != first && spliced != second {
                    assert!(decode(&spliced, &AUTH).is_err(), "{cut} of one, from {splice} of the other");
                }
            }
        }
    }
}

#[test]
fn whatever_is_random() {
    let mut random = Random::new(7);
    for _ in 0..tries(2_000_000) {
        let length = random.below(MAX_FRAME + 8);
        let bytes = random.bytes(length);
        assert!(decode(&bytes, &AUTH).is_err(), "{bytes:?}");
    }
}

#[test]
fn a_frame_with_another_key() {
    for bit in 0..128 {
        let key = (u128::from_le_bytes(*b"the team's key..") ^ (1 << bit)).to_le_bytes();
        let other = SipHash64::new(Key::new(key));
        assert_eq!(decode(body_of(&framed(&driving())), &other), Err(DecodeError::Tag), "key bit {bit}");
    }
}

/// A message of the same bytes under another description.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Renamed(Intention);

impl Message for Renamed {
    const SCHEMA: &'static str = "something else";
    const MAX_BYTES: usize = Intention::MAX_BYTES;
}

#[test]
fn a_frame_of_another_team_mission_or_layout() {
    let frame = framed(&driving());
    let contexts = [
        Context::of::<Intention>(4, 0x51),
        Context::of::<Intention>(3, 0x52),
        Context::of::<Renamed>(3, 0x51),
    ];
    for other in contexts {
        let refused = iibt_core::team::decode::<Intention>(body_of(&frame), &AUTH, other);
        assert_eq!(refused, Err(DecodeError::Tag), "{other:?}");
        let mut buffer = [0; MAX_FRAME];
        let theirs = iibt_core::team::encode(&driving(), &AUTH, other, &mut buffer).unwrap();
        assert_eq!(decode(body_of(theirs), &AUTH), Err(DecodeError::Tag), "{other:?}");
        assert_eq!(iibt_core::team::decode(body_of(theirs), &AUTH, other), Ok(driving()));
    }
}

#[test]
fn a_frame_of_another_version() {
    for version in (0..=u8::MAX).filter(|&version| version != VERSION) {
        let frame = sealed(version, &body(&driving()));
        assert_eq!(decode(&frame, &AUTH), Err(DecodeError::Version(version)));
    }
}

#[test]
fn bytes_that_are_no_frame_at_all() {
    let long = vec![1; MAX_FRAME - 1];
    let with_delimiter = framed(&driving());
    for (bytes, expected) in [
        (&[][..], DecodeError::TooShort),
        (&[1], DecodeError::TooShort),
        (&stuffed(&[VERSION, 1, 2, 3, 4, 5, 6, 7]), DecodeError::TooShort),
        (&stuffed(&[1, 2, 3, 4, 5, 6, 7, 8]), DecodeError::TooShort),
        (&stuffed(&[VERSION, 1, 2, 3, 4, 5, 6, 7, 8]), DecodeError::TooShort),
        (&stuffed(&[VERSION, 0, 1, 2, 3, 4, 5, 6, 7, 8]), DecodeError::Tag),
        (&[2], DecodeError::Cobs),
        (&[5, 1, 2, 3], DecodeError::Cobs),
        (&[0], DecodeError::Cobs),
        (&with_delimiter, DecodeError::Cobs),
        (&long, DecodeError::TooLong),
    ] {
        assert_eq!(decode(bytes, &AUTH), Err(expected), "{bytes:?}");
    }
}
