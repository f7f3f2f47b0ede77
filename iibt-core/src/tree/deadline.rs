//! The deadline of a running tree.

use super::context::TickContext;
use super::kinds::Kinds;
use super::kinds::sealed::Extra;
use super::leaves::Leaves;
use super::node::Node;
use super::status::Next;
use crate::time::{Duration, Instant};

impl<L, V: Leaves<L> + ?Sized, K: Kinds> TickContext<'_, L, V, K> {
    /// The earliest time at which a timer is due; visits every node once.
    #[inline(never)]
    pub(super) fn next_deadline(&mut self) -> Next {
        let mut earliest: Option<Instant> = None;
        for at in 0..self.rows.len() {
            if let Some(due) = self.deadline(at)
                && earliest.is_none_or(|earliest| earliest.has_reached(due))
            {
                earliest = Some(due);
            }
        }
        match earliest {
            Some(due) if self.now.has_reached(due) => Next::Now,
            Some(due) => Next::At(due),
            None => Next::Event,
        }
    }

    /// The time for which the node in row `at` waits, if it is running.
    fn deadline(&mut self, at: usize) -> Option<Instant> {
        let (row, cell) = (self.rows.get(at)?, self.cells.get(at)?);
        if !cell.is_running() {
            return None;
        }
        let time = match &row.node {
            Node::Timeout(time) if time.get() > 0 => time,
            Node::Sleep(time) => time,
            Node::Delay(time) if !cell.slot.has_flag() => time,
            Node::RateController(time) if !self.is_running(at + 1) => time,
            Node::Action(leaf) | Node::Inference(leaf) => return self.leaves.deadline(leaf, self.now),
            _ => return None,
        };
        Some(Instant(cell.extra.get()).after(Duration(time.get())))
    }
}
