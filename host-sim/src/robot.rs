//! The simulator's view of a robot with any pilot.

use crate::body::Body;
use crate::phases::WeighedPolicy;
use crate::scenario::Floor;
use firmware::{Controller, LinkReport, Navigator};
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{MAX_GOALS, Report};
use iibt_core::tree::{Status, TickEntry};

/// A flying robot, whose controller may be compiled for any size of map.
///
/// Implemented for the firmware's [`Controller`] of a [`Navigator`], or of a robot with a
/// conventional tree, in a simulated body.
pub trait AnyRobot {
    /// Takes in what the body senses and hears, before any robot of the team ticks.
    fn prepare(&mut self) {}
    /// Ticks its controller once; returns what its tree returned.
    fn tick(&mut self) -> Status;
    /// Its report.
    fn report(&self) -> Report;
    /// The traffic of its frames.
    fn link_report(&self) -> LinkReport;
    /// Whether the numbers of this epoch's frames are used up, so that it must start again.
    fn needs_new_epoch(&self) -> bool {
        false
    }
    /// The leaf of its tree that is running.
    fn activity(&self) -> Option<&'static str>;
    /// The nodes of its tree that its last tick has changed, unless they are those of the tick
    /// before; a conventional robot does not tell.
    fn tree_entry(&self) -> Option<TickEntry<'_>> {
        None
    }
    /// Tells it to visit a cell; returns whether it will.
    fn visit(&mut self, cell: Cell) -> bool;
    /// Sets its preference for each goal; a conventional robot ignores it.
    fn set_goal_preferences(&mut self, _: &[f32; MAX_GOALS]) {}
    /// The way-points that it is still to visit.
    fn waypoints(&self) -> &[Cell];
    /// The probability that it gives to a cell of being its own.
    fn belief(&self, cell: Cell) -> f32;
    /// The probability that it gives to each world of a mission of which not all is known; none
    /// before its first decision.
    fn worlds(&self) -> Vec<f32> {
        Vec::new()
    }
    /// The joint policies as it has weighed them in its round, in the order of the list.
    fn weighed(&self) -> Vec<WeighedPolicy> {
        Vec::new()
    }
    /// The body it works in.
    fn body(&mut self) -> &mut Body;
}

/// Copies a map into another number of words; `None` when it does not fit.
pub(crate) fn resized<const A: usize, const B: usize>(map: &Map<A>) -> Option<Map<B>> {
    let mut resized = Map::new(map.width(), map.height()).ok()?;
    for cell in (0..map.len() as u16).map(Cell).filter(|&cell| !map.is_free(cell)) {
        resized.block(cell);
    }
    Some(resized)
}

/// Copies a map into fewer words.
pub(crate) fn shrunk<const W: usize>(floor: &Floor) -> Map<W> {
    resized(floor).unwrap_or_else(|| unreachable!("W fits the map"))
}

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> AnyRobot
    for Controller<Navigator<'_, S, W, L, M, K>, Body>
{
    fn tick(&mut self) -> Status {
        Controller::tick(self)
    }

    fn report(&self) -> Report {
        self.robot().navigation().report()
    }

    fn link_report(&self) -> LinkReport {
        Controller::link_report(self)
    }

    fn needs_new_epoch(&self) -> bool {
        Controller::needs_new_epoch(self)
    }

    fn activity(&self) -> Option<&'static str> {
        self.robot().activity()
    }

    fn tree_entry(&self) -> Option<TickEntry<'_>> {
        self.robot().tree_entry()
    }

    fn visit(&mut self, cell: Cell) -> bool {
        self.robot_mut().navigation_mut().visit(cell).is_ok()
    }

    fn set_goal_preferences(&mut self, values: &[f32; MAX_GOALS]) {
        self.robot_mut().navigation_mut().set_goal_preferences(values);
    }

    fn waypoints(&self) -> &[Cell] {
        self.robot().navigation().waypoints()
    }

    fn belief(&self, cell: Cell) -> f32 {
        self.robot().navigation().localisation().probability_of(cell)
    }

    fn worlds(&self) -> Vec<f32> {
        self.robot().navigation().worlds().to_vec()
    }

    fn weighed(&self) -> Vec<WeighedPolicy> {
        let weighed = self.robot().navigation().weighed();
        let pairs = weighed.costs().iter().zip(weighed.posterior());
        pairs.map(|(&cost, &probability)| WeighedPolicy::of(cost, probability)).collect()
    }

    fn body(&mut self) -> &mut Body {
        self.hardware_mut()
    }
}
