//! Obstacles that come and go, and teammates that a sensor takes for obstacles.

use super::*;
use firmware::hardware::{Battery, Drive, Localiser, Scanner};
use firmware::{Navigator, Settings};
use host_sim::{KEY, Testbed};
use iibt_core::grid::Move;
use iibt_core::grid::joint::Failure;
use iibt_core::team::Member;
use std::collections::VecDeque;
use std::num::NonZero;

/// A wall across the map with one door, in cell 24.
fn with_a_door() -> Mission<'static, 2> {
    let mut map = open_floor();
    assert!((21..28).filter(|&cell| cell != 24).all(|cell| map.block(Cell(cell))));
    static STARTS: [Cell; 2] = [Cell(2), Cell(4)];
    static GOALS: [Cell; 2] = [Cell(44), Cell(46)];
    Mission::new(map, &STARTS, &GOALS)
}

fn with_a_door_for_three() -> Mission<'static, 2> {
    static STARTS: [Cell; 3] = [Cell(2), Cell(4), Cell(6)];
    static GOALS: [Cell; 3] = [Cell(44), Cell(45), Cell(46)];
    Mission { starts: &STARTS, goals: &GOALS, ..with_a_door() }
}

#[test]
fn a_door_that_closes_stops_the_team_and_one_that_opens_in_view_lets_it_through() {
    let mission = with_a_door();
    let mut team = agreed(&mission);
    team.cause(EventEffect::Block(Cell(24)));
    fly_until(&mut team, "a robot has seen it", |team| {
        (0..2).any(|robot| task(team, robot).hazards().any(|cell| cell == Cell(24)))
    });
    tick(&mut team, 120);
    assert!(team.cells().iter().all(|cell| cell.0 < 21), "nobody goes through");
    assert!(!stopped(&team));
    team.cause(EventEffect::Clear(Cell(24)));
    // Where the door is in view, for one after the other: each believes its own eyes.
    (0..2).for_each(|robot| visit(&mut team, robot, 17));
    fly_until(&mut team, "all stop", stopped);
    assert!(on_goals(&team, &mission));
}

/// No robot looks at the door after it was closed: a robot that has restarted elsewhere does not
/// know of it.
#[test]
fn evidence_that_nobody_renews_fades_and_the_way_is_tried_again() {
    let forgetful = Mission { forgets: 1, ..with_a_door() };
    let never = with_a_door();
    let after = |mission| {
        let mut team = agreed(mission);
        team.cause(EventEffect::Block(Cell(24)));
        fly_until(&mut team, "a robot has seen it", |team| {
            (0..2).any(|robot| task(team, robot).hazards().any(|cell| cell == Cell(24)))
        });
        // Where they cannot see it, it is taken away.
        team.place(0, Cell(0));
        team.place(1, Cell(6));
        team.cause(EventEffect::Clear(Cell(24)));
        judge::fly(&mut team, 400).arrived
    };
    assert!(after(&forgetful).is_some(), "after some forty ticks it counts as free");
    assert_eq!(after(&never), None, "without forgetting it stays");
}

#[test]
fn an_obstacle_that_was_seen_to_be_gone_is_free_for_the_whole_team() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", stopped);
    let far = team.cells().iter().position(|&cell| cell == Cell(32)).expect("a robot on p32");
    let near = team.cells().iter().position(|&cell| cell == Cell(24)).expect("a robot on p24");
    let knows = |team: &Team<'_>| task(team, near).hazards().any(|cell| cell == Cell(17));
    team.cause(EventEffect::Block(Cell(17))); // in view of the robot on p24 only
    fly_until(&mut team, "it has seen it", knows);
    visit(&mut team, far, 48); // a round, in which all learn of it, far from where it is seen
    fly_until(&mut team, "all stop", |team| stopped(team) && task(team, far).waypoints().is_empty());
    let told = |team: &Team<'_>| protocol(team, near).fact().evidence.iter().any(|known| known.weight > 0);
    assert!(told(&team));
    assert_eq!(team.cells()[near], Cell(24), "it is still in view");
    team.cause(EventEffect::Clear(Cell(17)));
    fly_until(&mut team, "nobody takes it for blocked", |team| !knows(team));
    visit(&mut team, far, 17);
    let tracks = fly_to_the_end(&mut team);
    assert!(passed(&tracks[far], &[17]), "{:?}", tracks[far]);
}

