//! The world as it is, whatever the robots believe: where they stand and what blocks their way.

use crate::battery::BatteryState;
use crate::flight_event::FlightEvent;
use crate::progress::Progress;
use crate::random::{Random, Stream};
use crate::scenario::{Device, Event, EventEffect, Floor, Scenario, Trigger, UnknownSpec};
use crate::stranger::Stranger;
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{Effect, Sighting};

/// The truth of a flight.
#[derive(Debug)]
pub(crate) struct World {
    known: Floor,
    floor: Floor,
    cells: Vec<Cell>,
    /// The move that each robot is making, if it is between two cells.
    under_way: Vec<Option<Passage>>,
    /// The ticks that a move of each robot takes.
    paces: Vec<u32>,
    batteries: Vec<BatteryState>,
    /// The tick in which each robot that has stopped goes on; `None` for those that have not.
    stopped: Vec<Option<u32>>,
    /// The same for the devices of each robot that have frozen.
    frozen: Vec<[Option<u32>; Device::ALL.len()]>,
    to_come: Vec<Event>,
    due: Vec<Cell>,
    /// The goals that do not serve, and those that strangers take.
    useless: Vec<Cell>,
    /// The value of each unknown.
    values: Vec<u8>,
    strangers: Vec<Stranger>,
    ways: Random,
}

/// A move that takes more than a tick.
#[derive(Clone, Copy, Debug)]
struct Passage {
    /// Where it leads.
    to: Cell,
    /// The ticks that it takes from now on.
    ticks: u32,
}

impl World {
    pub(crate) fn new(scenario: &Scenario, seed: u64) -> Self {
        let mut random = Random::of(seed, Stream::Unknown);
        let values: Vec<u8> = scenario.unknowns.iter().map(|unknown| value(unknown, &mut random)).collect();
        Self {
            known: scenario.map,
            floor: scenario.map.avoiding(scenario.cells_of_unknowns(Effect::Blocks, &values, true)),
            useless: scenario.useless_goals(&values).collect(),
            strangers: Stranger::of(scenario, &values),
            ways: Stranger::draws(seed),
            values,
            cells: scenario.robots.iter().map(|robot| robot.start).collect(),
            under_way: vec![None; scenario.robots.len()],
            paces: scenario.robots.iter().map(|robot| robot.pace).collect(),
            batteries: scenario.robots.iter().map(BatteryState::of).collect(),
            stopped: vec![None; scenario.robots.len()],
            frozen: vec![[None; Device::ALL.len()]; scenario.robots.len()],
            to_come: scenario.events.clone(),
            due: Vec::new(),
        }
    }

    /// The value of each unknown.
    pub(crate) fn values(&self) -> &[u8] {
        &self.values
    }

