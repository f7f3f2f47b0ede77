//! Reachability: by the drawn map, as many robots as needed have ways to goals that differ.
//!
//! The assignment uses augmenting paths (Kuhn 1955): a robot takes a goal that is free, or one that
//! another robot can exchange for a different goal.

use super::{Floor, MAX_CELLS, RobotSpec, Scenario};
use iibt_core::actions::HORIZON;
use iibt_core::grid::{Cell, Planner};
use iibt_core::navigation::Effect;

/// A robot without a goal, by its index, and the reason.
pub(crate) type Stranded = (usize, String);

/// Assigns robots to goals that differ, as many as needed, or names the first robot without one.
pub(super) fn enough_goals(
    map: &Floor,
    goals: &[Cell],
    robots: &[RobotSpec],
    need: usize,
) -> Result<(), Stranded> {
    let (found, stranded) = assigned(map, goals, robots);
    stranded.filter(|_| found < need).map_or(Ok(()), Err)
}

/// How many robots get goals that differ, and the first that gets none.
fn assigned(map: &Floor, goals: &[Cell], robots: &[RobotSpec]) -> (usize, Option<Stranded>) {
    let reachable: Vec<_> = robots.iter().map(|robot| reachable(map, goals, robot)).collect();
    let mut owners = vec![None; goals.len()];
    let mut stranded = None;
    for (index, robot) in robots.iter().enumerate() {
        if !takes_a_goal(index, &reachable, &mut vec![false; goals.len()], &mut owners) {
            stranded.get_or_insert_with(|| (index, reason(robot, goals, &reachable[index])));
        }
    }
    (owners.iter().flatten().count(), stranded)
}

/// In each world of positive prior, how many robots have ways to goals that differ and serve.
pub(crate) fn served(scenario: &Scenario) -> impl Iterator<Item = usize> {
    worlds(scenario).into_iter().map(|world| {
        let Scenario { map, goals, robots, .. } = scenario;
        let floor = map.avoiding(scenario.cells_of_unknowns(Effect::Blocks, &world, true));
        let useless: Vec<Cell> = scenario.useless_goals(&world).collect();
        let serving: Vec<Cell> = goals.iter().copied().filter(|goal| !useless.contains(goal)).collect();
        assigned(&floor, &serving, robots).0
    })
}

/// The values of the unknowns in each world of positive prior.
fn worlds(scenario: &Scenario) -> Vec<Vec<u8>> {
    scenario.unknowns.iter().fold(vec![Vec::new()], |worlds, unknown| {
        let values: Vec<u8> =
            (0_u8..).zip(&unknown.prior).filter(|(_, p)| **p > 0.0).map(|(v, _)| v).collect();
        let with = |world: Vec<u8>| {
            values.iter().map(move |&value| [world.as_slice(), &[value]].concat()).collect::<Vec<_>>()
        };
        worlds.into_iter().flat_map(with).collect()
    })
}

/// How many parts the free cells fall into between which no way leads.
pub(crate) fn parts(floor: &Floor) -> usize {
    let mut seen = floor.free_cells().without(&floor.free_cells());
    let is_first = |&cell: &Cell| {
        let is_new = !seen.contains(cell);
        seen = if is_new { seen.union(&floor.connected(cell)) } else { seen };
        is_new
    };
    floor.free_cells().iter().filter(is_first).count()
}

/// Whether a robot's plan can lead from its start to a cell.
pub(super) fn is_near(map: &Floor, robot: &RobotSpec, cell: Cell) -> bool {
    !reachable(map, &[cell], robot).is_empty()
}

/// The goals, by their index, that a robot's plan can lead to from its start.
fn reachable(map: &Floor, goals: &[Cell], robot: &RobotSpec) -> Vec<usize> {
    let mut planner = Planner::<MAX_CELLS>::new();
    let Ok(distances) = planner.distances(map, robot.start) else { return Vec::new() };
    let is_near = |goal| distances.to(goal).is_some_and(|moves| moves <= farthest(robot));
    (0..goals.len()).filter(|&index| is_near(goals[index])).collect()
}

/// The most moves that a plan of this robot has room for.
fn farthest(robot: &RobotSpec) -> u16 {
    HORIZON as u16 / u16::from(robot.steps())
}

/// Whether `robot` gets a goal, if need be by moving others to goals that are not `asked` for yet.
fn takes_a_goal(
    robot: usize,
    reachable: &[Vec<usize>],
    asked: &mut [bool],
    owners: &mut [Option<usize>],
) -> bool {
    reachable[robot].iter().any(|&goal| {
        let is_new = !std::mem::replace(&mut asked[goal], true);
        let is_free =
            is_new && owners[goal].is_none_or(|owner| takes_a_goal(owner, reachable, asked, owners));
        if is_free {
            owners[goal] = Some(robot);
        }
        is_free
    })
}

fn reason(robot: &RobotSpec, goals: &[Cell], reachable: &[usize]) -> String {
    let (name, start) = (&robot.name, robot.start.0);
    if reachable.is_empty() {
        let most = farthest(robot);
        return format!("{name} on {start} can reach no goal: no way of at most {most} moves leads to one");
    }
    let within: Vec<_> = reachable.iter().map(|&index| goals[index].0.to_string()).collect();
    let within = within.join(", ");
    format!("{name} on {start} can reach no goal of its own: other robots need those it can reach ({within})")
}

#[cfg(test)]
mod tests {
    use crate::Scenario;

    fn verdict(map: &str) -> String {
        let text = format!("title = 't'\nmap = '''\n{}\n'''", map.replace(' ', "\n"));
        Scenario::parse("drawn", &text).map_or_else(|error| error.reason, |_| "sound".to_owned())
    }

    #[test]
    fn as_many_robots_as_needed_have_a_way_to_a_goal() {
        assert_eq!(
            verdict("1.#G 2.#. ..#."),
            "R1 on 0 can reach no goal: no way of at most 64 moves leads to one"
        );
        assert_eq!(verdict("12. .G. ..."), "sound", "one goal is enough for one of two");
        assert_eq!(
            verdict("1.#G 2.#. G.#."),
            "R2 on 4 can reach no goal of its own: other robots need those it can reach (8)"
        );
        assert_eq!(
            verdict("1#G 2#. .#G"),
            "R1 on 0 can reach no goal: no way of at most 64 moves leads to one"
        );
        assert_eq!(verdict("1.G 2.. ..G"), "sound");
    }

    #[test]
    fn the_way_is_no_longer_than_a_plan() {
        let corridor = |moves: usize| verdict(&format!("1{}G", ".".repeat(moves - 1)));
        assert_eq!(corridor(64), "sound");
        assert!(corridor(65).contains("at most 64 moves"));
    }

    #[test]
    fn a_robot_gives_way_to_one_that_has_no_other_goal() {
        // R1 can have either goal, R2 the left one only, and R1 is asked first.
        let split = format!("G1{}G", ".".repeat(62));
        assert_eq!(verdict(&format!("2{split}")), "sound");
    }
}
