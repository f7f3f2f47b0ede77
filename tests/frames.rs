//! Frames as they travel: what was sent arrives, and nothing else does.

use host_sim::Random;
use iibt_core::actions::HORIZON;
use iibt_core::grid::{Cell, Move, Path};
use iibt_core::navigation::{Intention, MAX_HAZARDS, Round, Said, Stage};
use iibt_core::team::{
    Context, DecodeError, Deframer, EncodeError, Envelope, FrameAuth, Heard, Invalid, Key, Limits, MAX_FRAME,
    MAX_MESSAGE, MAX_TEAM, Member, Message, Refused, RobotId, Roster, SipHash64, Stamp, TAG_BYTES, VERSION,
};
use iibt_core::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

const AUTH: SipHash64 = SipHash64::new(Key::new(*b"the team's key.."));
const CONTEXT: Context = Context::of::<Intention>(3, 0x51);

fn decode(frame: &[u8], auth: &impl FrameAuth) -> Result<Said, DecodeError> {
    iibt_core::team::decode(frame, auth, CONTEXT)
}

fn encode<'a>(said: &Said, auth: &impl FrameAuth, buffer: &'a mut [u8]) -> Result<&'a [u8], EncodeError> {
    iibt_core::team::encode(said, auth, CONTEXT, buffer)
}

/// How often a slow property is tried: often in release, less in debug builds.
const fn tries(release: u32) -> u32 {
    if cfg!(debug_assertions) { release / 50 } else { release }
}

mod arrives {
    use super::*;

    #[test]
    fn every_intention_as_it_was_sent() {
        let mut random = Random::new(1);
        for _ in 0..5_000 {
            let intention = intention(&mut random);
            assert_eq!(decode(body_of(&framed(&intention)), &AUTH), Ok(intention));
        }
    }

