//! Look-outs: a robot goes by a cell first, from which it sees whether another one is blocked.

use super::*;
use host_sim::{Conditions, KEY, Observer, Scenario, Snapshot, TeamFrames, fly};
use iibt_core::navigation::Unknown;

/// A short way to the goals through a gate, a long one without, and a nook from which the gate is
/// seen. The second robot stands between the first one and both ways.
const MAP: &str = "#....##\n#.##..#\n#...#..\n#.###.#\n#.###.#\n#.....#";

const GATE: Cell = Cell(11);
const NOOK: Cell = Cell(17);

fn mission(unknowns: &[Unknown]) -> Mission<'_, 2> {
    static STARTS: [Cell; 2] = [Cell(16), Cell(15)];
    static GOALS: [Cell; 2] = [Cell(19), Cell(20)];
    Mission { unknowns, ..Mission::new(Map::drawn(MAP).expect("42 cells"), &STARTS, &GOALS) }
}

/// The second robot alone.
fn mission_of_one(unknowns: &[Unknown]) -> Mission<'_, 2> {
    let both = mission(unknowns);
    Mission { unknowns, ..Mission::new(both.map, &both.starts[1..], &both.goals[1..]) }
}

fn worth(worth: u8) -> [Unknown; 1] {
    [Unknown { cell: GATE, look_out: NOOK, worth }]
}

/// The cells of both robots, tick by tick, to the end.
fn flown(unknowns: &[Unknown], is_blocked: bool) -> Vec<Vec<u16>> {
    flown_in(&mission(unknowns), is_blocked)
}

fn flown_in(mission: &Mission<'_, 2>, is_blocked: bool) -> Vec<Vec<u16>> {
    let mut team = team(mission);
    if is_blocked {
        team.cause(EventEffect::Block(GATE));
    }
    let tracks = fly_to_the_end(&mut team);
    assert!(on_goals(&team, mission));
    tracks
}

fn looks(tracks: &[Vec<u16>]) -> bool {
    tracks.iter().any(|track| track.contains(&NOOK.0))
}

#[test]
fn a_robot_looks_first_where_that_is_worth_it() {
    for is_blocked in [true, false] {
        let (seeing, blind) = (flown(&worth(4), is_blocked), flown(&[], is_blocked));
        println!("shut {is_blocked}: {} ticks with a look, {} without", seeing[0].len(), blind[0].len());
        assert!(looks(&seeing) && !looks(&blind), "shut {is_blocked}");
        assert!(seeing[0].len() <= blind[0].len() + 4, "{} {}", seeing[0].len(), blind[0].len());
    }
}

/// From cell 15 it takes two moves to the nook and two back.
#[test]
fn no_robot_looks_where_the_way_by_the_look_out_is_longer_than_it_is_worth() {
    let alone = |unknowns: &[Unknown]| flown_in(&mission_of_one(unknowns), false);
    assert_eq!(alone(&worth(3)), alone(&[]));
    assert!(looks(&alone(&worth(5))));
}

/// The first robot has to let the second one pass, and is back from the nook by then.
#[test]
fn a_look_that_takes_no_tick_is_worth_little() {
    let (seeing, blind) = (flown(&worth(1), false), flown(&[], false));
    assert!(looks(&seeing) && !looks(&blind));
    assert_eq!(seeing[0].len(), blind[0].len());
}

#[test]
fn what_a_member_has_seen_is_unknown_no_more() {
    let unknowns = worth(4);
    let mission = mission(&unknowns);
    let mut team = team(&mission);
    team.cause(EventEffect::Block(GATE));
    fly_until(&mut team, "a robot is to look", |team| report(team, 0).look_out == Some(NOOK));
    let first = round(&team);
    fly_until(&mut team, "a round with what it has seen", |team| decided_after(team, first));
    let look = |team: &Team<'_>| assert!(team.reports().iter().all(|report| report.look_out.is_none()));
    fly_watching(&mut team, "all stop", look, stopped);
}

/// Keeps all frames.
struct Frames(Vec<u8>);

impl Observer for Frames {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        self.0.extend(snapshot.frames);
    }
}

#[test]
fn a_scenario_has_unknown_cells_and_frames_tell_who_looks() {
    let map = "#....##\n#.##..#\n#21.#GG\n#.###.#\n#.###.#\n#.....#";
    let text = format!(
        "title = 'a gate'\nmap = '''\n{map}\n'''\n\
         [[unknown]]\ncell = 11\nlook_out = 17\nworth = 4\n[[event]]\ntick = 0\nblock = 11"
    );
    let scenario = Scenario::parse("gate", &text).expect("it is sound");
    let mut frames = Frames(vec![]);
    let record = fly(&scenario, Conditions::default(), &mut frames).expect("it fits");
    assert!(record.outcome.is_success(), "{:?}", record.outcome);
    let told = TeamFrames::read(&scenario, &KEY, &frames.0).expect("a team").to_string();
    let lines: Vec<&str> = told.lines().filter(|line| line.contains("look-out")).collect();
    assert!(lines.len() == 1 && lines[0].contains("R1"), "{told}");
    assert!(lines[0].ends_with(", by the look-out 17"), "{told}");
}
