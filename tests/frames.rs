//! Frames as they travel: what was sent arrives, and nothing else does.

use host_sim::Random;
use iibt_core::grid::{Cell, CellSet};
use iibt_core::navigation::{Announced, Blocks, CellEvidence, Cells, Fact, MAX_EVIDENCE, Purpose};
use iibt_core::team::rounds::{Answer, Choice, Claim, Digest, Proposal, RoundMessage, Score, Scores, View};
use iibt_core::team::{
    Context, DecodeError, Deframer, EncodeError, Envelope, FrameAuth, Heard, Invalid, Key, Limits, MAX_FRAME,
    MAX_MESSAGE, MAX_TEAM, Member, Message, Refused, RobotId, Roster, SipHash64, Stamp, TAG_BYTES, VERSION,
};
use iibt_core::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Sixteen joint policies, as in images.
const K: usize = 16;

type Intention = iibt_core::navigation::Intention<2, K>;

type Said = Envelope<Intention>;

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

    /// The layout, pinned. If this fails, the layout has changed: the schema must have changed with it.
    #[test]
    fn in_the_published_layout() {
        let frame = framed(&driving());
        let plain = unstuffed(body_of(&frame));
        #[rustfmt::skip]
        let expected = [
            2,                       // version
            2,                       // sender
            3,                       // epoch
            0xc8, 0x01,              // sequence 200
            0xac, 0x02,              // round 300
            0b111,                   // members: robots 0, 1 and 2
            0,                       // no walls: nobody is left out
            8,                       // it stood on p8 when the round began
            0,                       // it is for a goal
            1, 23, 0x40,             // evidence on one cell, p23: four nats for an obstacle
            2,                       // it has decided
            1, 2, 3, 4,              // the digest
            0,                       // no scores any more
            1, 3, 191,               // policy 3 with a probability of 191/255
            5,                       // five moves are made
        ];
        let (signed, tag) = plain.split_at(plain.len() - TAG_BYTES);
        assert_eq!(signed, expected);
        assert_eq!(tag, GOLDEN_TAG);
        assert_eq!(CONTEXT.to_bits(), GOLDEN_CONTEXT);
        assert_eq!(frame.len(), 35, "a typical frame");
    }

    #[test]
    fn in_the_published_layout_while_a_robot_decides_without_another() {
        let view = View::full(3).without(RobotId(1));
        let wall: CellSet<2> = [9, 12, 16].map(Cell).into_iter().collect();
        let proposal = Proposal { round: 7, view, walls: [Cells(wall).to_wire(1)].into_iter().collect() };
        let fact = Fact { anchor: Cell(8), purpose: Purpose::Visit(Cell(40)), evidence: Announced::new() };
        let scores = [Score { delay: 8, price: 0 }, Score::CANNOT].into_iter().collect();
        let answer = Answer::Scored { digest: Digest([1, 2, 3, 4]), scores };
        let said = Said {
            message: iibt_core::navigation::Intention(RoundMessage { proposal, fact, answer }),
            ..driving()
        };
        let plain = unstuffed(body_of(&framed(&said)));
        #[rustfmt::skip]
        let expected = [
            7, 0b101,                      // round 7 of robots 0 and 2
            1, 0, 1, 2, 0b0001_0010, 0b1,  // one wall, cell by cell from p8 on, two bytes: p9 and p12, p16
            8, 1, 40, 0,                   // from p8 to the way-point p40, no evidence
            1, 1, 2, 3, 4,                 // it has scored the list of this digest
            2, 8, 0, 255, 255,             // two policies: a tick late, and cannot
        ];
        assert_eq!(plain[5..plain.len() - TAG_BYTES], expected);
        assert_eq!(decode(body_of(&framed(&said)), &AUTH), Ok(said));
    }

    /// In the middle of a long mission on a map of 256 cells: epoch 40, sequence 100,000, round 300, evidence on four cells.
    #[test]
    fn in_few_bytes_while_robots_decide_and_fewer_while_they_drive() {
        let digest = Digest([0xff; 4]);
        let scores: Scores<K> =
            (0..K as u8).map(|policy| Score { delay: 100 + policy, price: 200 }).collect();
        let choice = Some(Choice { policy: 15, probability: 255 });
        let length =
            |team: usize, left_out: usize, answer: &Answer<K>| framed(&mission(team, left_out, answer)).len();
        let scored = Answer::Scored { digest, scores: scores.clone() };
        let decided = Answer::Decided { digest, scores: Some(scores), choice, step: 31 };
        let driving = Answer::Decided { digest, scores: None, choice, step: 31 };
        for (answer, most) in [(&scored, 85), (&decided, 89), (&driving, 53), (&Answer::Listing(16), 53)] {
            let full = length(8, 0, answer);
            println!(
                "{} bytes of at most {most}, {:?}",
                full,
                (1..=4).map(|left_out| length(8, left_out, answer)).collect::<Vec<_>>()
            );
            assert!(full <= most, "{full} bytes: {answer:?}");
            for left_out in 1..=4 {
                assert!(
                    length(8, left_out, answer) <= full + 14 * left_out,
                    "{left_out} left out: {answer:?}"
                );
            }
        }
    }

    #[test]
    fn in_at_most_the_longest_frame() {
        let longest = framed(&largest());
        let content = Intention::MAX_BYTES + "version, sender".split(' ').count() + 5 + 5 + TAG_BYTES;
        assert_eq!(longest.len(), content + 1 + 2, "a byte for COBS, and the delimiters");
        assert!(longest.len() <= 127);
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
        let frame = framed(&driving());
        for length in 0..frame.len() {
            let outcome = encode(&driving(), &AUTH, &mut vec![0; length]).map(<[u8]>::len);
            assert_eq!(outcome, Err(EncodeError::BufferTooSmall), "{length} bytes");
        }
        assert_eq!(encode(&driving(), &AUTH, &mut vec![0; frame.len()]), Ok(&frame[..]));
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
}