    /// Where the strangers stand.
    pub(crate) fn strangers(&self) -> impl Iterator<Item = Cell> + '_ {
        self.strangers.iter().map(|stranger| stranger.cell)
    }

    /// The strangers that a robot sees which looks so many cells around itself.
    pub(crate) fn sightings(&self, robot: usize, view: u16) -> impl Iterator<Item = Sighting> + '_ {
        let distance = move |at| self.distance(self.cells[robot], at);
        let is_seen = move |stranger: &&Stranger| {
            distance(stranger.cell) <= view || stranger.is_seen_from(distance(stranger.cell))
        };
        let seen = self.strangers.iter().filter(is_seen);
        seen.map(|stranger| Sighting { unknown: stranger.unknown, at: stranger.cell })
    }

    /// The goals that do not serve, and those that strangers take.
    pub(crate) fn useless(&self) -> &[Cell] {
        &self.useless
    }

    /// Where the robots stand.
    pub(crate) fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// The cell that each robot is on its way to; it counts as in both until it is there.
    pub(crate) fn entering(&self) -> impl Iterator<Item = Option<Cell>> + '_ {
        self.under_way.iter().map(|passage| passage.map(|passage| passage.to))
    }

    /// Whether a robot is between two cells.
    pub(crate) fn is_moving(&self, robot: usize) -> bool {
        self.under_way[robot].is_some()
    }

    /// Breaks off the move of a robot that is between two cells: its drive centres it on the one
    /// where that began, or on the one where it was to end, in as many ticks as a move takes.
    pub(crate) fn break_off(&mut self, robot: usize, goes_back: bool) {
        let Some(passage) = &mut self.under_way[robot] else { return };
        passage.ticks = self.paces[robot];
        if goes_back {
            std::mem::swap(&mut passage.to, &mut self.cells[robot]);
        }
    }

    /// Free and blocked cells as they are now.
    pub(crate) fn floor(&self) -> &Floor {
        &self.floor
    }

    /// The battery of a robot.
    pub(crate) fn battery(&self, robot: usize) -> &BatteryState {
        &self.batteries[robot]
    }

    /// Sets the charge of a robot's battery, in percent.
    pub(crate) fn set_charge(&mut self, robot: usize, percent: u8) {
        self.batteries[robot].set(percent);
    }

    /// Sets the ticks that a robot's moves take, one at the least.
    pub(crate) fn set_pace(&mut self, robot: usize, ticks: u32) {
        self.paces[robot] = ticks.max(1);
    }

    /// Puts a robot into another cell, whatever it was doing.
    pub(crate) fn place(&mut self, robot: usize, cell: Cell) {
        (self.cells[robot], self.under_way[robot]) = (cell, None);
    }

    /// Has something happen with the next tick.
    pub(crate) fn cause(&mut self, effect: EventEffect) {
        self.to_come.push(Event { when: Trigger::Tick(0), effect });
    }

    /// Whether a robot has stopped.
    pub(crate) fn is_stopped(&self, robot: usize) -> bool {
        self.stopped[robot].is_some()
    }

    /// Whether a device of a robot has frozen.
    pub(crate) fn is_frozen(&self, robot: usize, device: Device) -> bool {
        self.frozen[robot][device as usize].is_some()
    }

    /// Whether an event is still to come: one that comes by the clock, or one whose time has come.
    ///
    /// An obstacle on a path that is too short for it does not count: it may never come.
    pub(crate) fn has_event_to_come(&self, progress: Progress) -> bool {
        let comes = |event: &Event| match (event.when, event.effect) {
            (Trigger::Tick(_), EventEffect::BlockPath(_)) => false,
            (Trigger::Tick(_), _) => true,
            (_, EventEffect::BlockPath(_)) => false,
            _ => self.is_time(event, u32::MAX, progress),
        };
        self.to_come.iter().any(comes) || self.stopped.iter().flatten().any(|&until| until < u32::MAX)
    }

    /// Whether the time of an event has come in a tick.
    fn is_time(&self, event: &Event, tick: u32, progress: Progress) -> bool {
        match event.when {
            Trigger::Tick(at) => at <= tick,
            Trigger::Reached(robot, at) => self.cells.get(robot) == Some(&at),
            Trigger::Planned(plans, moves) => progress.has_come_to(plans, moves),
        }
    }

    /// Lets the events of this tick happen; what a robot is told is left to the flight. An obstacle
    /// does not appear on a robot, but when that has gone.
    ///
    /// `ahead` is where each robot's path can be blocked.
    pub(crate) fn begin(
        &mut self,
        tick: u32,
        progress: Progress,
        ahead: impl Fn(usize) -> Option<Cell>,
    ) -> Vec<FlightEvent> {
        let mut happened = self.resume(tick);
        let mut to_come = std::mem::take(&mut self.to_come);
        let is_due = |event: &mut Event| {
            if !self.is_time(event, tick, progress) {
                return false;
            }
            let EventEffect::BlockPath(robot) = event.effect else { return true };
            ahead(robot).map(|cell| event.effect = EventEffect::Block(cell)).is_some()
        };
        let events: Vec<_> = to_come.extract_if(.., is_due).collect();
        self.to_come = to_come;
        happened.extend(events.into_iter().filter_map(|event| self.happen(event.effect, tick)));
        let taken = self.taken();
        let appearing: Vec<_> = self.due.extract_if(.., |cell| !taken.contains(cell)).collect();
        let appeared = appearing.into_iter().filter(|&cell| self.floor.block(cell));
        happened.extend(appeared.map(|cell| FlightEvent::Appeared { cell }));
        happened
    }

    /// Lets the robots and devices go on whose time has come.
    fn resume(&mut self, tick: u32) -> Vec<FlightEvent> {
        let waking = |(robot, until): (usize, &mut Option<u32>)| {
            has_ended(until, tick).then_some(FlightEvent::Resumed { robot })
        };
        let mut resumed: Vec<_> = self.stopped.iter_mut().enumerate().filter_map(waking).collect();
        for (robot, devices) in self.frozen.iter_mut().enumerate() {
            let thawing = |(until, device): (&mut Option<u32>, Device)| {
                has_ended(until, tick).then_some(FlightEvent::Thawed { robot, device })
            };
            resumed.extend(devices.iter_mut().zip(Device::ALL).filter_map(thawing));
        }
        resumed
    }

    fn happen(&mut self, effect: EventEffect, tick: u32) -> Option<FlightEvent> {
        match effect {
            EventEffect::Block(cell) => {
                self.due.push(cell);
                None
            }
            // It has become the obstacle that it stands for.
            EventEffect::BlockPath(_) => None,
            EventEffect::Clear(cell) => {
                self.due.retain(|&due| due != cell);
                let is_obstacle = self.known.is_free(cell) && !self.floor.is_free(cell);
                self.floor.clear(cell);
                is_obstacle.then_some(FlightEvent::Cleared { cell })
            }
            EventEffect::Charge(robot, charge) => {
                self.batteries[robot].fall_to(charge).then_some(FlightEvent::Drained { robot, charge })
            }
            EventEffect::Visit(robot, cell) => Some(FlightEvent::Asked { robot, cell }),
            EventEffect::Stop(robot, ticks) => {
                self.stopped[robot] = Some(end(tick, ticks));
                Some(FlightEvent::Stopped { robot })
            }
            EventEffect::Freeze(robot, device, ticks) => {
                self.frozen[robot][device as usize] = Some(end(tick, ticks));
                Some(FlightEvent::Froze { robot, device })
            }
        }
    }

    /// The obstacles that have appeared.
    pub(crate) fn obstacles(&self) -> impl Iterator<Item = Cell> + '_ {
        let appeared = |&cell: &Cell| self.known.is_free(cell) && !self.floor.is_free(cell);
        (0..self.floor.len() as u16).map(Cell).filter(appeared)
    }

    /// The obstacles not on the map within `view` cells of a robot, diagonals included.
    pub(crate) fn in_view(&self, robot: usize, view: u16) -> impl Iterator<Item = Cell> + '_ {
        let here = self.cells[robot];
        self.obstacles().filter(move |&cell| self.distance(here, cell) <= view)
    }

    /// The cells within `view` cells of a robot on which strangers are.
    pub(crate) fn strangers_in_view(&self, robot: usize, view: u16) -> impl Iterator<Item = Cell> + '_ {
        let here = self.cells[robot];
        self.strangers().filter(move |&cell| self.distance(here, cell) <= view)
    }

    /// The cells within `view` cells of a robot on which there is nothing.
    pub(crate) fn clear_in_view(&self, robot: usize, view: u16) -> impl Iterator<Item = Cell> + '_ {
        let here = self.cells[robot];
        let is_stranger = |cell: Cell| self.strangers().any(|at| at == cell);
        let is_empty =
            move |cell: &Cell| self.floor.is_free(*cell) && !self.cells.contains(cell) && !is_stranger(*cell);
        let cells = (0..self.floor.len() as u16).map(Cell).filter(is_empty);
        cells.filter(move |&cell| self.distance(here, cell) <= view)
    }

    /// The cells of all robots and strangers, and those that robots are on their way to.
    fn taken(&self) -> Vec<Cell> {
        self.cells.iter().copied().chain(self.entering().flatten()).chain(self.strangers()).collect()
    }

    /// Lets the strangers move: each sees where the others are, but not where they go.
    fn move_strangers(&mut self) {
        for number in 0..self.strangers.len() {
            let taken = self.taken();
            let (stranger, ways) = (&mut self.strangers[number], &mut self.ways);
            stranger.cell = stranger.next(&self.floor, &taken, ways);
        }
    }

    /// Carries out one command of every robot, all at once, and lets the strangers move; a robot
    /// that runs into something stays, and one between two cells goes on.
    pub(crate) fn carry_out(&mut self, commands: &[Move]) {
        self.move_strangers();
        for (robot, &step) in commands.iter().enumerate() {
            let (before, next) = (self.cells[robot], self.floor.neighbour(self.cells[robot], step));
            let begun = Some(Passage { to: next, ticks: self.paces[robot] });
            let passage =
                self.under_way[robot].or(begun.filter(|_| next != before && self.floor.is_free(next)));
            self.under_way[robot] = passage
                .map(|passage| Passage { ticks: passage.ticks - 1, ..passage })
                .filter(|passage| passage.ticks > 0);
            if self.under_way[robot].is_none() {
                self.cells[robot] = passage.map_or(before, |passage| passage.to);
                self.batteries[robot].tick(before, self.cells[robot]);
            }
        }
    }

    fn distance(&self, one: Cell, other: Cell) -> u16 {
        let width = self.floor.width();
        let rows = (one.0 / width).abs_diff(other.0 / width);
        let columns = (one.0 % width).abs_diff(other.0 % width);
        rows.max(columns)
    }
}

