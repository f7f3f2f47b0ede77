//! docs/protocol.md is enough: a script that is written from it exchanges frames with ours.

use super::frames::intention;
use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::{EventEffect, Faults, NavigatorFlight, Random};
use iibt_core::grid::{Cell, CellSet, Map};
use iibt_core::navigation::{CellEvidence, Cells, Fact, Intention, Mission, Purpose, Stage};
use iibt_core::team::rounds::{Answer, Choice, Claim, Digest, Proposal, RoundMessage, Score, View};
use iibt_core::team::{
    Context, DecodeError, Envelope, Fnv1a, FrameAuth, Key, MAX_FRAME, Message, RobotId, SipHash64, Stamp,
    TAG_BYTES, VERSION, decode, encode,
};
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/second_implementation/frame.py");
const DOCUMENT: &str = include_str!("../docs/protocol.md");

type Said = Envelope<Intention<2, POLICIES>>;
type Team<'m> = NavigatorFlight<'m, 49, 2, LAYERS, NODES, POLICIES>;

/// What robots must share to read each other's frames.
#[derive(Clone, Copy)]
struct Shared {
    key: [u8; 16],
    channel: u32,
    mission: u64,
    robots: usize,
    cells: usize,
}

impl Shared {
    fn of(team: &Team<'_>) -> Self {
        let mission = team.robot(0).robot().navigation().mission_id();
        Self { key: KEY, channel: 0, mission, robots: team.cells().len(), cells: team.floor().len() }
    }

    fn auth(&self) -> SipHash64 {
        SipHash64::new(Key::new(self.key))
    }

    fn context(&self) -> Context {
        Context::of::<Intention<2, POLICIES>>(self.channel, self.mission)
    }

    /// What a robot makes of a frame with its delimiters.
    fn read(&self, frame: &[u8]) -> Result<Said, DecodeError> {
        let said: Said = decode(&frame[1..frame.len() - 1], &self.auth(), self.context())?;
        if said.sender.index() >= self.robots {
            return Err(DecodeError::Sender);
        }
        said.message.check(self.robots, self.cells).map_err(DecodeError::Invalid)?;
        Ok(said)
    }

    fn write(&self, said: &Said) -> Vec<u8> {
        encode(said, &self.auth(), self.context(), &mut [0; MAX_FRAME]).expect("it is valid").to_vec()
    }

    /// What the script answers, line by line, and its reasons for refusing.
    fn ask(&self, command: &str, lines: &[String]) -> (Vec<String>, Vec<String>) {
        let numbers = [self.channel.into(), self.mission, self.robots as u64, self.cells as u64];
        let [channel, mission, robots, cells] = numbers.map(|number| number.to_string());
        let (key, policies) = (hex(&self.key), POLICIES.to_string());
        let mut script = Command::new("python3")
            .args(["-B", SCRIPT, command, "--key", &key, "--channel", &channel, "--mission", &mission])
            .args(["--robots", &robots, "--cells", &cells, "--policies", &policies])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("python3 is needed, and tests/run installs it: {error}"));
        let mut input = script.stdin.take().expect("it is piped");
        let text = lines.join("\n") + "\n";
        let output = std::thread::scope(|scope| {
            scope.spawn(move || input.write_all(text.as_bytes()).expect("it reads all lines"));
            script.wait_with_output().expect("it ends")
        });
        let [answers, reasons] = [output.stdout, output.stderr].map(|bytes| {
            String::from_utf8(bytes).expect("text").lines().map(String::from).collect::<Vec<_>>()
        });
        assert_eq!(answers.len(), lines.len(), "{reasons:?}");
        assert_eq!(output.status.code(), Some(i32::from(!reasons.is_empty())), "{reasons:?}");
        (answers, reasons)
    }

    /// The answers where no line may be refused.
    fn asked(&self, command: &str, lines: &[String]) -> Vec<String> {
        let (answers, reasons) = self.ask(command, lines);
        assert!(reasons.is_empty(), "{reasons:?}");
        answers
    }
}

const KEY: [u8; 16] = *b"two of one team.";

/// Two robots that cross an open floor.
fn two_robots() -> Mission<'static, 2> {
    static STARTS: [Cell; 2] = [Cell(0), Cell(42)];
    static GOALS: [Cell; 2] = [Cell(48), Cell(6)];
    Mission::new(Map::new(7, 7).expect("49 cells fit two words"), &STARTS, &GOALS)
}

