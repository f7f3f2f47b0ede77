//! The paths that a team agrees on are the same for every size of map it is compiled for.

use host_sim::{Faults, NavigatorFlight};
use iibt_core::grid::{Cell, Map, Path};
use iibt_core::navigation::{Mission, Stage};

/// The paths on which a team agrees, for controllers compiled for `S` cells.
fn settled<const S: usize, const W: usize>(drawn: &str, starts: &[u16], goals: &[u16]) -> Vec<Path> {
    let (starts, goals) = (
        starts.iter().copied().map(Cell).collect::<Vec<_>>(),
        goals.iter().copied().map(Cell).collect::<Vec<_>>(),
    );
    let mission = Mission::new(Map::<W>::drawn(drawn).expect("a drawn map"), &starts, &goals);
    let flight = NavigatorFlight::<S, W, 16>::over(&mission, Faults::default(), 0);
    let mut flight = flight.expect("a sound mission");
    for _ in 0..20 {
        flight.tick();
        if flight.reports().iter().all(|report| report.stage == Stage::Agreed) {
            return flight.reports().iter().map(|report| report.path).collect();
        }
    }
    panic!("no agreement on {drawn}");
}

#[test]
fn an_empty_floor_is_crossed_in_the_fewest_moves() {
    let floor = ".......\n.......\n.......\n.......\n.......\n.......\n.......";
    for (starts, goals, moves) in [([0, 42], [6, 48], 6), ([28, 2], [24, 26], 6), ([0, 48], [3, 45], 3)] {
        let lengths: Vec<usize> = settled::<49, 2>(floor, &starts, &goals).iter().map(Path::len).collect();
        assert_eq!(lengths, [moves, moves], "{starts:?} to {goals:?}");
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
