//! Tours: how a team shares a search, each robot going from one cell where it sees something to the
//! next.

use super::mission::Mission;
use super::policies::TeamPlan;
use super::prospects::{Bits, NO_WAY, Prospects, bits, worlds_of};
use super::targets::Targets;
use super::unknown::{Effect, MAX_VALUES, Tells, Unknown};
use crate::bounded::up_to;
use crate::grid::joint::{Prefix, Target};
use crate::grid::{Cell, CellSet, Map, Move, Path};
use crate::team::MAX_TEAM;
use heapless::Vec;

/// The most moves of a tour.
const LONGEST: usize = 32;

/// The most waits that keep a robot from getting in the way of another one.
const MOST_WAITS: usize = 3;

/// The way of a robot that sees one thing after another.
#[derive(Clone, Debug)]
struct Tour<const S: usize> {
    robot: u8,
    path: Path,
    /// The moves to each cell where it sees something.
    stops: Vec<u8, MAX_VALUES>,
    /// The distance of each cell from the last of them.
    distances: [u8; S],
}

impl<const S: usize> Tour<S> {
    fn begin<const W: usize>(map: &Map<W>, robot: u8, at: Cell, closed: &CellSet<W>) -> Self {
        let mut tour = Self { robot, path: Path::at(at), stops: Vec::new(), distances: [NO_WAY; S] };
        tour.measure(map, at, closed);
        tour
    }

    fn measure<const W: usize>(&mut self, map: &Map<W>, at: Cell, closed: &CellSet<W>) {
        let here = [at].into_iter().collect();
        map.distances(&here, &closed.without(&here), &mut self.distances);
    }

    /// The moves from the start until the robot has gone on to a cell, if it can.
    fn moves_to(&self, cell: Cell) -> Option<usize> {
        let more = self.distances.get(cell.index()).filter(|&&distance| distance != NO_WAY)?;
        Some(self.path.len() + usize::from(*more)).filter(|&moves| moves <= LONGEST)
    }

    /// Goes on to another cell; returns whether there was room.
    fn go_on<const W: usize>(&mut self, map: &Map<W>, way: &Path, closed: &CellSet<W>) -> bool {
        let is_whole = way.moves().all(|step| self.path.push(step).is_ok());
        self.measure(map, way.end(map), closed);
        // A tour of so many moves fits a byte.
        is_whole && self.stops.push(self.path.len() as u8).is_ok()
    }

    /// The path as far as the robot can go with others on theirs, after some waits if need be; it
    /// stands where it cannot go anywhere.
    fn clear_of<const W: usize>(&self, map: &Map<W>, others: &[Path]) -> Path {
        let cut = |(&stop, waits): (&u8, usize)| {
            let moves = self.path.moves().take(stop.into());
            let mut path = Path::at(self.path.start);
            let mut waited = core::iter::repeat_n(Move::Wait, waits).chain(moves);
            waited.all(|step| path.push(step).is_ok()).then_some(path)
        };
        let is_clear = |path: &Path| {
            let meets = |other: &Path| {
                TeamPlan::new(&[*path, *other]).is_none_or(|pair| pair.conflict(map).is_some())
            };
            !others.iter().any(meets)
        };
        let stops = self.stops.iter().rev();
        let mut all = stops.flat_map(|stop| (0..=MOST_WAITS).map(move |waits| (stop, waits))).filter_map(cut);
        all.find(is_clear).unwrap_or(Path::at(self.path.start))
    }
}

impl Targets {
    /// Robots share the goals that may serve, and see of one after another whether it does: the
    /// next one is that of which a robot learns the most for the moves until then.
    pub(super) fn tours<const S: usize, const W: usize>(
        &self,
        mission: &Mission<'_, W>,
        prospects: &Prospects<S, W>,
        closed: &CellSet<W>,
    ) -> Option<TeamPlan> {
        let closed = closed.union(prospects.doubtful());
        let is_serving = |(_, unknown): &(_, &Unknown<'_>)| unknown.effect == Effect::Serves;
        let (number, unknown) = prospects.open(mission).find(is_serving)?;
        let seekers = self.errands.iter().enumerate().filter(|(_, errand)| errand.target == Target::Any);
        let mut tours: Vec<Tour<S>, MAX_TEAM> = up_to(
            seekers.map(|(place, errand)| Tour::begin(&mission.map, place as u8, errand.from, &closed)),
        );
        let is_open = |&value: &usize| prospects.is_undecided((number, unknown), value);
        let mut left = bits(prospects.by_value(number).filter(is_open));
        while let Some((index, value, cell)) = best(&tours, prospects, (number, unknown), left) {
            left &= !(1 << value);
            let tour = tours.get_mut(index)?;
            let mut here = self.clone();
            here.errands.get_mut(usize::from(tour.robot))?.from = tour.path.end(&mission.map);
            let way = Prefix::by(&here.problem(mission, closed), tour.robot, cell, 0)?;
            if !tour.go_on(&mission.map, &way.path, &closed) {
                return None;
            }
        }
        // Those that stand are in the way of all; then each keeps out of the way of those before
        // it.
        let mut paths: Vec<Path, MAX_TEAM> = up_to(self.errands.iter().map(|errand| Path::at(errand.from)));
        tours.retain(|tour| !tour.stops.is_empty());
        let stands = |place: usize| tours.iter().all(|tour| usize::from(tour.robot) != place);
        let mut others: Vec<Path, MAX_TEAM> =
            up_to(paths.iter().enumerate().filter(|&(place, _)| stands(place)).map(|(_, path)| *path));
        for tour in &tours {
            let path = tour.clear_of(&mission.map, &others);
            // There is room for one of each robot.
            let _ = others.push(path);
            if let Some(slot) = paths.get_mut(usize::from(tour.robot)) {
                *slot = path;
            }
        }
        TeamPlan::new(&paths).filter(|plan| plan.conflict(&mission.map).is_none())
    }
}

/// The tour, the value, and the cell from where it is seen whether that is the one, at which most
/// is learnt for the moves until then.
fn best<const S: usize, const W: usize>(
    tours: &[Tour<S>],
    prospects: &Prospects<S, W>,
    (number, unknown): (usize, &Unknown<'_>),
    left: Bits,
) -> Option<(usize, usize, Cell)> {
    let sight = |tour: &Tour<S>, value: usize| {
        let tells = |tells: Tells| tells == Tells::Value || tells == Tells::Whether(value as u8);
        let cells = unknown.sights.iter().filter(|sight| tells(sight.tells)).map(|sight| sight.from);
        cells.filter_map(|cell| Some((tour.moves_to(cell)?, cell))).min()
    };
    let pairs = tours.iter().enumerate().flat_map(|pair| worlds_of(left).map(move |value| (pair, value)));
    let rates = pairs.filter_map(|((index, tour), value)| {
        let (moves, cell) = sight(tour, value)?;
        let rate = prospects.probability(number, value) / (1.0 + moves as f32);
        Some((rate, (index, value, cell)))
    });
    Some(rates.reduce(|best, other| if other.0 > best.0 { other } else { best })?.1)
}
