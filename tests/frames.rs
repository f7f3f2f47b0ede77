//! Frames as they travel: what was sent arrives, and nothing else does.

use iibt_core::actions::HORIZON;
use iibt_core::grid::{Cell, Move, Path};
use iibt_core::team::{
    DecodeError, Deframer, EncodeError, FrameAuth, Heard, Intention, Invalid, Key, Limits, MAX_FRAME,
    MAX_HAZARDS, MAX_TEAM, Refused, RobotId, Roster, Round, SCHEMA, SipHash64, Status, TAG_BYTES, Tag,
    VERSION, decode, encode,
};
use iibt_core::time::{Duration, Instant};

const AUTH: SipHash64 = SipHash64::new(Key::new(*b"the team's key.."));

/// How often a slow property is tried: often in release, less in debug builds.
const fn tries(release: u32) -> u32 {
    if cfg!(debug_assertions) { release / 50 } else { release }
}

mod arrives {
    use super::*;

    #[test]
    fn every_intention_as_it_was_sent() {
        let mut random = Random(1);
        for _ in 0..5_000 {
            let intention = random.intention();
            assert_eq!(decode(body_of(&framed(&intention)), &AUTH), Ok(intention));
        }
    }

    /// The layout, pinned. If this fails, the layout has changed: `SCHEMA` must have changed with it.
    #[test]
    fn in_the_published_layout() {
        let frame = framed(&six_moves());
        let plain = unstuffed(body_of(&frame));
        #[rustfmt::skip]
        let expected = [
            1,                       // version
            2,                       // robot
            3,                       // epoch
            0xc8, 0x01,              // sequence 200
            0xd0, 0x86, 0x03,        // tick 50000
            4,                       // round
            1,                       // announced
            0,                       // plan
            1, 24,                   // goal p24
            8,                       // path start p8
            6, 0x33, 0x41, 0x11,     // six moves: right right, down wait, down down
            5,                       // step
            0x00, 0x00, 0x40, 0x3f,  // probability 0.75
            1, 23,                   // one hazard
        ];
        let (signed, tag) = plain.split_at(plain.len() - TAG_BYTES);
        assert_eq!(signed, expected);
        assert_eq!(tag, GOLDEN_TAG);
        assert_eq!(SCHEMA, GOLDEN_SCHEMA);
        assert_eq!(frame.len(), 35, "a typical frame");
    }

    #[test]
    fn in_at_most_the_longest_frame() {
        let longest = framed(&largest());
        assert_eq!(longest.len(), MAX_FRAME);
        assert_eq!(decode(body_of(&longest), &AUTH), Ok(largest()));
        let mut random = Random(2);
        assert!((0..5_000).all(|_| framed(&random.intention()).len() <= MAX_FRAME));
    }

    #[test]
    fn with_its_only_zero_at_the_end() {
        let mut random = Random(3);
        for _ in 0..5_000 {
            let frame = framed(&random.intention());
            assert_eq!(frame.iter().position(|&byte| byte == 0), Some(frame.len() - 1));
        }
    }

    #[test]
    fn in_a_buffer_of_just_its_length() {
        let frame = framed(&six_moves());
        for length in 0..frame.len() {
            let outcome = encode(&six_moves(), &AUTH, &mut vec![0; length]).map(<[u8]>::len);
            assert_eq!(outcome, Err(EncodeError::BufferTooSmall), "{length} bytes");
        }
        assert_eq!(encode(&six_moves(), &AUTH, &mut vec![0; frame.len()]), Ok(&frame[..]));
    }
}

mod is_refused {
    use super::*;

    #[test]
    fn every_truncation() {
        let mut random = Random(4);
        for _ in 0..tries(5_000) {
            let frame = framed(&random.intention());
            let body = body_of(&frame);
            for cut in 0..body.len() {
                assert!(decode(&body[..cut], &AUTH).is_err(), "first {cut} bytes");
                assert!(decode(&body[cut + 1..], &AUTH).is_err(), "without the first {}", cut + 1);
            }
        }
    }

    #[test]
    fn every_flip_of_a_single_bit() {
        let mut random = Random(5);
        for _ in 0..tries(5_000) {
            let frame = framed(&random.intention());
            for bit in 0..8 * (frame.len() - 1) {
                let mut damaged = body_of(&frame).to_vec();
                damaged[bit / 8] ^= 1 << (bit % 8);
                assert!(decode(&damaged, &AUTH).is_err(), "bit {bit}");
            }
        }
    }

