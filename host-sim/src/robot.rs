//! A robot as the simulator sees it, whatever flies it.

use crate::body::Body;
use crate::scenario::Floor;
use firmware::{Controller, Report};
use iibt_core::grid::{Cell, Map};
use iibt_core::iibt::navigation::MAX_GOALS;

/// A robot that flies, whatever the size its controller is compiled for.
pub(crate) trait Robot {
    /// One tick of its controller.
    fn tick(&mut self);
    /// What its controller says of itself.
    fn report(&self) -> Report;
    /// The leaf of its tree that is running.
    fn activity(&self) -> Option<&'static str>;
    /// Tells it to visit a cell; returns whether it will.
    fn visit(&mut self, cell: Cell) -> bool;
    /// Has each goal worth so much to it; to a conventional one it makes no difference.
    fn prefer(&mut self, _: &[f32; MAX_GOALS]) {}
    /// The way-points that it is still to visit.
    fn waypoints(&self) -> &[Cell];
    /// How likely it takes itself to be in a cell.
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

impl<const S: usize, const W: usize, const P: usize> Robot for Controller<'_, Body, S, W, P> {
    fn tick(&mut self) {
        Controller::tick(self);
    }

    fn report(&self) -> Report {
        Controller::report(self)
    }

    fn activity(&self) -> Option<&'static str> {
        Controller::activity(self)
    }

    fn visit(&mut self, cell: Cell) -> bool {
        Controller::visit(self, cell).is_ok()
    }

    fn prefer(&mut self, values: &[f32; MAX_GOALS]) {
        Controller::prefer(self, values);
    }

    fn waypoints(&self) -> &[Cell] {
        self.navigation().waypoints()
    }

    fn belief(&self, cell: Cell) -> f32 {
        self.navigation().probability_of(cell)
    }

    fn body(&mut self) -> &mut Body {
        self.hardware_mut()
    }
}
