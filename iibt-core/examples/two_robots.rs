//! Two robots that agree: each is to reach another of two goals, and both arrive together.
//!
//! Nobody assigns the goals. From what they tell each other in authenticated frames both make the
//! same list of joint policies, weigh them, and follow the same one. `cargo run -p
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
/// The steps of a plan, its start included.
const LAYERS: usize = 17;
/// The nodes of a search for robots that own their goals.
const NODES: usize = 16;
/// The joint policies to weigh.
const POLICIES: usize = 4;

type Task<'m> = Navigation<'m, CELLS, WORDS, LAYERS, NODES, POLICIES>;
type Message = Intention<WORDS, POLICIES>;

/// A robot without hardware: it reads its cell, and its moves are made.
struct Robot<'m> {
    cell: Cell,
    task: Task<'m>,
    node: InferenceNode<Task<'m>>,
    roster: Roster<Message>,
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
    let mut robots = [Robot::new(&mission, 0), Robot::new(&mission, 1)];
    let auth = SipHash64::new(Key::new(*b"sixteen bytes..."));
    let context = Context::of::<Message>(0, robots[0].task.mission_id());
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
            on_air[1 - number] = [0; MAX_FRAME];
            // A robot that does not know yet where it stands says nothing.
            let Some(message) = robot.task.intention(robot.roster.at(now)) else { continue };
            let stamp = robot.numbering.next_stamp().expect("there are numbers left");
            let said = Envelope { sender: RobotId(number as u8), stamp, message };
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
    assert!(robots.iter().all(|robot| robot.task.report().stage == Stage::Arrived), "after {ticks} ticks");
    let reached = robots.each_ref().map(|robot| robot.cell);
    assert!(reached == goals || reached == [goals[1], goals[0]], "each is on a goal of its own: {reached:?}");
}

play!(play);
