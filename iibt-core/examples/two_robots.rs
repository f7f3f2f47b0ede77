//! Two robots that agree: each is to reach another of two goals, and both arrive together.
//!
//! Nobody assigns the goals. Each robot infers from its own beliefs and the other's announced
//! intention, and what they tell each other travels as authenticated frames. `cargo run -p
//! iibt-core --example two_robots`
#![cfg_attr(target_os = "none", no_std, no_main)]

#[macro_use]
mod chip;

use iibt_core::grid::{Cell, Map};
use iibt_core::iibt::InferenceNode;
use iibt_core::navigation::{GridPercept, Intention, Mission, Navigation, Stage};
use iibt_core::team::{
    Context, Deframer, Envelope, Key, Limits, MAX_FRAME, Member, Numbering, RobotId, Roster, SipHash64,
    encode,
};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;

const CELLS: usize = 15;
const WORDS: usize = iibt_core::grid::words(5, 3);
const POLICIES: usize = 8;

type Task<'m> = Navigation<'m, CELLS, WORDS, POLICIES>;

/// A robot without hardware: it reads its cell, and its moves are made.
struct Robot<'m> {
    cell: Cell,
    task: Task<'m>,
    node: InferenceNode<Task<'m>>,
    roster: Roster<Intention>,
    deframer: Deframer,
    numbering: Numbering,
}

impl<'m> Robot<'m> {
    fn new(mission: &'m Mission<'m, WORDS>, number: u8) -> Self {
        let member = Member::new(RobotId(number), 2).unwrap();
        Self {
            cell: mission.starts[usize::from(number)],
            task: Navigation::new(mission, member, 1).unwrap(),
            node: InferenceNode::new(Duration(100)),
            roster: Roster::new(member, Limits::for_beacons(Duration(1)).unwrap()),
            deframer: Deframer::new(),
            numbering: Numbering::new(1),
        }
    }
}

fn play() {
    let map = Map::<WORDS>::drawn(".....\n.....\n.....").unwrap();
    let (starts, goals) = ([Cell(0), Cell(10)], [Cell(4), Cell(14)]);
    let mission = Mission::new(map, &starts, &goals);
    let (auth, context) =
        (SipHash64::new(Key::new(*b"sixteen bytes...")), Context::of::<Intention>(0, mission.id()));
    let mut robots = [Robot::new(&mission, 0), Robot::new(&mission, 1)];
    // The frame on its way to each robot.
    let mut on_air = [[0; MAX_FRAME]; 2];
    let (mut statuses, mut ticks) = ([Status::Running; 2], 0);
    while statuses != [Status::Success; 2] && ticks < 40 {
        let now = Instant(ticks);
        for (robot, frame) in robots.iter_mut().zip(&on_air) {
            for &byte in frame {
                if let Some(frame) = robot.deframer.feed(byte) {
                    robot.roster.receive(frame, &auth, context, now, |_| Ok(())).unwrap();
                }
            }
        }
        for (number, robot) in robots.iter_mut().enumerate() {
            let percept = GridPercept { reading: Some(robot.cell), ..GridPercept::default() };
            statuses[number] = robot.node.tick(&mut robot.task, &percept, robot.roster.at(now), now);
            let stamp = robot.numbering.next_stamp().expect("there are numbers left");
            let said = Envelope { sender: RobotId(number as u8), stamp, message: robot.task.intention() };
            on_air[1 - number] = [0; MAX_FRAME];
            encode(&said, &auth, context, &mut on_air[1 - number]).unwrap();
        }
        let before = robots.each_ref().map(|robot| robot.cell);
        for robot in &mut robots {
            if let Some(step) = robot.task.command() {
                robot.cell = map.neighbour(robot.cell, step);
            }
        }
        let [one, other] = robots.each_ref().map(|robot| robot.cell);
        assert!(one != other && [one, other] != [before[1], before[0]], "nobody collides");
        show!("tick {ticks}: {one:?} {other:?}");
        ticks += 1;
    }
    assert!(robots.iter().all(|robot| robot.task.stage() == Stage::Arrived), "after {ticks} ticks");
    let reached = robots.each_ref().map(|robot| robot.cell);
    assert!(reached == goals || reached == [goals[1], goals[0]], "each is on a goal of its own: {reached:?}");
}

play!(play);