fn team<'m>(mission: &'m Mission<'m, 2>) -> Team<'m> {
    Team::with_key(mission, Key::new(KEY), Faults::default(), 1).expect("a sound mission")
}

fn visit(team: &mut Team<'_>, robot: usize, cell: u16) {
    team.robot_mut(robot).robot_mut().navigation_mut().visit(Cell(cell)).expect("it is free");
}

fn fly(team: &mut Team<'_>, ticks: usize, frames: &mut Vec<Vec<u8>>) {
    for _ in 0..ticks {
        team.tick();
        (0..2).for_each(|robot| frames.extend_from_slice(team.sent(robot)));
    }
}

/// All frames of a flight with an obstacle, way-points and a robot that dies.
fn recorded() -> (Shared, Vec<Vec<u8>>) {
    let mission = two_robots();
    let (mut team, mut frames) = (team(&mission), vec![]);
    while team.reports().iter().any(|report| report.stage != Stage::Agreed) {
        fly(&mut team, 1, &mut frames);
    }
    let beside = team.cells()[0].0 + 8;
    team.cause(EventEffect::Block(Cell(beside)));
    fly(&mut team, 2, &mut frames);
    visit(&mut team, 1, 38);
    fly(&mut team, 12, &mut frames);
    team.cause(EventEffect::Stop(1, None));
    visit(&mut team, 0, 3);
    fly(&mut team, 60, &mut frames);
    assert_eq!(team.collisions().total(), 0);
    (Shared::of(&team), frames)
}

/// Reads all that robots in flight send, field by field, and writes the very same bytes.
#[test]
fn the_script_reads_every_frame_of_robots_in_flight() {
    let (shared, frames) = recorded();
    let ours: Vec<Said> = frames.iter().map(|frame| shared.read(frame).expect("sent by a robot")).collect();
    let theirs = shared.asked("decode", &frames.iter().map(|frame| hex(frame)).collect::<Vec<_>>());
    for (ours, theirs) in ours.iter().zip(&theirs) {
        assert_eq!(as_json(ours, Some(shared.cells)), parsed(theirs));
    }
    let lines: Vec<_> = ours.iter().map(|said| as_json(said, None).to_string()).collect();
    let rewritten = shared.asked("encode", &lines);
    assert!(rewritten.iter().eq(&frames.iter().map(|frame| hex(frame)).collect::<Vec<_>>()));

    let rounds = || ours.iter().map(|said| &said.message.rounds);
    assert!(rounds().any(|said| !said.proposal.walls.is_empty()), "a robot was left out");
    assert!(rounds().any(|said| !said.fact.evidence.is_empty()), "an obstacle was seen");
    assert!(rounds().any(|said| matches!(said.fact.purpose, Purpose::Visit(_))), "a way-point");
    assert!(rounds().any(|said| matches!(said.answer, Answer::Listing(_))));
    assert!(rounds().any(|said| matches!(said.answer, Answer::Scored { .. })));
    for sends in [true, false] {
        assert!(
            rounds().any(|said| matches!(said.answer, Answer::Decided { .. })
                && said.answer.scores().is_some() == sends)
        );
    }
}

#[test]
fn the_script_computes_the_digests_of_robots_in_flight() {
    let (shared, frames) = recorded();
    let said: Vec<_> = frames
        .iter()
        .map(|frame| (frame, shared.read(frame).expect("sent by a robot").message.rounds))
        .collect();
    let (mut lines, mut expected) = (vec![], vec![]);
    for (_, message) in &said {
        let Some(Digest(digest)) = message.answer.digest() else { continue };
        let members = message.proposal.view.iter().map(|robot| {
            let is_member = |frame: &[u8]| shared.read(frame).is_ok_and(|said| said.sender == robot);
            let of_round =
                said.iter().find(|(frame, other)| other.proposal == message.proposal && is_member(frame));
            hex(of_round.expect("every member has sent its fact").0)
        });
        lines.push(members.collect::<Vec<_>>().join(" "));
        expected.push(hex(&digest));
    }
    assert_eq!(shared.asked("digest", &lines), expected);
    expected.dedup();
    assert!(expected.len() >= 3, "the first round, the way-point's, and that without a robot: {expected:?}");
}