    #[test]
    fn every_splice_of_two_frames() {
        let mut random = Random(6);
        for _ in 0..tries(2_000) {
            let (first, second) = (framed(&random.intention()), framed(&random.intention()));
            for cut in 1..first.len() - 1 {
                for splice in [cut, random.below(second.len() as u32 - 2) as usize + 1] {
                    let spliced = [&first[..cut], second.get(splice..).unwrap_or(&[])].concat();
                    if spliced != first && spliced != second {
                        let spliced = spliced.strip_suffix(&[0]).unwrap_or(&spliced);
                        assert!(decode(spliced, &AUTH).is_err(), "{cut} of one, from {splice} of the other");
                    }
                }
            }
        }
    }

    #[test]
    fn whatever_is_random() {
        let mut random = Random(7);
        for _ in 0..tries(2_000_000) {
            let length = random.below(MAX_FRAME as u32 + 8) as usize;
            let bytes = random.bytes(length);
            assert!(decode(&bytes, &AUTH).is_err(), "{bytes:?}");
        }
    }

    #[test]
    fn a_frame_with_another_key() {
        for bit in 0..128 {
            let key = (u128::from_le_bytes(*b"the team's key..") ^ (1 << bit)).to_le_bytes();
            let other = SipHash64::new(Key::new(key));
            assert_eq!(
                decode(body_of(&framed(&six_moves())), &other),
                Err(DecodeError::Tag),
                "key bit {bit}"
            );
        }
    }

    #[test]
    fn a_frame_with_another_schema() {
        struct OtherSchema;
        impl FrameAuth for OtherSchema {
            fn tag(&self, schema: u64, message: &[u8]) -> Tag {
                AUTH.tag(schema ^ 1, message)
            }
        }
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&six_moves(), &OtherSchema, &mut buffer).unwrap();
        assert_eq!(decode(body_of(frame), &AUTH), Err(DecodeError::Tag));
        assert_eq!(decode(body_of(frame), &OtherSchema), Ok(six_moves()));
    }

    #[test]
    fn a_frame_of_another_version() {
        for version in (0..=u8::MAX).filter(|&version| version != VERSION) {
            let frame = sealed(version, &body(&six_moves()));
            assert_eq!(decode(&frame, &AUTH), Err(DecodeError::Version(version)));
        }
    }

    #[test]
    fn bytes_that_are_no_frame_at_all() {
        let long = vec![1; MAX_FRAME];
        let with_delimiter = framed(&six_moves());
        for (bytes, expected) in [
            (&[][..], DecodeError::TooShort),
            (&[1], DecodeError::TooShort),
            (&stuffed(&[VERSION, 1, 2, 3, 4, 5, 6, 7]), DecodeError::TooShort),
            (&stuffed(&[1, 2, 3, 4, 5, 6, 7, 8]), DecodeError::TooShort),
            (&stuffed(&[VERSION, 1, 2, 3, 4, 5, 6, 7, 8]), DecodeError::Tag),
            (&[2], DecodeError::Cobs),
            (&[5, 1, 2, 3], DecodeError::Cobs),
            (&[0], DecodeError::Cobs),
            (&with_delimiter, DecodeError::Cobs),
            (&long, DecodeError::TooLong),
        ] {
            assert_eq!(decode(bytes, &AUTH), Err(expected), "{bytes:?}");
        }
    }
}

/// Bodies that only a holder of the key can have made.
mod although_authentic {
    use super::*;

    #[test]
    fn a_value_out_of_range_is_named() {
        let with = |change: fn(&mut Vec<u8>)| {
            let mut body = body(&six_moves());
            change(&mut body);
            decode(&sealed(VERSION, &body), &AUTH)
        };
        assert_eq!(with(|_| ()), Ok(six_moves()));
        for (change, expected) in [
            ((|body| body[0] = MAX_TEAM as u8) as fn(&mut Vec<u8>), DecodeError::Invalid(Invalid::Robot)),
            (|body| body[8] = 5, DecodeError::Body),
            (|body| body[13] = 65, DecodeError::Body),
            (|body| body[14] = 0x53, DecodeError::Invalid(Invalid::Move)),
            (|body| body[17] = 7, DecodeError::Invalid(Invalid::Step)),
            (|body| body[21] = 0x7f, DecodeError::Invalid(Invalid::Probability)),
            (
                |body| body[18..22].copy_from_slice(&f32::NAN.to_le_bytes()),
                DecodeError::Invalid(Invalid::Probability),
            ),
            (|body| body[22] = MAX_HAZARDS as u8 + 1, DecodeError::Body),
            (|body| body.push(0), DecodeError::Trailing),
            (|body| body.truncate(body.len() - 1), DecodeError::Body),
        ] {
            assert_eq!(with(change), Err(expected));
        }
    }

    #[test]
    fn nothing_but_valid_intentions_comes_out() {
        let mut random = Random(8);
        let mut decoded = 0;
        for _ in 0..tries(1_000_000) {
            let mut body = body(&random.intention());
            for _ in 0..=random.below(3) {
                let at = random.below(body.len() as u32) as usize;
                body[at] = random.next() as u8;
            }
            if let Ok(intention) = decode(&sealed(VERSION, &body), &AUTH) {
                decoded += 1;
                assert_eq!(decode(body_of(&framed(&intention)), &AUTH), Ok(intention));
            }
        }
        assert!(decoded > 0);
    }

