//! The judge of a flight: counts collisions by rules of its own, from where the robots are and from
//! nothing else.

use host_sim::{AnyRobot, Flight};
use iibt_core::grid::Cell;

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// The tick at which all robots had arrived, if they did.
    pub arrived: Option<u32>,
    /// How often two robots shared or swapped a cell.
    pub collisions: u32,
    /// How many copies of frames were lost.
    pub lost: u32,
}

/// The cells that each robot is in: two while it is between them.
fn occupied<R: AnyRobot + ?Sized>(flight: &Flight<'_, R>) -> Vec<Vec<Cell>> {
    let both =
        |(&cell, entering): (&Cell, Option<Cell>)| [Some(cell), entering].into_iter().flatten().collect();
    flight.cells().iter().zip(flight.entering()).map(both).collect()
}

/// The pairs of robots that share a cell or have gone through each other, by the cells before and
/// after a tick.
fn collisions(before: &[Vec<Cell>], after: &[Vec<Cell>]) -> u32 {
    let mut count = 0;
    for one in 0..after.len() {
        for other in 0..one {
            let shared = after[one].iter().any(|cell| after[other].contains(cell));
            let swapped = after[one][0] == before[other][0] && after[other][0] == before[one][0];
            count += u32::from(shared || swapped);
        }
    }
    count
}

/// Flies until all have arrived or the limit is reached.
pub fn fly<R: AnyRobot + ?Sized>(flight: &mut Flight<'_, R>, limit: u32) -> Outcome {
    fly_until(flight, limit, |flight| flight.has_arrived())
}

/// Flies until those have arrived who are asked for, or the limit is reached.
pub fn fly_until<'m, R: AnyRobot + ?Sized>(
    flight: &mut Flight<'m, R>,
    limit: u32,
    have_arrived: impl Fn(&Flight<'m, R>) -> bool,
) -> Outcome {
    let mut outcome = Outcome { arrived: None, collisions: 0, lost: 0 };
    while outcome.arrived.is_none() && flight.ticks() < limit {
        let before = occupied(flight);
        flight.tick();
        outcome.collisions += collisions(&before, &occupied(flight));
        outcome.arrived = have_arrived(flight).then(|| flight.ticks());
    }
    outcome.lost = flight.traffic().iter().map(|traffic| traffic.lost).sum();
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shared_cell_a_cell_on_the_way_and_a_swap_count_and_following_does_not() {
        let at = |cells: [&[u16]; 2]| cells.map(|cells| cells.iter().copied().map(Cell).collect()).to_vec();
        for (before, after, expected) in [
            ([&[0][..], &[2]], [&[1][..], &[1]], 1),
            ([&[0], &[2]], [&[0, 1], &[1]], 1),
            ([&[0], &[1]], [&[1], &[0]], 1),
            ([&[0], &[1]], [&[1], &[2]], 0),
            ([&[0], &[3]], [&[0, 1], &[3, 2]], 0),
        ] {
            assert_eq!(collisions(&at(before), &at(after)), expected, "{before:?} {after:?}");
        }
    }
}