/// Bodies that only a holder of the key can have made.
mod although_authentic {
    use super::*;

    #[test]
    fn a_value_out_of_range_is_named() {
        let with = |change: fn(&mut Vec<u8>)| {
            let mut body = body(&driving());
            change(&mut body);
            decode(&sealed(VERSION, &body), &AUTH)
        };
        assert_eq!(with(|_| ()), Ok(driving()));
        for (change, expected) in [
            ((|body| body[0] = MAX_TEAM as u8) as fn(&mut Vec<u8>), DecodeError::Sender),
            (|body| body[7] = MAX_TEAM as u8 + 1, DecodeError::Body), // walls
            (|body| body[9] = 4, DecodeError::Body),                  // purpose
            (|body| body[10] = MAX_EVIDENCE as u8 + 1, DecodeError::Body),
            (|body| body[13] = 3, DecodeError::Body), // answer
            (|body| body[18] = 2, DecodeError::Body), // scores or none
            (|body| body[19] = 2, DecodeError::Body), // choice or none
            (|body| body.push(0), DecodeError::Trailing),
            (|body| body.truncate(body.len() - 1), DecodeError::Body),
        ] {
            assert_eq!(with(change), Err(expected));
        }
    }

    #[test]
    fn what_does_not_fit_the_team_or_the_map_is_named() {
        let with = |change: fn(&mut RoundMessage<Fact<2>, K>)| {
            let mut message = driving().message;
            change(&mut message.0);
            message.check(3, 49)
        };
        let wall = || Blocks::default();
        assert_eq!(with(|_| ()), Ok(()));
        for (change, expected) in [
            ((|said| said.proposal.view = View::full(4)) as fn(&mut RoundMessage<_, K>), Round::STRANGER),
            (|said| said.proposal.view = View::full(2), Round::WALLS),
            (|said| said.answer = Answer::Listing(K as u8 + 1), Round::LISTING),
            (|said| choose(said, K as u8), Round::CHOICE),
            (|said| said.fact.anchor = Cell(49), Intention::OUTSIDE),
            (|said| said.fact.purpose = Purpose::Charge(Cell(49)), Intention::OUTSIDE),
            (|said| said.fact.evidence[0].cell = Cell(49), Intention::OUTSIDE),
        ] {
            assert_eq!(with(change), Err(expected));
        }
        let mut spare = driving().message;
        spare.0.proposal.walls.push(wall()).expect("there is room");
        assert_eq!(spare.check(3, 49), Err(Round::WALLS));
        choose(&mut spare.0, K as u8 - 1);
        spare.0.proposal.walls.clear();
        assert_eq!(spare.check(3, 49), Ok(()));
    }

    type Round = RoundMessage<Fact<2>, K>;

    fn choose(said: &mut Round, policy: u8) {
        if let Answer::Decided { choice, .. } = &mut said.answer {
            *choice = Some(Choice { policy, probability: 0 });
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
            let mut said = driving();
            change(&mut said);
            encode(&said, &AUTH, &mut [0; MAX_FRAME]).map(<[u8]>::len)
        };
        assert!(refused(|_| ()).is_ok());
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
                // The delimiter before the first frame is not missed at the beginning of a stream only if it turns
                // into a byte of the frame; the one after it has another behind it.
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
        receive(&mut roster, body_of(&framed(&driving())), Instant(0)).unwrap();
        for _ in 0..10_000 {
            let length = random.below(40);
            receive(&mut roster, &random.bytes(length), Instant(1)).unwrap_err();
        }
        assert_eq!((roster.counters().accepted, roster.counters().refused()), (1, 10_000));
        assert_eq!(roster.peer(RobotId(2)).map(|peer| peer.envelope().clone()), Some(driving()));
    }
}

/// The context that `driving` is pinned in.
const GOLDEN_CONTEXT: u64 = 16_654_270_162_135_346_735;
const GOLDEN_TAG: [u8; TAG_BYTES] = [50, 123, 157, 183, 240, 71, 101, 89];