/// The value of an unknown: as it is written, or drawn. A number is drawn in any case, so that the
/// others do not depend on what is written of this one.
fn value(unknown: &UnknownSpec, random: &mut Random) -> u8 {
    let mut drawn = f64::from(random.bits()) / 4_294_967_296.0;
    let less = |p: &&f32| {
        drawn -= f64::from(**p);
        drawn >= 0.0
    };
    let value = unknown.prior.iter().take_while(less).count();
    unknown.real.unwrap_or(value.min(unknown.prior.len() - 1) as u8)
}

/// The end of what begins in a tick and lasts so many ticks, or for good.
fn end(tick: u32, ticks: Option<u32>) -> u32 {
    ticks.map_or(u32::MAX, |ticks| tick + ticks)
}

/// Whether something ends in this tick; it is then over.
fn has_ended(until: &mut Option<u32>, tick: u32) -> bool {
    until.take_if(|until| *until <= tick).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world(events: &str) -> World {
        let text = format!("title = 't'\nmap = '''\n1..\n.#.\nG.2\n...\n'''\ngoals = [6, 11]\n{events}");
        World::new(&Scenario::parse("test", &text.replace('G', ".")).unwrap(), 1)
    }

    #[test]
    fn moves_are_made_at_once_and_obstacles_stop_them() {
        let mut world = world("");
        world.carry_out(&[Move::Right, Move::Up]);
        assert_eq!(world.cells(), [Cell(1), Cell(5)]);
        world.carry_out(&[Move::Down, Move::Left]);
        assert_eq!(world.cells(), [Cell(1), Cell(5)], "4 is blocked");
        world.carry_out(&[Move::Up, Move::Right]);
        assert_eq!(world.cells(), [Cell(1), Cell(5)], "the border is closed");
    }

    #[test]
    fn a_slow_robot_is_in_two_cells_until_its_move_is_done() {
        let mut world = world("[[event]]\ntick = 1\nblock = 1\n[[robot]]\npace = 3");
        let entering = |world: &World| world.entering().collect::<Vec<_>>();
        world.carry_out(&[Move::Right, Move::Up]);
        assert_eq!((world.cells(), entering(&world)), (&[Cell(0), Cell(5)][..], vec![Some(Cell(1)), None]));
        assert_eq!(
            world.begin(1, Progress::default(), |_| None),
            [],
            "no obstacle appears where it is going"
        );
        world.carry_out(&[Move::Wait, Move::Wait]);
        assert!(world.is_moving(0) && world.cells()[0] == Cell(0));
        world.carry_out(&[Move::Wait, Move::Wait]);
        assert_eq!((world.cells()[0], entering(&world)), (Cell(1), vec![None, None]));
    }

    #[test]
    fn a_robot_whose_move_is_broken_off_is_in_both_cells_until_it_is_centred() {
        for (goes_back, end) in [(false, 1), (true, 0)] {
            let mut world = world("[[robot]]\npace = 3");
            world.carry_out(&[Move::Right, Move::Wait]);
            world.break_off(0, goes_back);
            world.break_off(1, goes_back);
            for _ in 0..3 {
                let both = [world.cells()[0], world.entering().next().flatten().expect("it is moving")];
                assert!(both.contains(&Cell(0)) && both.contains(&Cell(1)));
                world.carry_out(&[Move::Wait; 2]);
            }
            assert!(!world.is_moving(0) && world.cells() == [Cell(end), Cell(8)]);
        }
    }

    #[test]
    fn an_obstacle_waits_for_its_tick_and_for_a_free_cell() {
        let mut world = world("[[event]]\ntick = 1\nblock = 1\n[[event]]\ntick = 2\nblock = 3");
        assert_eq!(world.begin(0, Progress::default(), |_| None), []);
        world.carry_out(&[Move::Right, Move::Wait]);
        assert_eq!(world.begin(1, Progress::default(), |_| None), [], "a robot stands there");
        world.carry_out(&[Move::Left, Move::Wait]);
        assert_eq!(
            world.begin(2, Progress::default(), |_| None),
            [1, 3].map(|cell| FlightEvent::Appeared { cell: Cell(cell) })
        );
        assert!(!world.floor().is_free(Cell(1)));
        assert_eq!(world.begin(3, Progress::default(), |_| None), []);
    }

    #[test]
    fn an_obstacle_waits_for_a_robot() {
        let mut world = world("[[event]]\nrobot = 'R2'\nat = 5\nblock = 1");
        assert_eq!(world.begin(0, Progress::default(), |_| None), []);
        world.carry_out(&[Move::Wait, Move::Up]);
        assert_eq!(world.begin(1, Progress::default(), |_| None), [FlightEvent::Appeared { cell: Cell(1) }]);
    }

    #[test]
    fn what_happens_to_a_robot_happens_once_and_it_goes_on_when_its_time_has_come() {
        let mut world = world(
            "[[event]]\ntick = 1\nwho = 'R1'\ncharge = 12\n[[event]]\nrobot = 'R2'\nat = 7\nvisit = 0\n\
             [[event]]\ntick = 2\nwho = 'R2'\nstop = true\nfor = 3",
        );
        assert_eq!(world.begin(0, Progress::default(), |_| None), []);
        assert_eq!(
            world.begin(1, Progress::default(), |_| None),
            [FlightEvent::Drained { robot: 0, charge: 12 }]
        );
        assert_eq!((world.battery(0).percent(), world.battery(1).percent()), (12, 100));
        world.carry_out(&[Move::Wait, Move::Left]);
        assert_eq!(
            world.begin(2, Progress::default(), |_| None),
            [FlightEvent::Asked { robot: 1, cell: Cell(0) }, FlightEvent::Stopped { robot: 1 }]
        );
        assert!(world.is_stopped(1) && !world.is_stopped(0));
        assert_eq!(
            (world.begin(3, Progress::default(), |_| None), world.begin(4, Progress::default(), |_| None)),
            (vec![], vec![])
        );
        assert_eq!(world.begin(5, Progress::default(), |_| None), [FlightEvent::Resumed { robot: 1 }]);
        assert!(!world.is_stopped(1));
    }

    #[test]
    fn a_device_freezes_until_its_time_has_come() {
        let mut world = world(
            "[[event]]\ntick = 1\nwho = 'R1'\nfreeze = 'localiser'\n[[event]]\ntick = 2\nwho = 'R2'\n\
             freeze = 'drive'\nfor = 3",
        );
        let froze = |robot, device| FlightEvent::Froze { robot, device };
        let mut begin = |tick| world.begin(tick, Progress::default(), |_| None);
        assert_eq!(
            [0, 1, 2].map(&mut begin),
            [vec![], vec![froze(0, Device::Localiser)], vec![froze(1, Device::Drive)],]
        );
        assert_eq!(begin(4), []);
        assert_eq!(begin(5), [FlightEvent::Thawed { robot: 1, device: Device::Drive }]);
        let frozen = [0, 1].map(|robot| Device::ALL.map(|device| world.is_frozen(robot, device)));
        assert_eq!(frozen, [[true, false], [false; 2]], "the localiser is frozen for good");
    }

    #[test]
    fn only_what_the_map_does_not_show_is_in_view() {
        let mut world = world("[[event]]\ntick = 0\nblock = 1\n[[event]]\ntick = 0\nblock = 7");
        world.begin(0, Progress::default(), |_| None);
        let seen = |robot, view| world.in_view(robot, view).collect::<Vec<_>>();
        assert_eq!(seen(0, 1), [Cell(1)]);
        assert_eq!(seen(1, 1), [Cell(7)]);
        assert_eq!(seen(0, 2), [Cell(1), Cell(7)]);
    }
}
