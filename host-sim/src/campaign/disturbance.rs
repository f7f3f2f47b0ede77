//! Disturbances of a mission, drawn from the flight's seed and equal for all pilots.

use crate::random::{Random, Stream};
use crate::scenario::{Device, Event, EventEffect, Scenario, Trigger, parts};
use iibt_core::grid::Cell;
use serde::Serialize;

/// A kind of disturbance, added to the scenario's own events.
#[doc(alias = "fault injection")]
#[doc(alias = "robustness")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Disturbance {
    /// None.
    None,
    /// Every localiser is wrong in 10 % of all readings, as the model of a robot with inference
    /// knows.
    Noise,
    /// Every move fails with a probability of 10 %.
    Slips,
    /// The radio loses 30 % of all frames.
    Loss,
    /// The radio loses 30 % of all frames in bursts, ten on average.
    Bursts,
    /// Three obstacles appear where ways around them are left. Robots that have lists of paths plan
    /// by themselves: an obstacle may block all that are listed.
    Obstacles,
    /// One robot's battery falls to 15 %. Where the scenario has no chargers, robots charge where
    /// they started.
    Battery,
    /// One robot stops for 20 to 39 ticks.
    Pause,
    /// One robot stops for good; the others must not collide.
    Stop,
    /// One robot's localiser freezes for good: it names the same cell whatever the robot does.
    Frozen,
    /// One robot's drive stalls for good.
    Stalled,
    /// All of them together but bursts and the last, with three times the limit: to charge and to
    /// stop takes time.
    All,
}

/// The probability that a localiser is right under [`Disturbance::Noise`].
const RIGHT: f64 = 0.9;

/// The probability that a move fails under [`Disturbance::Slips`].
const SLIP: f64 = 0.1;

/// The probability that a frame is lost under [`Disturbance::Loss`].
const LOSS: f64 = 0.3;

/// The mean number of frames in a row that a link loses under [`Disturbance::Bursts`]: a second at
/// ten ticks a second.
const BURST: u32 = 10;

/// The number of obstacles that appear under [`Disturbance::Obstacles`].
const OBSTACLES: usize = 3;

/// The charge in percent to which a battery falls: below the level at which robots leave their
/// team.
const LOW: u8 = 15;

impl Disturbance {
    /// Those that can be accomplished by a team or its rest: what a campaign flies unless told
    /// otherwise.
    pub const USUAL: [Self; 10] = [
        Self::None,
        Self::Noise,
        Self::Slips,
        Self::Loss,
        Self::Bursts,
        Self::Obstacles,
        Self::Battery,
        Self::Pause,
        Self::Stop,
        Self::All,
    ];

    /// Those under which one robot stands, says why, and is not left out.
    pub const STANDING: [Self; 2] = [Self::Frozen, Self::Stalled];

    /// Returns all of them.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::USUAL.into_iter().chain(Self::STANDING)
    }

    /// Returns the name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Noise => "noise",
            Self::Slips => "slips",
            Self::Loss => "loss",
            Self::Bursts => "bursts",
            Self::Obstacles => "obstacles",
            Self::Battery => "battery",
            Self::Pause => "pause",
            Self::Stop => "stop",
            Self::Frozen => "frozen",
            Self::Stalled => "stalled",
            Self::All => "all",
        }
    }

    /// Returns the disturbance with a name, or `None`.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|disturbance| disturbance.name() == name)
    }

    /// Returns the scenario with this disturbance drawn from the seed.
    #[must_use]
    pub fn applied(self, scenario: &Scenario, seed: u64) -> Scenario {
        let mut disturbed = scenario.clone();
        let mut random = Random::of(seed, Stream::Disturbance);
        let parts: &[Self] = match self {
            Self::All => &[Self::Noise, Self::Slips, Self::Loss, Self::Obstacles, Self::Battery, Self::Pause],
            ref one => std::slice::from_ref(one),
        };
        for part in parts {
            part.apply(&mut disturbed, &mut random);
        }
        if self == Self::All {
            disturbed.limit *= 3;
        }
        disturbed
    }

    fn apply(self, scenario: &mut Scenario, random: &mut Random) {
        match self {
            Self::None | Self::All => {}
            Self::Noise => {
                scenario.robots.iter_mut().for_each(|robot| robot.localiser = robot.localiser.min(RIGHT));
                scenario.inference.sensor = Some(RIGHT as f32);
            }
            Self::Slips => scenario.robots.iter_mut().for_each(|robot| robot.slip = robot.slip.max(SLIP)),
            Self::Loss => scenario.radio.loss = scenario.radio.loss.max(LOSS),
            Self::Bursts => {
                (scenario.radio.loss, scenario.radio.burst) = (scenario.radio.loss.max(LOSS), BURST);
            }
            Self::Obstacles => block(scenario, random),
            Self::Battery => {
                for robot in &mut scenario.robots {
                    robot.charger.get_or_insert(robot.start);
                }
                happen(scenario, random, |robot, _| EventEffect::Charge(robot, LOW));
            }
            Self::Pause => {
                happen(scenario, random, |robot, random| {
                    EventEffect::Stop(robot, Some(20 + random.below(20) as u32))
                });
            }
            Self::Stop => happen(scenario, random, |robot, _| EventEffect::Stop(robot, None)),
            Self::Frozen => happen(scenario, random, freeze(Device::Localiser)),
            Self::Stalled => happen(scenario, random, freeze(Device::Drive)),
        }
    }
}

