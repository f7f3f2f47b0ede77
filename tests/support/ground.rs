//! The ground of random missions.

use host_sim::Random;
use iibt_core::grid::{Cell, Map, Planner};

/// A map with walls in about a tenth of its cells, and at least so many free cells within reach of
/// each other.
///
/// # Panics
/// Where no such map is found, which has 49 cells.
#[must_use]
pub fn ground(random: &mut Random, least: usize) -> (Map<2>, Vec<Cell>) {
    let mut planner = Planner::<49>::new();
    loop {
        let mut map = Map::new(7, 7).expect("49 cells fit two words");
        for cell in 0..49 {
            if random.bernoulli(0.1) {
                map.block(Cell(cell));
            }
        }
        let mut free: Vec<Cell> = (0..49).map(Cell).filter(|&cell| map.is_free(cell)).collect();
        let anchor = free[0];
        free.retain(|&cell| planner.shortest(&map, anchor, cell).is_ok());
        if free.len() >= least {
            return (map, free);
        }
    }
}