/// After five moves, half-way through a mission.
fn driving() -> Said {
    let evidence = [CellEvidence { cell: Cell(23), weight: 64 }].into_iter().collect();
    let choice = Some(Choice { policy: 3, probability: 191 });
    let message = RoundMessage {
        proposal: Proposal { round: 300, ..Proposal::first(3) },
        fact: Fact { anchor: Cell(8), purpose: Purpose::Goal, evidence },
        answer: Answer::Decided { digest: Digest([1, 2, 3, 4]), scores: None, choice, step: 5 },
    };
    let stamp = Stamp { epoch: 3, sequence: 200 };
    Said { sender: RobotId(2), stamp, message: iibt_core::navigation::Intention(message) }
}

/// A robot of a team on its way to a way-point, with evidence on four cells; so many teammates are left out.
fn mission(team: usize, left_out: usize, answer: &Answer<K>) -> Said {
    let view: View = (left_out as u8..team as u8).map(RobotId).collect();
    let wall = || Cells::<8>((100..).step_by(9).take(10).map(Cell).collect()).to_wire(left_out);
    let evidence = (200..).take(MAX_EVIDENCE).map(|cell| CellEvidence { cell: Cell(cell), weight: -64 });
    let message = RoundMessage {
        proposal: Proposal { round: 300, view, walls: (0..left_out).map(|_| wall()).collect() },
        fact: Fact { anchor: Cell(200), purpose: Purpose::Visit(Cell(201)), evidence: evidence.collect() },
        answer: answer.clone(),
    };
    let stamp = Stamp { epoch: 40, sequence: 100_000 };
    Said { sender: RobotId(7), stamp, message: iibt_core::navigation::Intention(message) }
}

/// The highest cell that a map can have.
const LAST: Cell = Cell((1 << 14) - 1);

/// Every number as large as it can be, which is what takes the most bytes.
fn largest() -> Said {
    let wall = Cells::<2>([0, 63].map(Cell).into_iter().collect());
    let view: View = (3..MAX_TEAM as u8).map(RobotId).collect();
    let proposal = Proposal { round: u32::MAX, view, walls: (0..3).map(|_| wall.to_wire(3)).collect() };
    let evidence = [CellEvidence { cell: LAST, weight: i8::MIN }; MAX_EVIDENCE].into_iter().collect();
    let fact = Fact { anchor: LAST, purpose: Purpose::Charge(LAST), evidence };
    let answer = Answer::Decided {
        digest: Digest([0xff; 4]),
        scores: Some([Score::CANNOT; K].into_iter().collect()),
        choice: Some(Choice { policy: K as u8 - 1, probability: u8::MAX }),
        step: u16::MAX,
    };
    let stamp = Stamp { epoch: u32::MAX, sequence: u32::MAX };
    let message = iibt_core::navigation::Intention(RoundMessage { proposal, fact, answer });
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
    Cell(number(random) as u16 & LAST.0)
}

/// Any valid message of a team of eight.
pub(crate) fn intention(random: &mut Random) -> Said {
    let message = RoundMessage { proposal: proposal(random), fact: fact(random), answer: answer(random) };
    let stamp = Stamp { epoch: number(random), sequence: number(random) };
    let sender = RobotId(random.below(MAX_TEAM) as u8);
    Said { sender, stamp, message: iibt_core::navigation::Intention(message) }
}

/// A proposal of a team of eight, of which up to four are left out.
fn proposal(random: &mut Random) -> Proposal<Cells<2>> {
    let left_out = random.below(5);
    let view: View = (left_out as u8..8).map(RobotId).collect();
    let wall = |random: &mut Random| {
        let cells: CellSet<2> = (0..random.below(12)).map(|_| Cell(random.below(64) as u16)).collect();
        Cells(cells).to_wire(left_out)
    };
    Proposal { round: number(random), view, walls: (0..left_out).map(|_| wall(random)).collect() }
}

fn fact(random: &mut Random) -> Fact<2> {
    let (anchor, target) = (cell(random), cell(random));
    let purpose =
        [Purpose::Goal, Purpose::Visit(target), Purpose::Charge(target), Purpose::Stand][random.below(4)];
    let known = |random: &mut Random| CellEvidence { cell: cell(random), weight: random.bits() as i8 };
    let evidence = (0..random.below(MAX_EVIDENCE + 1)).map(|_| known(random)).collect();
    Fact { anchor, purpose, evidence }
}

fn answer(random: &mut Random) -> Answer<K> {
    let digest = Digest(random.bits().to_le_bytes());
    let score = |random: &mut Random| Score { delay: random.bits() as u8, price: random.bits() as u8 };
    let scores: Scores<K> = (0..1 + random.below(K)).map(|_| score(random)).collect();
    let policy = random.below(scores.len()) as u8;
    match random.below(4) {
        0 => Answer::Listing(random.below(K + 1) as u8),
        1 => Answer::Scored { digest, scores },
        kind => Answer::Decided {
            digest,
            scores: Some(scores).filter(|_| kind == 2),
            choice: random.bernoulli(0.9).then(|| Choice { policy, probability: random.bits() as u8 }),
            step: number(random) as u16,
        },
    }
}
