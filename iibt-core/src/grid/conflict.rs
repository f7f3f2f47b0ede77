//! Conflicts between two robots that follow their paths step by step.
//!
//! A robot is at `a(k)` at step `k` and stays on its last cell for ever after. Beside the two
//! conflicts that are collisions when all goes to plan, a robot must not enter a cell in the same
//! step in which the other leaves it: if the other is delayed by one step, it is still there. Plans
//! without any of the three are 1-robust (Atzmon et al., Robust Multi-Agent Path Finding, SoCS
//! 2018), with the difference that a swap, which is two such entries at once, keeps its own name.

use super::{Cell, Map, Path};
use core::fmt;

/// The kind of a conflict between two robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConflictKind {
    /// Both are on one cell: `a(k) = b(k)`.
    Same,
    /// They exchange their cells: `a(k) = b(k - 1)` and `b(k) = a(k - 1)`.
    Swap,
    /// One enters the cell that the other leaves in this step: `a(k) = b(k - 1)` or `b(k) = a(k -
    /// 1)`.
    Follow,
}

/// The first step at which two robots are in conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Conflict {
    /// The kind.
    pub kind: ConflictKind,
    /// The step at whose end it has occurred, 0 to [`HORIZON`](crate::actions::HORIZON); the start
    /// is step 0.
    pub step: u8,
    /// The cell that both want; of a swap, the cell that the first robot enters.
    pub cell: Cell,
}

/// The first conflict of two paths that begin in the same step, or `None`.
///
/// Cost: linear in the length of the longer path.
///
/// ```
/// use iibt_core::grid::{Cell, Conflict, ConflictKind, Map, Path, first_conflict, words};
///
/// let map = Map::<{ words(7, 7) }>::new(7, 7)?;
/// let through = |cells: [u16; 3]| Path::through(&map, &cells.map(Cell)).ok_or("no neighbours");
/// let (right, left) = (through([28, 29, 30])?, through([30, 29, 28])?);
/// let meeting = Conflict { kind: ConflictKind::Same, step: 1, cell: Cell(29) };
/// assert_eq!(first_conflict(&map, &right, &left), Some(meeting));
/// assert_eq!(first_conflict(&map, &right, &through([14, 15, 16])?), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "collision")]
#[doc(alias = "vertex conflict")]
#[doc(alias = "edge conflict")]
#[must_use]
pub fn first_conflict<const W: usize>(map: &Map<W>, a: &Path, b: &Path) -> Option<Conflict> {
    let mut before = None;
    let steps = 0..=a.len().max(b.len()) as u8;
    steps.zip(a.timeline(map).zip(b.timeline(map))).find_map(|(step, now)| {
        let (kind, cell) = clash(before.replace(now), now)?;
        Some(Conflict { kind, step, cell })
    })
}

/// The conflict in one step between two robots that were at `before` and are at `now`.
fn clash(before: Option<(Cell, Cell)>, now: (Cell, Cell)) -> Option<(ConflictKind, Cell)> {
    let (a, b) = now;
    if a == b {
        return Some((ConflictKind::Same, a));
    }
    let (a_before, b_before) = before?;
    match (a == b_before, b == a_before) {
        (true, true) => Some((ConflictKind::Swap, a)),
        (true, false) => Some((ConflictKind::Follow, a)),
        (false, true) => Some((ConflictKind::Follow, b)),
        (false, false) => None,
    }
}

impl fmt::Display for Conflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (cell, step) = (self.cell.0, self.step);
        match self.kind {
            ConflictKind::Same => write!(f, "both on cell {cell} at step {step}"),
            ConflictKind::Swap => write!(f, "they swap cells, one into cell {cell}, at step {step}"),
            ConflictKind::Follow => {
                write!(f, "one enters cell {cell} at step {step} while the other leaves it")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pictures::{drawn, moving, paper};
    use super::ConflictKind::{Follow, Same, Swap};
    use super::*;
    use std::string::ToString;
    use std::vec::Vec;

    /// Two robots `a` and `b` drawn at every step on a corridor, and what happens to them.
    fn check(frames: &[&str], expected: Option<(ConflictKind, u8, u16)>) {
        let corridor = drawn(&[".".repeat(frames[0].len()).as_str()]);
        let (a, b) = (moving(frames, 'a'), moving(frames, 'b'));
        let expected = expected.map(|(kind, step, cell)| Conflict { kind, step, cell: Cell(cell) });
        assert_eq!(first_conflict(&corridor, &a, &b), expected, "{frames:?}");
        let kind = |conflict: Option<Conflict>| conflict.map(|conflict| (conflict.kind, conflict.step));
        assert_eq!(kind(first_conflict(&corridor, &b, &a)), kind(expected), "reversed {frames:?}");
    }

    #[test]
    fn keeping_away_is_no_conflict() {
        check(&["a..b", "a..b", ".a.b"], None);
        check(&["a.b", "a.b"], None);
    }

    #[test]
    fn two_on_one_cell() {
        check(&["a...b", ".a.b.", "..x.."], Some((Same, 2, 2)));
        check(&["x.."], Some((Same, 0, 0)));
    }

    #[test]
    fn exchanging_cells() {
        check(&["a..b", ".ab.", ".ba."], Some((Swap, 2, 2)));
    }

    #[test]
    fn entering_the_cell_another_leaves() {
        check(&["ab..", ".ab."], Some((Follow, 1, 1)));
        check(&["ab..", "a.b.", ".a.b"], None);
        check(&["ba..", "b.a.", ".ba."], None);
    }

    #[test]
    fn whoever_has_arrived_stays_there() {
        let map = drawn(&["....."]);
        let walker = moving(&["a....", ".a...", "..a..", "...a."], 'a');
        let conflict = Conflict { kind: Same, step: 3, cell: Cell(3) };
        assert_eq!(first_conflict(&map, &walker, &Path::at(Cell(3))), Some(conflict));
        assert_eq!(first_conflict(&map, &walker, &Path::at(Cell(4))), None);
    }

    /// The paper's own plans for its third experiment collide in phases two to four.
    #[test]
    fn finds_the_collisions_of_the_papers_plans() {
        let map = paper(&[]);
        let path = |cells: &[u16]| {
            Path::through(&map, &cells.iter().copied().map(Cell).collect::<Vec<_>>()).unwrap()
        };
        let conflict =
            first_conflict(&map, &path(&[9, 10, 17, 24, 31, 32]), &path(&[38, 38, 31, 24, 25, 26]));
        assert_eq!(conflict, Some(Conflict { kind: Same, step: 3, cell: Cell(24) }));
        let conflict =
            first_conflict(&map, &path(&[16, 17, 18, 18, 25, 25, 32]), &path(&[38, 39, 32, 25, 18, 17, 24]));
        assert_eq!(conflict, Some(Conflict { kind: Swap, step: 4, cell: Cell(25) }));
    }

    #[test]
    fn says_what_happens() {
        let conflict = Conflict { kind: Follow, step: 3, cell: Cell(24) };
        assert_eq!(conflict.to_string(), "one enters cell 24 at step 3 while the other leaves it");
    }
}