/// Robot 1 has seen the door closed and is put where it cannot see it; robot 2 sees it open.
#[test]
fn an_obstacle_that_only_a_teammate_has_seen_go_is_free_though_nothing_is_forgotten() {
    let mission = with_a_door();
    let mut team = agreed(&mission);
    close_the_door_before(&mut team, 0);
    open_the_door_before(&mut team, 1);
    fly_until(&mut team, "all stop", stopped);
    assert!(on_goals(&team, &mission));
}

/// Two that cannot see the door do not outvote the one that has seen it open.
#[test]
fn an_obstacle_that_one_of_three_has_seen_go_is_free_though_nothing_is_forgotten() {
    let mission = with_a_door_for_three();
    let mut team = agreed(&mission);
    close_the_door_before(&mut team, 0);
    team.place(0, Cell(0));
    team.place(1, Cell(17));
    let has_seen =
        |robot: usize| move |team: &Team<'_>| task(team, robot).hazards().any(|cell| cell == Cell(24));
    fly_until(&mut team, "robot 2 has seen it too", has_seen(1));
    assert!(has_seen(0)(&team) && !has_seen(2)(&team));
    open_the_door_before(&mut team, 2);
    team.place(2, Cell(2));
    fly_until(&mut team, "all stop", stopped);
    assert!(on_goals(&team, &mission));
}

/// A robot that has seen an obstacle go does not know for ever that nothing is there.
#[test]
fn an_obstacle_that_comes_back_is_believed_by_those_who_have_seen_it_go() {
    let mission = with_a_door_for_three();
    let mut team = agreed(&mission);
    close_the_door_before(&mut team, 0);
    open_the_door_before(&mut team, 1);
    open_the_door_before(&mut team, 2);
    team.cause(EventEffect::Block(Cell(24)));
    team.place(2, Cell(4));
    team.place(1, Cell(6));
    team.place(0, Cell(17));
    let closed = |team: &Team<'_>| {
        decided_after(team, 0) && (0..3).all(|robot| task(team, robot).failure() == Some(Failure::NoWay))
    };
    fly_until(&mut team, "all know that there is no way", closed);
    team.cause(EventEffect::Clear(Cell(24)));
    fly_until(&mut team, "all stop", stopped);
    assert!(on_goals(&team, &mission));
}

/// Closes the door in view of one robot alone, until all have heard of it.
fn close_the_door_before(team: &mut Team<'_>, robot: usize) {
    let others = (0..team.cells().len()).filter(|&other| other != robot);
    others.for_each(|other| team.place(other, Cell(other as u16 + 7)));
    team.place(robot, Cell(17));
    team.cause(EventEffect::Block(Cell(24)));
    let size = team.cells().len();
    fly_until(team, "all have heard of it", |team| {
        (0..size).all(|robot| task(team, robot).watched().any(|cell| cell == Cell(24)))
    });
}

/// Opens the door in view of one robot alone, and lets it look twice.
fn open_the_door_before(team: &mut Team<'_>, robot: usize) {
    let others = (0..team.cells().len()).filter(|&other| other != robot);
    others.for_each(|other| team.place(other, Cell(other as u16)));
    team.place(robot, Cell(17));
    team.cause(EventEffect::Clear(Cell(24)));
    tick(team, 2);
}

