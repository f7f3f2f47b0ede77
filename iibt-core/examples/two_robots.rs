//! Two robots that agree: each is to reach another of two goals, and both arrive together.
//!
//! Nobody assigns the goals. Each robot infers from its own beliefs and the other's announced intention, and what they tell each
//! other travels as authenticated frames. `cargo run -p iibt-core --example two_robots`

use iibt_core::grid::{Cell, Map};
use iibt_core::iibt::InferenceNode;
use iibt_core::navigation::{GridPercept, Intention, Mission, Navigation, Stage};
use iibt_core::team::{
    Context, Deframer, Envelope, Key, Limits, MAX_FRAME, Member, Numbering, RobotId, Roster, SipHash64,
    encode,
};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;
use std::error::Error;

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
    fn new(mission: &'m Mission<'m, WORDS>, number: u8) -> Result<Self, Box<dyn Error>> {
        let member = Member::new(RobotId(number), 2)?;
        Ok(Self {
            cell: mission.starts[usize::from(number)],
            task: Navigation::new(mission, member, 1)?,
            node: InferenceNode::new(Duration(100)),
            roster: Roster::new(member, Limits::for_beacons(Duration(1))?),
            deframer: Deframer::new(),
            numbering: Numbering::new(1),
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let map = Map::<WORDS>::drawn(".....\n.....\n.....")?;
    let (starts, goals) = ([Cell(0), Cell(10)], [Cell(4), Cell(14)]);
    let mission = Mission::new(map, &starts, &goals);
    let (auth, context) =
        (SipHash64::new(Key::new(*b"sixteen bytes...")), Context::of::<Intention>(0, mission.id()));
    let mut robots = [Robot::new(&mission, 0)?, Robot::new(&mission, 1)?];
    let mut on_air: Vec<(usize, Vec<u8>)> = vec![];
    let (mut statuses, mut ticks) = ([Status::Running; 2], 0);
    while statuses != [Status::Success; 2] && ticks < 40 {
        let now = Instant(ticks);
        for (receiver, frame) in std::mem::take(&mut on_air) {
            let robot = &mut robots[receiver];
            for byte in frame {
                if let Some(frame) = robot.deframer.feed(byte) {
                    robot.roster.receive(frame, &auth, context, now, |_| Ok(()))?;
                }
            }
        }
        for (number, robot) in robots.iter_mut().enumerate() {
            let percept = GridPercept { reading: Some(robot.cell), ..GridPercept::default() };
            statuses[number] = robot.node.tick(&mut robot.task, &percept, robot.roster.at(now), now);
            let stamp = robot.numbering.next_stamp().ok_or("there are numbers left")?;
            let said = Envelope { sender: RobotId(number as u8), stamp, message: robot.task.intention() };
            let mut buffer = [0; MAX_FRAME];
            on_air.push((1 - number, encode(&said, &auth, context, &mut buffer)?.to_vec()));
        }
        let before = robots.each_ref().map(|robot| robot.cell);
        for robot in &mut robots {
            if let Some(step) = robot.task.command() {
                robot.cell = map.neighbour(robot.cell, step);
            }
        }
        let [one, other] = robots.each_ref().map(|robot| robot.cell);
        assert!(one != other && [one, other] != [before[1], before[0]], "nobody collides");
        println!("tick {ticks}: {one:?} {other:?}");
        ticks += 1;
    }
    assert!(robots.iter().all(|robot| robot.task.stage() == Stage::Arrived), "after {ticks} ticks");
    let reached = robots.each_ref().map(|robot| robot.cell);
    assert!(reached == goals || reached == [goals[1], goals[0]], "each is on a goal of its own: {reached:?}");
    Ok(())
}