    /// The layout, pinned. If this fails, the layout has changed: the schema must have changed with
    /// it.
    #[test]
    fn in_the_published_layout() {
        let frame = framed(&six_moves());
        let plain = unstuffed(body_of(&frame));
        #[rustfmt::skip]
        let expected = [
            2,                       // version
            2,                       // sender
            3,                       // epoch
            0xc8, 0x01,              // sequence 200
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
        assert_eq!(CONTEXT.to_bits(), GOLDEN_CONTEXT);
        assert_eq!(frame.len(), 33, "a typical frame");
    }

    #[test]
    fn in_at_most_the_longest_frame() {
        let longest = framed(&largest());
        let content = Intention::MAX_BYTES + "version, sender".split(' ').count() + 5 + 5 + TAG_BYTES;
        assert_eq!(longest.len(), content + 1 + 2, "a byte for COBS, and the delimiters");
        assert_eq!(decode(body_of(&longest), &AUTH), Ok(largest()));
        let mut random = Random::new(2);
        assert!((0..5_000).all(|_| framed(&intention(&mut random)).len() <= MAX_FRAME));
    }

    #[test]
    fn with_zeros_at_its_ends_and_nowhere_else() {
        let mut random = Random::new(3);
        for _ in 0..5_000 {
            let frame = framed(&intention(&mut random));
            let zeros: Vec<_> = (0..frame.len()).filter(|&at| frame[at] == 0).collect();
            assert_eq!(zeros, [0, frame.len() - 1]);
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
            assert_eq!(
                decode(body_of(&framed(&six_moves())), &other),
                Err(DecodeError::Tag),
                "key bit {bit}"
            );
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
        let frame = framed(&six_moves());
        let contexts = [
            Context::of::<Intention>(4, 0x51),
            Context::of::<Intention>(3, 0x52),
            Context::of::<Renamed>(3, 0x51),
        ];
        for other in contexts {
            let refused = iibt_core::team::decode::<Intention>(body_of(&frame), &AUTH, other);
            assert_eq!(refused, Err(DecodeError::Tag), "{other:?}");
            let mut buffer = [0; MAX_FRAME];
            let theirs = iibt_core::team::encode(&six_moves(), &AUTH, other, &mut buffer).unwrap();
            assert_eq!(decode(body_of(theirs), &AUTH), Err(DecodeError::Tag), "{other:?}");
            assert_eq!(iibt_core::team::decode(body_of(theirs), &AUTH, other), Ok(six_moves()));
        }
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
        let long = vec![1; MAX_FRAME - 1];
        let with_delimiter = framed(&six_moves());
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
            ((|body| body[0] = MAX_TEAM as u8) as fn(&mut Vec<u8>), DecodeError::Sender),
            (|body| body[5] = 5, DecodeError::Body),
            (|body| body[10] = 65, DecodeError::Body),
            (|body| body[11] = 0x53, DecodeError::Invalid(Intention::NO_MOVE)),
            (|body| body[14] = 7, DecodeError::Invalid(Intention::STEP_BEYOND_PATH)),
            (|body| body[18] = 0x7f, DecodeError::Invalid(Intention::NO_PROBABILITY)),
            (
                |body| body[15..19].copy_from_slice(&f32::NAN.to_le_bytes()),
                DecodeError::Invalid(Intention::NO_PROBABILITY),
            ),
            (|body| body[19] = MAX_HAZARDS as u8 + 1, DecodeError::Body),
            (|body| body.push(0), DecodeError::Trailing),
            (|body| body.truncate(body.len() - 1), DecodeError::Body),
        ] {
            assert_eq!(with(change), Err(expected));
        }
    }

    #[test]
    fn nothing_but_valid_intentions_comes_out() {
        let mut random = Random::new(8);
        let mut decoded = 0;
        for _ in 0..tries(1_000_000) {
            let mut body = body(&intention(&mut random));
            for _ in 0..=random.below(3) {
                let at = random.below(body.len());
                body[at] = random.bits() as u8;
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
        let refused = |change: fn(&mut Said)| {
            let mut said = six_moves();
            change(&mut said);
            encode(&said, &AUTH, &mut [0; MAX_FRAME]).map(<[u8]>::len)
        };
        let invalid = Err(EncodeError::Invalid(Intention::NO_PROBABILITY));
        assert_eq!(refused(|said| said.message.probability = f32::NAN), invalid);
        assert_eq!(refused(|said| said.sender = RobotId(MAX_TEAM as u8)), Err(EncodeError::Sender));
    }

    /// A message that is longer than it says.
    #[derive(Clone, Serialize, Deserialize)]
    struct Understated(u32);

    impl Message for Understated {
        const SCHEMA: &'static str = "number u32";
        const MAX_BYTES: usize = 2;
    }

    #[test]
    fn a_message_that_is_longer_than_its_type_says_is_not_sent() {
        let sent = |number| {
            let said = Envelope { sender: RobotId(0), stamp: Stamp::default(), message: Understated(number) };
            let context = Context::of::<Understated>(0, 0);
            iibt_core::team::encode(&said, &AUTH, context, &mut [0; MAX_FRAME]).map(<[u8]>::len)
        };
        assert!(sent(0x3fff).is_ok());
        assert_eq!(sent(0x4000), Err(EncodeError::MessageTooLong));
    }

    /// A message of the most bytes that a frame carries.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Full(u64, [u8; 32], [u8; 32], [u8; 30]);

    impl Message for Full {
        const SCHEMA: &'static str = "number u64; bytes 32 32 30";
        const MAX_BYTES: usize = MAX_MESSAGE;

        fn validate(&self) -> Result<(), Invalid> {
            Ok(())
        }
    }

    #[test]
    fn the_longest_message_of_any_task_fits_the_longest_frame() {
        let stamp = Stamp { epoch: u32::MAX, sequence: u32::MAX };
        let message = Full(u64::MAX, [0xff; 32], [0; 32], [1; 30]);
        let said = Envelope { sender: RobotId(7), stamp, message };
        let (context, mut buffer) = (Context::of::<Full>(0, 0), [0; MAX_FRAME]);
        let frame = iibt_core::team::encode(&said, &AUTH, context, &mut buffer).unwrap();
        assert_eq!(frame.len(), MAX_FRAME);
        assert_eq!(iibt_core::team::decode(body_of(frame), &AUTH, context), Ok(said));
    }
}

mod in_a_stream {
    use super::*;

    #[test]
    fn noise_between_frames_spoils_neither() {
        let mut random = Random::new(9);
        for _ in 0..tries(200_000) {
            let (first, second) = (intention(&mut random), intention(&mut random));
            let [before, between] = [(); 2].map(|()| {
                let length = random.below(2 * MAX_FRAME);
                random.bytes(length)
            });
            let stream = [before, framed(&first), between, framed(&second)].concat();
            assert_eq!(received(&stream), [first, second]);
        }
    }

    #[test]
    fn a_flipped_bit_loses_its_frame_and_no_other() {
        let mut random = Random::new(11);
        for _ in 0..tries(2_000) {
            let [first, second, third] =
                [intention(&mut random), intention(&mut random), intention(&mut random)];
            let damaged_length = framed(&first).len();
            let stream = [framed(&first), framed(&second), framed(&third)].concat();
            for bit in 0..8 * damaged_length {
                let mut stream = stream.clone();
                stream[bit / 8] ^= 1 << (bit % 8);
                // The delimiter before the first frame is not missed at the beginning of a stream
                // only if it turns into a byte of the frame; the one after it has another behind
                // it.
                let expected = [second.clone(), third.clone()];
                let received = received(&stream);
                let rest = received.strip_prefix(std::slice::from_ref(&first)).unwrap_or(&received);
                assert_eq!(rest, expected, "bit {bit}");
                let is_last = bit / 8 == damaged_length - 1;
                assert!(received.len() == 2 || is_last, "bit {bit}");
            }
        }
    }

    /// A recorder that plays everything back, in any order and at any time, changes nothing.
    #[test]
    fn a_replay_is_never_heard() {
        let mut random = Random::new(12);
        let mut roster = roster();
        let mut recorded = Vec::new();
        let mut newest = None;
        for sequence in 0..tries(50_000) {
            let epoch = sequence / 40;
            let stamp = Stamp { epoch, sequence: sequence % 40 };
            let frame = framed(&Said { sender: RobotId(1), stamp, ..intention(&mut random) });
            let expected = match (newest, epoch) {
                (None, _) => Heard::First,
                (Some(before), _) if before < epoch => Heard::Restart,
                _ => Heard::Update,
            };
            newest = Some(epoch);
            assert_eq!(receive(&mut roster, body_of(&frame), Instant(sequence)), Ok(expected));
            recorded.push(frame);
            let old = &recorded[random.below(recorded.len())];
            let refused = receive(&mut roster, body_of(old), Instant(sequence)).unwrap_err();
            assert!(matches!(refused, Refused::Duplicate | Refused::Outdated));
        }
        assert_eq!(roster.counters().accepted, roster.counters().refused());
    }

    #[test]
    fn a_flood_of_junk_is_counted_and_harmless() {
        let mut random = Random::new(13);
        let mut roster = roster();
        receive(&mut roster, body_of(&framed(&six_moves())), Instant(0)).unwrap();
        for _ in 0..10_000 {
            let length = random.below(40);
            receive(&mut roster, &random.bytes(length), Instant(1)).unwrap_err();
        }
        assert_eq!((roster.counters().accepted, roster.counters().refused()), (1, 10_000));
        assert_eq!(roster.peer(RobotId(2)).map(|peer| peer.envelope().clone()), Some(six_moves()));
    }
}

/// The context that `six_moves` is pinned in.
const GOLDEN_CONTEXT: u64 = 0x4b52_df06_1484_db23;
const GOLDEN_TAG: [u8; TAG_BYTES] = [0, 149, 167, 98, 163, 110, 205, 254];

/// A path of six moves, half-way through a mission.
fn six_moves() -> Said {
    let mut path = Path::at(Cell(8));
    for step in [Move::Right, Move::Right, Move::Down, Move::Wait, Move::Down, Move::Down] {
        path.push(step).unwrap();
    }
    let mut message = Intention {
        round: Round(4),
        stage: Stage::Announced,
        plan: 0,
        goal: Some(Cell(24)),
        path,
        step: 5,
        probability: 0.75,
        hazards: Default::default(),
    };
    message.hazards.push(Cell(23)).unwrap();
    Said { sender: RobotId(2), stamp: Stamp { epoch: 3, sequence: 200 }, message }
}

/// Every number as large as it can be, which is what takes the most bytes.
fn largest() -> Said {
    let mut path = Path::at(Cell(u16::MAX));
    for _ in 0..HORIZON {
        path.push(Move::Wait).unwrap();
    }
    let mut message = Intention {
        round: Round(u16::MAX),
        stage: Stage::Away,
        plan: u32::MAX,
        goal: Some(Cell(u16::MAX)),
        path,
        step: HORIZON as u8,
        probability: 1.0,
        hazards: Default::default(),
    };
    while message.hazards.push(Cell(u16::MAX)).is_ok() {}
    let stamp = Stamp { epoch: u32::MAX, sequence: u32::MAX };
    Said { sender: RobotId(MAX_TEAM as u8 - 1), stamp, message }
}

fn roster() -> Roster<Intention> {
    let limits = Limits::new(Duration(10), Duration(20)).unwrap();
    Roster::new(Member::new(RobotId(0), 3).unwrap(), limits)
}

fn receive(roster: &mut Roster<Intention>, frame: &[u8], now: Instant) -> Result<Heard, Refused> {
    roster.receive(frame, &AUTH, CONTEXT, now, |_| Ok(()))
}

fn framed(said: &Said) -> Vec<u8> {
    encode(said, &AUTH, &mut [0; MAX_FRAME]).unwrap().to_vec()
}

/// A frame without its delimiters.
fn body_of(frame: &[u8]) -> &[u8] {
    &frame[1..frame.len() - 1]
}

/// Everything of a plain frame between version and tag.
fn body(said: &Said) -> Vec<u8> {
    let plain = unstuffed(body_of(&framed(said)));
    plain[1..plain.len() - TAG_BYTES].to_vec()
}

/// A frame without its delimiters around a body of whatever kind, with a valid tag.
fn sealed(version: u8, body: &[u8]) -> Vec<u8> {
    let mut plain = [&[version][..], body].concat();
    let sender = RobotId(body.first().copied().unwrap_or(0));
    let tag = AUTH.tag(sender, CONTEXT, &plain);
    plain.extend(tag);
    stuffed(&plain)
}

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
fn received(stream: &[u8]) -> Vec<Said> {
    let mut deframer = Deframer::new();
    let frames = stream.iter().filter_map(|&byte| deframer.feed(byte).map(|frame| decode(frame, &AUTH).ok()));
    frames.flatten().collect()
}

/// A number with a uniform number of bits, so that short and long encodings are equally common.
fn number(random: &mut Random) -> u32 {
    random.bits().checked_shr(random.below(33) as u32).unwrap_or(0)
}

fn cell(random: &mut Random) -> Cell {
    Cell(number(random) as u16)
}

fn intention(random: &mut Random) -> Said {
    const STAGES: [Stage; 5] =
        [Stage::Deciding, Stage::Announced, Stage::Agreed, Stage::Arrived, Stage::Away];
    let path = path(random);
    let mut message = Intention {
        round: Round(number(random) as u16),
        stage: STAGES[random.below(5)],
        plan: number(random),
        goal: (random.below(4) > 0).then(|| cell(random)),
        path,
        step: random.below(path.len() + 1) as u8,
        probability: random.below(1001) as f32 / 1000.0,
        hazards: Default::default(),
    };
    for _ in 0..random.below(MAX_HAZARDS + 1) {
        message.hazards.push(cell(random)).unwrap();
    }
    let stamp = Stamp { epoch: number(random), sequence: number(random) };
    Said { sender: RobotId(random.below(MAX_TEAM) as u8), stamp, message }
}

fn path(random: &mut Random) -> Path {
    let mut path = Path::at(cell(random));
    for _ in 0..random.below(HORIZON + 1) {
        path.push(Move::ALL[random.below(5)]).unwrap();
    }
    path
}