#[test]
fn a_teammate_in_view_is_no_obstacle() {
    let mission = Mission::new(open_floor(), &[Cell(0), Cell(1), Cell(7)], &[Cell(46), Cell(47), Cell(48)]);
    // In a flight of the last range, a member that was heard lately has joined a round without the
    // robot that sees it.
    let flights = [(0.0, 0, 0..1), (0.3, 0, 0..300), (0.3, 20, 0..600), (0.3, 10, 3870..3880)];
    for (loss, burst, seeds) in flights {
        let (mut seen, flown) = (0, seeds.end - seeds.start);
        for seed in seeds {
            let radio = Radio { loss, burst, ..Radio::default() };
            let flight = with_sensors_that_see_teammates(&mission, radio, seed);
            let name = format!("{loss} in bursts of {burst}, seed {seed}: {flight:?}");
            assert_eq!(flight.taken_for_obstacles, 0, "{name}");
            assert!(flight.arrived.is_some(), "{name}");
            seen += flight.seen;
        }
        assert!(seen > flown as u32, "the sensors report teammates");
    }
}

/// A flight of robots whose sensors report teammates.
#[derive(Debug, Default)]
struct Flown {
    arrived: Option<u32>,
    /// How often a teammate was in view.
    seen: u32,
    /// In how many ticks a robot took a cell for blocked.
    taken_for_obstacles: u32,
}

fn with_sensors_that_see_teammates(mission: &Mission<'_, 2>, radio: Radio, seed: u64) -> Flown {
    let robot = |(number, &start): (usize, &Cell)| {
        let member = Member::new(RobotId(number as u8), mission.starts.len()).expect("a team");
        let settings = Settings::new(member, KEY, 1, NonZero::<u16>::MIN);
        let robot = Navigator::<49, 2, LAYERS, NODES, POLICIES>::new(mission, &settings);
        (robot.expect("a sound mission"), Parts { cell: start, ..Parts::default() })
    };
    let team = mission.starts.iter().enumerate().map(robot);
    let mut testbed = Testbed::new(team, radio, seed).expect("a team");
    let size = mission.starts.len();
    let mut flown = Flown::default();
    while flown.arrived.is_none() && testbed.ticks() < 600 {
        let cells: Vec<Cell> = (0..size).map(|robot| testbed.parts(robot).cell).collect();
        for robot in 0..size {
            let is_near =
                |&&cell: &&Cell| cell != cells[robot] && mission.map.manhattan(cell, cells[robot]) <= 2;
            let in_view: VecDeque<Cell> = cells.iter().filter(is_near).copied().collect();
            flown.seen += in_view.len() as u32;
            testbed.parts_mut(robot).in_view = in_view;
        }
        let statuses = testbed.tick();
        flown.taken_for_obstacles +=
            testbed.robots().filter(|robot| robot.navigation().hazards().next().is_some()).count() as u32;
        for robot in 0..size {
            let parts = testbed.parts_mut(robot);
            let step = parts.command.take().unwrap_or(Move::Wait);
            parts.cell = mission.map.neighbour(parts.cell, step);
        }
        let is_there = statuses.iter().all(|&status| status == Status::Success);
        flown.arrived = is_there.then(|| testbed.ticks());
    }
    flown
}

/// The sensors and actuators of one robot.
#[derive(Debug, Default)]
struct Parts {
    cell: Cell,
    command: Option<Move>,
    in_view: VecDeque<Cell>,
}

impl Drive for Parts {
    fn go(&mut self, step: Move) {
        self.command = Some(step);
    }

    fn is_moving(&mut self) -> bool {
        self.command.is_some()
    }

    fn stop(&mut self) {
        self.command = None;
    }
}

impl Localiser for Parts {
    fn locate(&mut self) -> Option<Cell> {
        Some(self.cell)
    }
}

impl Scanner for Parts {
    fn scan(&mut self) -> Option<Cell> {
        self.in_view.pop_front()
    }
}

impl Battery for Parts {
    fn charge(&mut self) -> u8 {
        100
    }
}