/// Adds an event for one robot at a tick when the fastest team would be on its way.
fn happen(scenario: &mut Scenario, random: &mut Random, effect: impl Fn(usize, &mut Random) -> EventEffect) {
    let tick = some_tick(scenario, random);
    let robot = random.below(scenario.robots.len());
    let effect = effect(robot, random);
    scenario.events.push(Event { when: Trigger::Tick(tick), effect });
}

/// A device of a robot freezes for good.
fn freeze(device: Device) -> impl Fn(usize, &mut Random) -> EventEffect {
    move |robot, _| EventEffect::Freeze(robot, device, None)
}

/// A tick at which the fastest team would be on its way.
fn some_tick(scenario: &Scenario, random: &mut Random) -> u32 {
    let (map, goals) = (&scenario.map, &scenario.goals);
    let nearest = scenario
        .robots
        .iter()
        .filter_map(|robot| goals.iter().map(|&goal| map.manhattan(robot.start, goal)).min());
    1 + random.below(usize::from(nearest.max().unwrap_or(1).max(1))) as u32
}

/// Adds obstacles in cells that no robot needs and that leave the rest of the map connected.
fn block(scenario: &mut Scenario, random: &mut Random) {
    scenario.robots.iter_mut().for_each(|robot| robot.paths.clear());
    let mut floor = scenario.map;
    let blocks = |event: &Event| if let EventEffect::Block(cell) = event.effect { Some(cell) } else { None };
    scenario.events.iter().filter_map(blocks).for_each(|cell| _ = floor.block(cell));
    let mut left = OBSTACLES;
    // A floor on which no cell can be spared keeps fewer obstacles.
    for _ in 0..64 * OBSTACLES {
        let cell = Cell(random.below(floor.len()) as u16);
        if left == 0 || !floor.is_free(cell) || is_needed(scenario, cell) {
            continue;
        }
        let blocked = floor.avoiding([cell]);
        if parts(&blocked) <= parts(&floor) {
            let tick = some_tick(scenario, random);
            scenario.events.push(Event { when: Trigger::Tick(tick), effect: EventEffect::Block(cell) });
            (floor, left) = (blocked, left - 1);
        }
    }
}

fn is_needed(scenario: &Scenario, cell: Cell) -> bool {
    scenario.has_place_at(cell) || scenario.robots.iter().any(|robot| robot.start == cell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library;

    fn scenario(name: &str) -> Scenario {
        library::find(name).unwrap().unwrap()
    }

    #[test]
    fn a_seed_draws_the_same_trouble_again_and_another_draws_another() {
        let base = scenario("factory");
        for disturbance in Disturbance::all() {
            assert_eq!(disturbance.applied(&base, 3), disturbance.applied(&base, 3));
            assert_eq!(Disturbance::find(disturbance.name()), Some(disturbance));
        }
        assert_eq!(Disturbance::None.applied(&base, 3), base);
        assert_ne!(Disturbance::Obstacles.applied(&base, 3), Disturbance::Obstacles.applied(&base, 4));
    }

    #[test]
    fn obstacles_leave_ways_and_what_robots_need() {
        for name in ["two-goals", "factory", "warehouse"] {
            let base = scenario(name);
            for seed in 0..50 {
                let disturbed = Disturbance::Obstacles.applied(&base, seed);
                let cells: Vec<_> = disturbed
                    .events
                    .iter()
                    .filter_map(
                        |event| if let EventEffect::Block(cell) = event.effect { Some(cell) } else { None },
                    )
                    .collect();
                assert_eq!(disturbed.events.len(), base.events.len() + OBSTACLES, "{name} {seed}");
                assert_eq!(parts(&base.map.avoiding(cells.iter().copied())), 1, "{name} {seed}: {cells:?}");
                assert!(base.goals.iter().all(|goal| !cells.contains(goal)), "{name} {seed}");
                assert!(base.robots.iter().all(|robot| !cells.contains(&robot.start)), "{name} {seed}");
            }
        }
    }

    #[test]
    fn all_is_everything_but_a_robot_that_stops_for_good() {
        let all = Disturbance::All.applied(&scenario("factory"), 1);
        assert_eq!((all.radio.loss, all.robots[0].slip, all.robots[2].localiser), (LOSS, SLIP, RIGHT));
        let has = |wanted: fn(&EventEffect) -> bool| all.events.iter().any(|event| wanted(&event.effect));
        assert!(
            has(|effect| matches!(effect, EventEffect::Charge(..)))
                && has(|effect| matches!(effect, EventEffect::Block(_)))
        );
        assert!(
            has(|effect| matches!(effect, EventEffect::Stop(_, Some(_))))
                && !has(|effect| matches!(effect, EventEffect::Stop(_, None)))
        );
    }
}
