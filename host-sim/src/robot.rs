//! A robot as the simulator sees it, whatever flies it.

use crate::body::Body;
use crate::scenario::Floor;
use firmware::{Controller, LinkReport, Navigator};
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{MAX_GOALS, Report};

/// A robot that flies, whatever the size its controller is compiled for.
pub(crate) trait AnyRobot {
    /// One tick of its controller.
    fn tick(&mut self);
    /// What it says of itself.
    fn report(&self) -> Report;
    /// What became of its frames.
    fn link_report(&self) -> LinkReport;
    /// The leaf of its tree that is running.
    fn activity(&self) -> Option<&'static str>;
    /// Tells it to visit a cell; returns whether it will.
    fn visit(&mut self, cell: Cell) -> bool;
    /// Sets its preference for each goal; to a conventional one it makes no difference.
    fn prefer(&mut self, _: &[f32; MAX_GOALS]) {}
    /// The way-points that it is still to visit.
    fn waypoints(&self) -> &[Cell];
    /// The probability that it gives to a cell of being its own.
    fn belief(&self, cell: Cell) -> f32;
    /// The body it works in.
    fn body(&mut self) -> &mut Body;
}

/// The same map in fewer words.
pub(crate) fn shrunk<const W: usize>(floor: &Floor) -> Map<W> {
    let mut map = Map::new(floor.width(), floor.height()).unwrap_or_else(|_| unreachable!("W fits the map"));
    for cell in (0..floor.len() as u16).map(Cell).filter(|&cell| !floor.is_free(cell)) {
        map.block(cell);
    }
    map
}

impl<const S: usize, const W: usize, const P: usize> AnyRobot for Controller<Navigator<'_, S, W, P>, Body> {
    fn tick(&mut self) {
        Controller::tick(self);
    }

    fn report(&self) -> Report {
        self.robot().navigation().report()
    }

    fn link_report(&self) -> LinkReport {
        Controller::link_report(self)
    }

    fn activity(&self) -> Option<&'static str> {
        self.robot().activity()
    }

    fn visit(&mut self, cell: Cell) -> bool {
        self.robot_mut().navigation_mut().visit(cell).is_ok()
    }

    fn prefer(&mut self, values: &[f32; MAX_GOALS]) {
        self.robot_mut().navigation_mut().prefer(values);
    }

    fn waypoints(&self) -> &[Cell] {
        self.robot().navigation().waypoints()
    }

    fn belief(&self, cell: Cell) -> f32 {
        self.robot().navigation().probability_of(cell)
    }

    fn body(&mut self) -> &mut Body {
        self.hardware_mut()
    }
}
