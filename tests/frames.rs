//! Frames as they travel: what was sent arrives, and nothing else does.

mod although_authentic;
mod arrives;
mod fits_small_packets;
mod in_a_stream;
mod is_refused;

use host_sim::Random;
use iibt_core::grid::{Cell, CellSet};
use iibt_core::navigation::{
    Announced, Blocks, CellEvidence, Cells, Fact, MAX_EVIDENCE, PendingWaypoints, Purpose,
};
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

/// A message of a robot without other way-points than one that its fact names.
fn intends(rounds: RoundMessage<Fact<2>, K>) -> Intention {
    Intention { rounds, waypoints: PendingWaypoints::new() }
}

/// The context that `driving` is pinned in.
const GOLDEN_CONTEXT: u64 = 10_710_599_746_138_331_545;
const GOLDEN_TAG: [u8; TAG_BYTES] = [17, 192, 44, 125, 46, 118, 113, 182];

/// After five moves, half-way through a mission.
fn driving() -> Said {
    let evidence = [CellEvidence { cell: Cell(23), weight: 64 }].into_iter().collect();
    let choice = Some(Choice { policy: 3, probability: 191 });
    let message = RoundMessage {
        proposal: Proposal { round: 300, ..Proposal::first(3) },
        fact: Fact { anchor: Cell(8), evidence, ..Fact::default() },
        answer: Answer::Decided { digest: Digest([1, 2, 3, 4]), scores: None, choice, step: 5 },
    };
    let stamp = Stamp { epoch: 3, sequence: 200 };
    Said { sender: RobotId(2), stamp, message: intends(message) }
}

/// A robot of a team on its way to a way-point, with evidence on four cells, and the number of
/// teammates that are left out.
fn mission(team: usize, left_out: usize, answer: &Answer<K>) -> Said {
    let view: View = (left_out as u8..team as u8).map(RobotId).collect();
    let wall = || Cells::<8>((100..).step_by(9).take(10).map(Cell).collect()).to_wire(left_out);
    let evidence = (200..).take(MAX_EVIDENCE).map(|cell| CellEvidence { cell: Cell(cell), weight: -64 });
    let message = RoundMessage {
        proposal: Proposal { round: 300, view, walls: (0..left_out).map(|_| wall()).collect() },
        fact: Fact {
            anchor: Cell(200),
            purpose: Purpose::Visit(Cell(201)),
            evidence: evidence.collect(),
            ..Fact::default()
        },
        answer: answer.clone(),
    };
    let stamp = Stamp { epoch: 40, sequence: 100_000 };
    Said { sender: RobotId(7), stamp, message: intends(message) }
}

/// The highest cell that a map can have.
const LAST: Cell = Cell((1 << 14) - 1);

/// Every number as large as it can be, which is what takes the most bytes.
fn largest() -> Said {
    let wall = Cells::<2>([0, 63].map(Cell).into_iter().collect());
    let view: View = (3..MAX_TEAM as u8).map(RobotId).collect();
    let proposal = Proposal { round: u32::MAX, view, walls: (0..3).map(|_| wall.to_wire(3)).collect() };
    let evidence = [CellEvidence { cell: LAST, weight: i8::MIN }; MAX_EVIDENCE].into_iter().collect();
    let fact = Fact { anchor: LAST, purpose: Purpose::Charge(LAST), evidence, ..Fact::default() };
    let answer = Answer::Decided {
        digest: Digest([0xff; 4]),
        scores: Some([Score::CANNOT; K].into_iter().collect()),
        choice: Some(Choice { policy: K as u8 - 1, probability: u8::MAX }),
        step: u16::MAX,
    };
    let stamp = Stamp { epoch: u32::MAX, sequence: u32::MAX };
    let message = intends(RoundMessage { proposal, fact, answer });
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
    let rounds = RoundMessage { proposal: proposal(random), fact: fact(random), answer: answer(random) };
    let stamp = Stamp { epoch: number(random), sequence: number(random) };
    let sender = RobotId(random.below(MAX_TEAM) as u8);
    let Fact { evidence, readings, .. } = &rounds.fact;
    let room = MAX_EVIDENCE - readings.len().div_ceil(2) - evidence.len();
    let waypoints = (0..random.below(room + 1)).map(|_| cell(random)).collect();
    Said { sender, stamp, message: Intention { rounds, waypoints } }
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
    let evidence: Announced = (0..random.below(MAX_EVIDENCE + 1)).map(|_| known(random)).collect();
    // Readings take the room of evidence.
    let most = 2 * (MAX_EVIDENCE - evidence.len());
    let readings = (0..random.below(most + 1)).map(|_| random.bits() as u8).collect();
    Fact { anchor, purpose, evidence, readings }
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