/// The two hear each other through the script alone.
#[test]
fn robots_that_hear_only_the_script_arrive() {
    let mission = two_robots();
    let mut team = team(&mission);
    let shared = Shared::of(&team);
    (0..2).for_each(|robot| team.silence(robot, true));
    while !team.has_arrived() {
        assert!(team.ticks() < 40, "they do not arrive");
        team.tick();
        let frames = [0, 1].map(|robot| team.sent(robot).iter().map(|frame| hex(frame)).collect::<Vec<_>>());
        let read = shared.asked("decode", &frames.concat());
        let lines: Vec<_> = read.iter().map(|line| without_cells(parsed(line)).to_string()).collect();
        let written = shared.asked("encode", &lines);
        assert_eq!(written, frames.concat());
        let (of_first, of_second) = written.split_at(frames[0].len());
        of_first.iter().for_each(|frame| team.deliver(1, &bytes(frame)));
        of_second.iter().for_each(|frame| team.deliver(0, &bytes(frame)));
    }
    assert_eq!(team.collisions().total(), 0);
}

/// A team of eight on the largest map.
const EIGHT: Shared = Shared { key: KEY, channel: 3, mission: u64::MAX - 4, robots: 8, cells: 1 << 14 };

#[test]
fn what_the_script_writes_is_read_here() {
    let mut random = Random::new(21);
    let said: Vec<_> = (0..1_000).map(|_| intention(&mut random)).collect();
    let lines: Vec<_> = said.iter().map(|said| as_json(said, None).to_string()).collect();
    for (frame, said) in EIGHT.asked("encode", &lines).iter().zip(said) {
        assert_eq!(EIGHT.read(&bytes(frame)), Ok(said));
    }
}

#[test]
fn both_refuse_what_is_damaged_or_of_another_team_for_the_same_reason() {
    let frame = EIGHT.write(&intention(&mut Random::new(22)));
    let mut damaged: Vec<Vec<u8>> = vec![];
    for bit in 8..8 * (frame.len() - 1) {
        let mut flipped = frame.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        damaged.push(flipped);
    }
    for cut in 1..frame.len() - 1 {
        damaged.push([&frame[..cut], &[0]].concat());
    }
    damaged.push([&[0][..], &[1; MAX_FRAME - 1], &[0]].concat());
    refused_by_both(&EIGHT, &damaged);
    let others = [
        Shared { key: *b"two of one team?", ..EIGHT },
        Shared { channel: 4, ..EIGHT },
        Shared { mission: 1, ..EIGHT },
    ];
    others.iter().for_each(|other| refused_by_both(other, std::slice::from_ref(&frame)));
}

/// Bodies with a valid tag, in which up to three bytes are any: both read the same or refuse.
#[test]
fn both_make_the_same_of_any_authentic_body() {
    let mut random = Random::new(23);
    let frames: Vec<_> = (0..3_000).map(|_| authentic(&mut random)).collect();
    let ours: Vec<_> = frames.iter().map(|frame| EIGHT.read(frame)).collect();
    let (theirs, reasons) = EIGHT.ask("decode", &frames.iter().map(|frame| hex(frame)).collect::<Vec<_>>());
    let mut reasons = reasons.iter();
    for (ours, theirs) in ours.iter().zip(&theirs) {
        match ours {
            Ok(said) => assert_eq!(without_cells(parsed(theirs)), as_json(said, None)),
            Err(error) => assert_refused(error, theirs, reasons.next()),
        }
    }
    let accepted = ours.iter().filter(|read| read.is_ok()).count();
    assert!((300..2_700).contains(&accepted), "{accepted} of 3,000 are valid");
}