    #[test]
    fn the_sender_refuses_it_first() {
        let intention = Intention { probability: f32::NAN, ..six_moves() };
        let refused = encode(&intention, &AUTH, &mut [0; MAX_FRAME]).map(<[u8]>::len);
        assert_eq!(refused, Err(EncodeError::Invalid(Invalid::Probability)));
    }
}

mod in_a_stream {
    use super::*;

    #[test]
    fn garbage_spoils_at_most_the_next_frame() {
        let mut random = Random(9);
        for _ in 0..tries(200_000) {
            let (first, second) = (random.intention(), random.intention());
            let length = random.below(2 * MAX_FRAME as u32) as usize;
            let stream = [random.bytes(length), framed(&first), framed(&second)].concat();
            let received = received(&stream);
            assert!(received == [second.clone()] || received == [first, second], "{stream:?}");
        }
    }

    #[test]
    fn garbage_before_a_delimiter_spoils_nothing() {
        let mut random = Random(10);
        for _ in 0..tries(200_000) {
            let intention = random.intention();
            let length = random.below(2 * MAX_FRAME as u32) as usize;
            let stream = [random.bytes(length), vec![0], framed(&intention)].concat();
            assert_eq!(received(&stream), [intention]);
        }
    }

    #[test]
    fn a_flipped_bit_loses_its_frame_and_at_most_one_more() {
        let mut random = Random(11);
        for _ in 0..tries(2_000) {
            let [first, second, third] = [random.intention(), random.intention(), random.intention()];
            let damaged_length = framed(&first).len();
            let stream = [framed(&first), framed(&second), framed(&third)].concat();
            for bit in 0..8 * damaged_length {
                let mut stream = stream.clone();
                stream[bit / 8] ^= 1 << (bit % 8);
                let delimiter_hit = bit / 8 == damaged_length - 1;
                let expected =
                    if delimiter_hit { vec![third.clone()] } else { vec![second.clone(), third.clone()] };
                assert_eq!(received(&stream), expected, "bit {bit}");
            }
        }
    }

    /// A recorder that plays everything back, in any order and at any time, changes nothing.
    #[test]
    fn a_replay_is_never_heard() {
        let mut random = Random(12);
        let mut roster = roster();
        let mut recorded = Vec::new();
        let mut newest = None;
        for sequence in 0..tries(50_000) {
            let epoch = sequence / 40;
            let frame = framed(&Intention {
                robot: RobotId(1),
                epoch,
                sequence: sequence % 40,
                ..random.intention()
            });
            let expected = match (newest, epoch) {
                (None, _) => Heard::First,
                (Some(before), _) if before < epoch => Heard::Restart,
                _ => Heard::Update,
            };
            newest = Some(epoch);
            assert_eq!(roster.receive(body_of(&frame), &AUTH, Instant(sequence)), Ok(expected));
            recorded.push(frame);
            let old = &recorded[random.below(recorded.len() as u32) as usize];
            let refused = roster.receive(body_of(old), &AUTH, Instant(sequence)).unwrap_err();
            assert!(matches!(refused, Refused::Duplicate | Refused::Outdated));
        }
        assert_eq!(roster.counters().accepted, roster.counters().refused());
    }

    #[test]
    fn a_flood_of_junk_is_counted_and_harmless() {
        let mut random = Random(13);
        let mut roster = roster();
        roster.receive(body_of(&framed(&six_moves())), &AUTH, Instant(0)).unwrap();
        for _ in 0..10_000 {
            let length = random.below(40) as usize;
            roster.receive(&random.bytes(length), &AUTH, Instant(1)).unwrap_err();
        }
        assert_eq!((roster.counters().accepted, roster.counters().refused()), (1, 10_000));
        assert_eq!(roster.peer(RobotId(2)).map(|peer| peer.intention().clone()), Some(six_moves()));
    }
}

/// The hash of the layout that `six_moves` is pinned in.
const GOLDEN_SCHEMA: u64 = 0x5fc6_bf64_6027_f19c;
const GOLDEN_TAG: [u8; TAG_BYTES] = [0x83, 0x9d, 0x82, 0x46, 0x3c, 0x7d, 0x0e, 0xe4];

