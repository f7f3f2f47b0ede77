//! Paths on a map.

use super::legend::{Legend, Mark};
use super::svg::{Anchor, Svg, colour};
use crate::reproduce::figure::{Grid, Track};
use iibt_core::grid::Cell;
use maud::Markup;

/// The side of a cell, in pixels.
const SIDE: f64 = 38.0;

/// Room around the map.
const MARGIN: f64 = 4.0;

pub(super) fn draw(grid: &Grid) -> Markup {
    let (columns, rows) = (f64::from(grid.width), f64::from(grid.height));
    let (width, bottom) = (columns * SIDE + 2.0 * MARGIN, rows * SIDE + 2.0 * MARGIN);
    let tracks = grid.paths.iter().enumerate();
    let legend =
        Legend::new(Mark::Dot, width, tracks.map(|(index, track)| (track.name.as_str(), colour(index + 1))));
    let mut svg = Svg::new(width, bottom + legend.height());
    floor(grid, &mut svg);
    for (index, track) in grid.paths.iter().enumerate() {
        path(grid, track, index, &mut svg);
    }
    for &cell in &grid.conflicts {
        svg.circle("conflict", centre(grid, cell), SIDE * 0.46);
    }
    legend.draw((MARGIN, bottom), &mut svg);
    svg.finish(&grid.title)
}

fn floor(grid: &Grid, svg: &mut Svg) {
    for index in 0..grid.width * grid.height {
        let cell = Cell(index);
        let corner = corner(grid, cell);
        let is_blocked = grid.blocked.contains(&cell);
        let class = match () {
            () if is_blocked => "cell blocked",
            () if grid.goals.contains(&cell) => "cell goal",
            () if grid.chargers.contains(&cell) => "cell charger",
            () if grid.way_points.contains(&cell) => "cell point",
            () => "cell",
        };
        svg.rectangle(class, corner, (SIDE, SIDE), 0.0);
        let number = if is_blocked { "number light" } else { "number" };
        svg.text(number, (corner.0 + 3.0, corner.1 + 10.0), Anchor::Start, index);
    }
}

/// A path, a little beside the middle so that those of other robots stay visible; waits are rings
/// with their number.
fn path(grid: &Grid, track: &Track, index: usize, svg: &mut Svg) {
    let aside = (index as f64 - (grid.paths.len() as f64 - 1.0) / 2.0) * 5.0;
    let at = |cell: Cell| {
        let (x, y) = centre(grid, cell);
        (x + aside, y + aside)
    };
    let points: Vec<_> = track.cells.iter().map(|&cell| at(cell)).collect();
    let class = colour(index + 1);
    svg.polyline(&format!("path {class}"), &points);
    if let Some(&start) = points.first() {
        svg.circle(&format!("dot {class}"), start, 5.0);
    }
    for run in track.cells.chunk_by(|before, after| before == after).filter(|run| run.len() > 1) {
        let (x, y) = at(run[0]);
        svg.circle(&format!("ring {class}"), (x, y), 7.0);
        svg.text("wait", (x + 9.0, y - 5.0), Anchor::Start, run.len() - 1);
    }
    arrow(&points, &class, svg);
}

/// The head at the end of a path.
fn arrow(points: &[(f64, f64)], class: &str, svg: &mut Svg) {
    let Some(&(x, y)) = points.last() else { return };
    let Some(&(before_x, before_y)) = points.iter().rev().find(|&&point| point != (x, y)) else { return };
    let (dx, dy) = (x - before_x, y - before_y);
    let length = dx.hypot(dy);
    let (dx, dy) = (6.0 * dx / length, 6.0 * dy / length);
    svg.polygon(
        &format!("head {class}"),
        &[(x + dx, y + dy), (x - dx - dy, y - dy + dx), (x - dx + dy, y - dy - dx)],
    );
}

fn corner(grid: &Grid, cell: Cell) -> (f64, f64) {
    let width = grid.width.max(1);
    (MARGIN + SIDE * f64::from(cell.0 % width), MARGIN + SIDE * f64::from(cell.0 / width))
}

fn centre(grid: &Grid, cell: Cell) -> (f64, f64) {
    let (x, y) = corner(grid, cell);
    (x + SIDE / 2.0, y + SIDE / 2.0)
}