/// A message that lacks a value, or has one that no field can hold.
#[test]
fn both_refuse_to_write_what_is_no_message() {
    let whole = as_json(&example(), None);
    let mut lines = vec![];
    for path in
        ["/sender", "/epoch", "/sequence", "/message/rounds/proposal/round", "/message/rounds/proposal/view"]
    {
        for wrong in [json!(-1), json!(1_u64 << 32), json!(1.5), json!("1"), Value::Null] {
            lines.push(changed(&whole, path, wrong));
        }
    }
    for (path, wrong) in [
        ("/message/rounds/fact/evidence/0/weight", json!(128)),
        ("/message/rounds/fact/evidence/0/cell", json!(1 << 16)),
        ("/message/rounds/fact/purpose", json!("Visit")),
        ("/message/rounds/fact/purpose", json!({ "Rest": 1 })),
        ("/message/rounds/fact", json!({ "anchor": 8, "purpose": "Goal" })),
        ("/message/rounds/fact/readings", json!(vec![0; 9])),
        ("/message/rounds/fact/readings", json!([256])),
        ("/message/rounds/answer", json!({ "Scored": { "digest": [1, 2, 3], "scores": [] } })),
        ("/message/rounds/answer", json!({ "Listing": 256 })),
        ("/message/waypoints/0", json!(1 << 16)),
        ("/message/waypoints", json!([1, 2, 3, 4, 5])),
        ("/message/rounds/proposal/walls/0/bits", json!(vec![0; 12])),
        ("/message/rounds/fact/evidence", json!(vec![json!({ "cell": 1, "weight": 1 }); 5])),
        (
            "/message/rounds/answer/Decided/scores",
            json!(vec![json!({ "delay": 1, "price": 1 }); POLICIES + 1]),
        ),
    ] {
        lines.push(changed(&whole, path, wrong));
    }
    let (answers, reasons) = EXAMPLE.ask("encode", &lines.iter().map(Value::to_string).collect::<Vec<_>>());
    assert!(answers.iter().all(String::is_empty) && reasons.len() == lines.len(), "{answers:?}");
    for line in lines {
        let header = ["sender", "epoch", "sequence"].map(|name| line[name].as_u64());
        let is_header = header.iter().all(|number| number.is_some_and(|number| number < 1 << 32));
        let message = serde_json::from_value::<Intention<2, POLICIES>>(line["message"].clone());
        assert!(!is_header || message.is_err(), "{line}");
    }
}

/// The team of the worked example in the document.
const EXAMPLE: Shared = Shared {
    key: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15],
    channel: 3,
    mission: 0x51,
    robots: 3,
    cells: 256,
};

#[test]
fn the_example_of_the_document_is_what_both_write() {
    let blocks: Vec<_> =
        DOCUMENT.split("```text\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let block = |start: &str| *blocks.iter().find(|block| block.starts_with(start)).expect(start);
    let (pieces, frame) = (block("02 "), block("00").trim());
    assert_eq!(frame, hex(&EXAMPLE.write(&example())));
    let plain: String = pieces.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(frame, hex(&stuffed(&bytes(&plain))));
    let theirs = EXAMPLE.asked("encode", &[as_json(&example(), None).to_string()]);
    assert_eq!(theirs, [frame]);

    let layout = block("sender u8").trim();
    assert!(layout.ends_with(Intention::<2, POLICIES>::SCHEMA), "{layout}");
    let context = Fnv1a::EMPTY.write(layout.as_bytes()).write(&3_u32.to_le_bytes());
    let context = context.write(&0x51_u64.to_le_bytes()).finish();
    assert_eq!(context, EXAMPLE.context().to_bits());
    assert!(DOCUMENT.contains(&format!("`{context:016x}`")), "{context:016x}");

    let mut other = example();
    (other.sender, other.stamp.epoch) = (RobotId(0), 1);
    other.message.rounds.fact = Fact { anchor: Cell(5), ..Fact::default() };
    let line = format!("{frame} {}", hex(&EXAMPLE.write(&other)));
    assert_eq!(EXAMPLE.asked("digest", &[line]), [hex(&DIGEST)]);
}

const DIGEST: [u8; 4] = [0x62, 0x64, 0x59, 0x1a];

/// The message of the worked example.
fn example() -> Said {
    let wall: CellSet<2> = [9, 12, 16].map(Cell).into_iter().collect();
    let view = View::full(3).without(RobotId(1));
    let proposal = Proposal { round: 300, view, walls: [Cells(wall).to_wire(1)].into_iter().collect() };
    let evidence = [(23, 64), (130, -48)].map(|(cell, weight)| CellEvidence { cell: Cell(cell), weight });
    let fact = Fact {
        anchor: Cell(8),
        purpose: Purpose::Visit(Cell(200)),
        evidence: evidence.into_iter().collect(),
        ..Fact::default()
    };
    let scores = [Score { delay: 8, price: 0 }, Score { delay: 0, price: 3 }, Score::CANNOT];
    let answer = Answer::Decided {
        digest: Digest(DIGEST),
        scores: Some(scores.into_iter().collect()),
        choice: Some(Choice { policy: 1, probability: 191 }),
        step: 5,
    };
    let stamp = Stamp { epoch: 3, sequence: 200 };
    let waypoints = [40].map(Cell).into_iter().collect();
    let message = Intention { rounds: RoundMessage { proposal, fact, answer }, waypoints };
    Said { sender: RobotId(2), stamp, message }
}

/// A message in JSON; with the cells of its walls, by the number of cells of the map.
fn as_json(said: &Said, cells: Option<usize>) -> Value {
    let Envelope { sender, stamp, message } = said;
    let (epoch, sequence) = (stamp.epoch, stamp.sequence);
    let mut value = json!({ "sender": sender.0, "epoch": epoch, "sequence": sequence, "message": message });
    if let Some(limit) = cells {
        let walls = message.rounds.proposal.walls.iter().map(Cells::<2>::from_wire);
        let on_map = |wall: Cells<2>| {
            wall.0.iter().map(|cell| cell.0).filter(|&cell| usize::from(cell) < limit).collect::<Vec<_>>()
        };
        value["cells"] = json!(walls.map(on_map).collect::<Vec<_>>());
    }
    value
}

fn parsed(line: &str) -> Value {
    serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))
}

