//! The truth: where the robots and the things are, what the sensors read, and what fails.

use super::terms::Disturbances;
use crate::chance::{Chance, Purpose};
use iibt_core::iibt::manipulation::{Command, Deed, Place, State, TEAM};

/// Where a thing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spot {
    At(Place),
    HeldBy(usize),
    /// The bottle on the plate.
    OnPlate,
}

/// One robot's body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Body {
    pub(super) place: Place,
    /// What it is doing, and for how many ticks more.
    pub(super) doing: Option<(Command, u32)>,
}

/// What became of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ended {
    pub(super) robot: usize,
    pub(super) command: Command,
    pub(super) succeeded: bool,
}

/// Three places, two things, two robots. Robot 0 handles thing 0, the bottle, robot 1 thing 1, the plate.
#[derive(Debug)]
pub(super) struct World {
    disturbances: Disturbances,
    pub(super) bodies: [Body; TEAM],
    pub(super) things: [Spot; TEAM],
    readings: [Chance; TEAM],
    failures: [Chance; TEAM],
}

/// Where the things are to begin with.
const SOURCES: [Place; TEAM] = [Place::GoalA, Place::GoalB];
const MEETING: Place = Place::GoalC;
const PLACER: usize = 0;
const CARRIER: usize = 1;

impl World {
    pub(super) fn new(seed: u64, disturbances: Disturbances) -> Self {
        // A stream for each robot, so that one robot's actions leave the other's luck as it was.
        let streams = |purpose| [0, 1].map(|robot| Chance::new(seed.wrapping_mul(2) + robot, purpose));
        Self {
            disturbances,
            bodies: [Body::default(); TEAM],
            things: SOURCES.map(Spot::At),
            readings: streams(Purpose::Reading),
            failures: streams(Purpose::Deed),
        }
    }

    /// How many ticks an action takes.
    pub(super) const fn ticks(deed: Deed) -> u32 {
        match deed {
            Deed::MoveTo => 4,
            Deed::Pick | Deed::Place => 2,
            Deed::Idle => 1,
        }
    }

    /// Whether the bottle is on the plate, and robot 1 holds that at goal C.
    pub(super) fn is_accomplished(&self) -> bool {
        let [bottle, plate] = self.things;
        bottle == Spot::OnPlate && plate == Spot::HeldBy(CARRIER) && self.bodies[CARRIER].place == MEETING
    }

    /// The semantic state of a robot, in truth.
    pub(super) fn state(&self, robot: usize) -> State {
        match self.things[robot] {
            Spot::OnPlate => State::Place,
            Spot::HeldBy(_) => State::Hold,
            Spot::At(_) if self.bodies[robot].place == SOURCES[robot] => State::Loc,
            Spot::At(_) => State::Free,
        }
    }

    /// What a robot reads of its place and state. Drawn in every tick, so that the luck of a tick does not depend on what was done
    /// before it.
    pub(super) fn read(&mut self, robot: usize) -> (Place, State) {
        let (place, state) = (self.bodies[robot].place as usize, self.state(robot) as usize);
        let wrong = self.disturbances.wrong_readings;
        let chance = &mut self.readings[robot];
        let mut read = |truth: usize| {
            let (errs, by) = (chance.strikes(wrong), usize::from(chance.below(3)));
            if errs { (truth + 1 + by) % 4 } else { truth }
        };
        let (place, state) = (read(place), read(state));
        (Place::of(place).unwrap_or_default(), State::of(state).unwrap_or_default())
    }

    /// Begins an action; one under way goes on instead.
    pub(super) fn begin(&mut self, robot: usize, command: Command) {
        let body = &mut self.bodies[robot];
        if body.doing.is_none() {
            body.doing = Some((command, Self::ticks(command.deed)));
        }
    }

