//! What a team settles on: the paths it agrees on, whatever it is compiled for and however it
//! shares out its work.

use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::{Faults, NavigatorFlight};
use iibt_core::grid::{Cell, Map, Move, Path};
use iibt_core::navigation::{Mission, Stage};

/// The paths on which a team agrees, for controllers compiled for `S` cells.
fn settled<const S: usize, const W: usize>(drawn: &str, starts: &[u16], goals: &[u16]) -> Vec<Path> {
    settled_with::<S, W>(drawn, starts, goals, &[]).0
}

/// The same where some robots have a budget of work units a tick, and the ticks that it takes.
fn settled_with<const S: usize, const W: usize>(
    drawn: &str,
    starts: &[u16],
    goals: &[u16],
    budgets: &[u32],
) -> (Vec<Path>, u32) {
    let cells = |numbers: &[u16]| numbers.iter().copied().map(Cell).collect::<Vec<_>>();
    let (starts, goals) = (cells(starts), cells(goals));
    let mission = Mission::new(Map::<W>::drawn(drawn).expect("a drawn map"), &starts, &goals);
    let flight = NavigatorFlight::<S, W, LAYERS, NODES, POLICIES>::over(&mission, Faults::default(), 0);
    let mut flight = flight.expect("a sound mission");
    for (robot, &budget) in budgets.iter().enumerate() {
        flight.robot_mut(robot).robot_mut().navigation_mut().set_budget(budget);
    }
    for _ in 0..2_000 {
        flight.tick();
        if flight.reports().iter().all(|report| report.stage == Stage::Agreed) {
            return (flight.reports().iter().map(|report| report.path).collect(), flight.ticks());
        }
    }
    panic!("no agreement on {drawn}");
}

const FLOOR: &str = ".......\n.......\n.......\n.......\n.......\n.......\n.......";

#[test]
fn an_empty_floor_is_crossed_in_the_fewest_moves() {
    let moves_of = |path: &Path| path.moves().filter(|&step| step != Move::Wait).count();
    for (starts, goals, moves) in [([0, 42], [6, 48], 6), ([28, 2], [24, 26], 6), ([0, 48], [3, 45], 3)] {
        let paths = settled::<49, 2>(FLOOR, &starts, &goals);
        let longest = paths.iter().map(moves_of).max();
        assert_eq!(longest, Some(moves), "{starts:?} to {goals:?}: {paths:?}");
    }
}

#[test]
fn a_team_of_any_size_agrees_in_three_ticks_after_the_first_frames() {
    let (starts, goals) = ([0, 2, 4, 6, 42, 44, 46, 48], [15, 16, 17, 18, 29, 30, 31, 32]);
    for (team, ticks) in [(1, 1), (2, 3), (3, 3), (5, 3), (8, 3)] {
        assert_eq!(
            settled_with::<49, 2>(FLOOR, &starts[..team], &goals[..team], &[]).1,
            ticks,
            "{team} robots"
        );
    }
}

#[test]
fn the_choice_does_not_depend_on_how_much_a_robot_works_in_a_tick() {
    let (starts, goals) = ([0, 2, 42, 45], [24, 32, 26, 30]);
    let (paths, ticks) = settled_with::<49, 2>(FLOOR, &starts, &goals, &[]);
    for budgets in [[1; 4], [7; 4], [3, 1, 1000, 50], [1000, 1000, 1000, 1]] {
        let (slowly, later) = settled_with::<49, 2>(FLOOR, &starts, &goals, &budgets);
        assert_eq!(slowly, paths, "{budgets:?}");
        assert!(later > ticks, "{budgets:?}: {later}");
    }
}

#[test]
fn the_choice_does_not_depend_on_the_size_that_a_controller_is_compiled_for() {
    let drawn = "1..G\n2..G".replace(['1', '2', 'G'], ".");
    let exact = settled::<8, 1>(&drawn, &[0, 4], &[3, 7]);
    assert_eq!(settled::<16, 1>(&drawn, &[0, 4], &[3, 7]), exact);
    assert_eq!(settled::<49, 2>(&drawn, &[0, 4], &[3, 7]), exact);
    assert_eq!(settled::<256, 8>(&drawn, &[0, 4], &[3, 7]), exact);
}