fn without_cells(mut said: Value) -> Value {
    said.as_object_mut().expect("an object").remove("cells");
    said
}

fn changed(said: &Value, path: &str, value: Value) -> Value {
    let mut said = said.clone();
    *said.pointer_mut(path).unwrap_or_else(|| panic!("{path}")) = value;
    said
}

fn refused_by_both(shared: &Shared, frames: &[Vec<u8>]) {
    let (theirs, reasons) = shared.ask("decode", &frames.iter().map(|frame| hex(frame)).collect::<Vec<_>>());
    assert_eq!(reasons.len(), frames.len());
    for ((frame, theirs), reason) in frames.iter().zip(&theirs).zip(&reasons) {
        assert_refused(&shared.read(frame).expect_err("it is damaged"), theirs, Some(reason));
    }
}

/// The script has refused a line, for our reason.
fn assert_refused(ours: &DecodeError, answer: &str, reason: Option<&String>) {
    let reason = reason.unwrap_or_else(|| panic!("the script accepts {answer}: {ours}"));
    let word = match ours {
        DecodeError::TooLong => "longer than the longest frame",
        DecodeError::Cobs => "no COBS form",
        DecodeError::TooShort => "too short",
        DecodeError::Version(_) => "version",
        DecodeError::Tag => "wrong tag",
        DecodeError::Body => "", // it names the field
        DecodeError::Trailing => "bytes after the message",
        DecodeError::Sender => "the sender is not in the team",
        DecodeError::Invalid(invalid) => invalid.0,
    };
    assert!(answer.is_empty() && reason.contains(word), "{ours}, the script: {reason}, {answer}");
}

/// A frame with a valid tag around a valid body in which up to three bytes have been changed.
fn authentic(random: &mut Random) -> Vec<u8> {
    let frame = EIGHT.write(&intention(random));
    let mut signed = unstuffed(&frame[1..frame.len() - 1]);
    signed.truncate(signed.len() - TAG_BYTES);
    for _ in 0..random.below(4) {
        let at = 1 + random.below(signed.len() - 1);
        match random.below(8) {
            0 => signed.truncate(at.max(2)),
            1 if signed.len() < 100 => signed.push(0),
            _ => signed[at] = random.bits() as u8,
        }
    }
    assert_eq!(signed[0], VERSION);
    let tag = EIGHT.auth().tag(RobotId(signed[1]), EIGHT.context(), &signed);
    stuffed(&[&signed[..], &tag].concat())
}

fn stuffed(plain: &[u8]) -> Vec<u8> {
    let runs = plain.split(|&byte| byte == 0).flat_map(|run| [&[run.len() as u8 + 1], run].concat());
    std::iter::once(0).chain(runs).chain([0]).collect()
}

fn unstuffed(mut stuffed: &[u8]) -> Vec<u8> {
    let mut runs = vec![];
    while let Some((&code, rest)) = stuffed.split_first() {
        let (run, rest) = rest.split_at(usize::from(code) - 1);
        runs.push(run);
        stuffed = rest;
    }
    runs.join(&0)
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn bytes(hex: &str) -> Vec<u8> {
    let pairs = hex.as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).expect("digits"));
    pairs.map(|pair| u8::from_str_radix(pair, 16).expect("hexadecimal")).collect()
}