    /// Lets a tick pass; says which actions have ended.
    pub(super) fn pass(&mut self) -> Vec<Ended> {
        let mut ended = Vec::new();
        for robot in 0..TEAM {
            let Some((command, left)) = self.bodies[robot].doing else { continue };
            self.bodies[robot].doing = (left > 1).then_some((command, left - 1));
            if left <= 1 {
                ended.push(Ended { robot, command, succeeded: self.carry_out(robot, command) });
            }
        }
        ended
    }

    fn carry_out(&mut self, robot: usize, command: Command) -> bool {
        let Disturbances { failed_moves, failed_grasps, failed_placings, .. } = self.disturbances;
        let share = match command.deed {
            Deed::MoveTo => failed_moves,
            Deed::Pick => failed_grasps,
            Deed::Place => failed_placings,
            Deed::Idle => 0.0,
        };
        if self.failures[robot].strikes(share) {
            return false;
        }
        let here = self.bodies[robot].place;
        match command.deed {
            Deed::MoveTo => self.bodies[robot].place = command.place,
            Deed::Pick if self.things[robot] == Spot::At(here) => self.things[robot] = Spot::HeldBy(robot),
            Deed::Place if self.may_place(robot) => self.things[robot] = Spot::OnPlate,
            Deed::Idle => {}
            Deed::Pick | Deed::Place => return false,
        }
        true
    }

    /// A gripper opens only over the plate, which the other robot must hold still.
    fn may_place(&self, robot: usize) -> bool {
        let [placer, carrier] = self.bodies;
        let together = placer.place == MEETING && carrier.place == MEETING && carrier.doing.is_none();
        robot == PLACER && together && self.things == [Spot::HeldBy(PLACER), Spot::HeldBy(CARRIER)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn act(world: &mut World, robot: usize, deed: Deed, place: Place) -> bool {
        world.begin(robot, Command { deed, place });
        (0..World::ticks(deed))
            .flat_map(|_| world.pass())
            .any(|ended| ended.robot == robot && ended.succeeded)
    }

    #[test]
    fn a_bottle_is_placed_only_on_a_plate_that_is_held_still_at_goal_c() {
        let mut world = World::new(1, Disturbances::NONE);
        assert!(!act(&mut world, 0, Deed::Pick, Place::GoalA), "there is nothing to pick up");
        for (robot, place) in [(0, Place::GoalA), (1, Place::GoalB)] {
            assert!(act(&mut world, robot, Deed::MoveTo, place));
            assert_eq!(world.state(robot), State::Loc);
            assert!(act(&mut world, robot, Deed::Pick, place));
        }
        assert!(act(&mut world, 0, Deed::MoveTo, Place::GoalC));
        assert!(!act(&mut world, 0, Deed::Place, Place::GoalC), "the plate is not there");
        world.begin(1, Command { deed: Deed::MoveTo, place: Place::GoalC });
        assert_eq!(world.state(0), State::Hold);
        (0..4).for_each(|_| _ = world.pass());
        assert!(!world.is_accomplished());
        assert!(act(&mut world, 0, Deed::Place, Place::GoalC));
        assert!(world.is_accomplished());
        assert!(act(&mut world, 1, Deed::MoveTo, Place::GoalB));
        assert!(!world.is_accomplished(), "robot 1 carried it away");
    }

    #[test]
    fn readings_and_grasps_fail_as_often_as_asked() {
        let disturbances = Disturbances { wrong_readings: 0.1, failed_grasps: 0.3, ..Disturbances::NONE };
        let mut world = World::new(3, disturbances);
        let wrong = (0..10_000).filter(|_| world.read(0).1 != State::Free).count();
        assert!((900..1_100).contains(&wrong), "{wrong}");
        assert!(act(&mut world, 1, Deed::MoveTo, Place::GoalB));
        let mut grasped = 0;
        for _ in 0..10_000 {
            world.things[1] = Spot::At(Place::GoalB);
            grasped += u32::from(act(&mut world, 1, Deed::Pick, Place::GoalB));
        }
        assert!((6_800..7_200).contains(&grasped), "{grasped}");
    }
}