/// A path of six moves, half-way through a mission.
fn six_moves() -> Intention {
    let mut path = Path::at(Cell(8));
    for step in [Move::Right, Move::Right, Move::Down, Move::Wait, Move::Down, Move::Down] {
        path.push(step).unwrap();
    }
    let mut intention = Intention {
        robot: RobotId(2),
        epoch: 3,
        sequence: 200,
        tick: Instant(50_000),
        round: Round(4),
        status: Status::Announced,
        plan: 0,
        goal: Some(Cell(24)),
        path,
        step: 5,
        probability: 0.75,
        hazards: Default::default(),
    };
    intention.hazards.push(Cell(23)).unwrap();
    intention
}

/// Every number as large as it can be, which is what takes the most bytes.
fn largest() -> Intention {
    let mut path = Path::at(Cell(u16::MAX));
    for _ in 0..HORIZON {
        path.push(Move::Wait).unwrap();
    }
    let mut intention = Intention {
        robot: RobotId(MAX_TEAM as u8 - 1),
        epoch: u32::MAX,
        sequence: u32::MAX,
        tick: Instant(u32::MAX),
        round: Round(u16::MAX),
        status: Status::Away,
        plan: u32::MAX,
        goal: Some(Cell(u16::MAX)),
        path,
        step: HORIZON as u8,
        probability: 1.0,
        hazards: Default::default(),
    };
    while intention.hazards.push(Cell(u16::MAX)).is_ok() {}
    intention
}

fn roster() -> Roster {
    let limits = Limits::new(Duration(10), Duration(20)).unwrap();
    Roster::new(RobotId(0), 3, limits).unwrap()
}

/// A frame with its delimiter.
fn framed(intention: &Intention) -> Vec<u8> {
    encode(intention, &AUTH, &mut [0xaa; MAX_FRAME]).unwrap().to_vec()
}

/// A frame without its delimiter.
fn body_of(frame: &[u8]) -> &[u8] {
    frame.split_last().unwrap().1
}

/// The postcard form of an intention.
fn body(intention: &Intention) -> Vec<u8> {
    let plain = unstuffed(body_of(&framed(intention)));
    plain[1..plain.len() - TAG_BYTES].to_vec()
}

/// A frame without delimiter, tagged by hand.
fn sealed(version: u8, body: &[u8]) -> Vec<u8> {
    let signed = [&[version], body].concat();
    let tag = AUTH.tag(SCHEMA, &signed);
    stuffed(&[&signed[..], &tag].concat())
}

/// COBS by its definition, for less than 254 bytes: every run up to a zero follows its length plus one.
fn stuffed(plain: &[u8]) -> Vec<u8> {
    let runs = plain.split(|&byte| byte == 0);
    runs.flat_map(|run| [&[run.len() as u8 + 1], run].concat()).collect()
}

fn unstuffed(frame: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    let mut rest = frame;
    while let Some((&code, after)) = rest.split_first() {
        let (run, after) = after.split_at(usize::from(code) - 1);
        plain.extend_from_slice(run);
        plain.push(0);
        rest = after;
    }
    plain.pop();
    plain
}

/// The intentions that come out of a stream of bytes.
fn received(stream: &[u8]) -> Vec<Intention> {
    let mut deframer = Deframer::new();
    let frames = stream.iter().filter_map(|&byte| deframer.feed(byte).map(|frame| decode(frame, &AUTH).ok()));
    frames.flatten().collect()
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, limit: u32) -> u32 {
        (((self.next() >> 32) * u64::from(limit)) >> 32) as u32
    }

    fn bytes(&mut self, length: usize) -> Vec<u8> {
        (0..length).map(|_| self.next() as u8).collect()
    }

    /// A number with a uniform number of bits, so that short and long encodings are equally common.
    fn number(&mut self) -> u32 {
        (self.next() as u32).checked_shr(self.below(33)).unwrap_or(0)
    }

    fn cell(&mut self) -> Cell {
        Cell(self.number() as u16)
    }

    fn intention(&mut self) -> Intention {
        const STATUS: [Status; 5] =
            [Status::Deciding, Status::Announced, Status::Agreed, Status::Arrived, Status::Away];
        let path = self.path();
        let mut intention = Intention {
            robot: RobotId(self.below(MAX_TEAM as u32) as u8),
            epoch: self.number(),
            sequence: self.number(),
            tick: Instant(self.number()),
            round: Round(self.number() as u16),
            status: STATUS[self.below(5) as usize],
            plan: self.number(),
            goal: (self.below(4) > 0).then(|| self.cell()),
            path,
            step: self.below(path.len() as u32 + 1) as u8,
            probability: self.below(1001) as f32 / 1000.0,
            hazards: Default::default(),
        };
        for _ in 0..self.below(MAX_HAZARDS as u32 + 1) {
            intention.hazards.push(self.cell()).unwrap();
        }
        intention
    }

    fn path(&mut self) -> Path {
        let mut path = Path::at(self.cell());
        for _ in 0..self.below(HORIZON as u32 + 1) {
            path.push(Move::ALL[self.below(5) as usize]).unwrap();
        }
        path
    }
}
