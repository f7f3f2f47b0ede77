//! Localisation: the belief over the robot's own cell, and the learned reliability of its drive.
//!
//! A move that fails leaves the robot where it is. How often each move does is learned, as counts
//! of B, and predicted: a reading that happens to fit does not make a robot with a slipping drive
//! sure that it has moved.

use crate::actions::Action;
use crate::grid::{Cell, Map, Move};
use crate::inference::learning::{Rates, SlipCounts};
use crate::inference::{Beliefs, Evidence, IdentityNoise, Impossible, ObservationError, Shape, Transition};
use crate::math;

/// The number of moves, waiting included.
pub const MOVES: usize = Move::ALL.len();

/// The successes with which a move begins: how much a single failure says.
const TRUST: f32 = 8.0;

/// The chance of a slip that is always reckoned with, whatever was learned.
const LEAST_SLIP: f32 = 0.05;

/// The chance of a slip where the first reading after a move names the cell that was left: such a
/// reading may as well be from before the move.
const SLIP_OR_OLD: f32 = 0.5;

/// The chance that the robot is anywhere at all, so that no reading is impossible for long.
const DOUBT: f32 = 1e-6;

/// The prior probability of a robot that was switched on for the first time of standing at its
/// start.
const AT_START: f32 = 0.9;

/// The modality of the robot's own position.
const POSITION: usize = 0;

/// Where a robot believes it is, on maps of up to `S` cells.
#[derive(Clone, Debug)]
pub struct Localisation<const S: usize> {
    belief: Beliefs<S, 1>,
    /// The most likely cell, and its probability.
    position: (Cell, f32),
    prior: Beliefs<S, 1>,
    sensor: IdentityNoise,
    slips: SlipCounts<MOVES>,
    /// The move that was begun and not yet predicted.
    begun: Option<Move>,
    /// The move that no reading has confirmed or denied yet, and where it began.
    attempt: Option<(Cell, Move)>,
    surprise: Result<f32, ObservationError>,
    cells: usize,
}

impl<const S: usize> Localisation<S> {
    /// The probability from which a robot takes a cell for its own.
    ///
    /// With a sensor that errs in one reading of ten, a reading that fits a move that has slipped
    /// leaves a doubt of 3e-5 to 1e-4 on maps of 64 to 200 cells: then a second reading is wanted.
    pub const CONFIDENCE: f32 = 0.99998;

    /// Creates the belief of a robot that is most likely at its start; without one it may be
    /// anywhere, and only readings tell. `sensor` is the probability that a reading is right.
    #[must_use]
    pub fn new<const W: usize>(map: &Map<W>, start: Option<Cell>, sensor: f32, rates: Rates) -> Self {
        let mut new = Self::idle();
        new.start(map, start, sensor, rates);
        new
    }

    /// The belief of a robot that is nowhere, until its [`start`](Self::start).
    #[inline(always)] // built where it is to be, not on the stack
    pub(super) const fn idle() -> Self {
        Self {
            belief: Beliefs::EMPTY,
            position: (Cell(0), 0.0),
            prior: Beliefs::EMPTY,
            sensor: const { IdentityNoise::among(1.0, 2) },
            slips: SlipCounts::EMPTY,
            begun: None,
            attempt: None,
            surprise: Ok(0.0),
            cells: 0,
        }
    }

    /// Starts in place; the arguments are those of [`new`](Self::new).
    pub(super) fn start<const W: usize>(
        &mut self,
        map: &Map<W>,
        start: Option<Cell>,
        sensor: f32,
        rates: Rates,
    ) {
        let cells = map.len().clamp(1, S);
        let is_free = |state: usize| state < cells && map.is_free(Cell(state as u16));
        let elsewhere = if start.is_some() { 1.0 - AT_START } else { 1.0 };
        let share = elsewhere / (0..cells).filter(|&state| is_free(state)).count().max(1) as f32;
        for (state, prior) in self.prior.as_flat_mut().iter_mut().enumerate() {
            *prior = if is_free(state) { share } else { 0.0 };
        }
        if let Some(start) = start.and_then(|start| self.prior.as_flat_mut().get_mut(start.index())) {
            *start += AT_START;
        }
        math::assign(self.belief.as_flat_mut(), self.prior.as_flat());
        self.position = likeliest(self.belief.as_flat());
        self.sensor = IdentityNoise::among(sensor, cells);
        self.slips = SlipCounts::new(TRUST, rates);
        self.cells = cells;
    }

    /// Notes that a move begins now.
    pub const fn begin(&mut self, step: Move) {
        self.begun = Some(step);
    }

    /// Updates the belief of a robot that stands, from a reading if there is one.
    pub fn update<const W: usize>(&mut self, map: &Map<W>, reading: Option<Cell>) {
        let begun = self.begun.take();
        let here = self.position().0;
        if let Some(step) = begun {
            self.attempt = Some((here, step));
        }
        // The first reading after a move may be from before it. Whether the move failed, the next
        // ones tell: two of them, as one that errs could name the cell that was expected.
        let left = begun.filter(|&step| step != Move::Wait).map(|_| here);
        let may_be_old = left.is_some() && reading == left;
        let reading = reading.filter(|_| !may_be_old);
        let least = if may_be_old { SLIP_OR_OLD } else { 0.0 };
        let slip = begun.map_or(0.0, |step| self.chance_of_slip(step).max(least));
        self.infer(map, begun.map(|step| (step, slip)), reading);
        self.position = likeliest(self.belief.as_flat());
    }

    /// What [`Beliefs::predict`] and [`Beliefs::observe`] come to for one factor and one modality,
    /// in the same bits: these loops run in every tick.
    fn infer<const W: usize>(&mut self, map: &Map<W>, moved: Option<(Move, f32)>, reading: Option<Cell>) {
        if let Some((step, slip)) = moved {
            self.predict(map, step, slip);
        }
        self.belief.mix(&self.prior, DOUBT);
        if let Some(reading) = reading {
            self.surprise = self.observe(reading);
        }
    }

    /// Predicts where a move has led that fails with the probability `slip`.
    fn predict<const W: usize>(&mut self, map: &Map<W>, step: Move, slip: f32) {
        let Some(place) = Shape::new(self.cells, &[self.cells]) else { return };
        let before = self.belief;
        let from = before.as_flat();
        let from = from.get(..self.cells).unwrap_or(from);
        let to = self.belief.as_flat_mut().get_mut(..self.cells).unwrap_or_default();
        GridMotion(map).predict(&place, step.code(), &[from], to);
        if math::normalise(to).is_none() {
            math::assign(to, from);
        }
        self.belief.mix(&before, slip);
    }

    /// Updates the belief by Bayes' rule; returns the surprise -ln P(o).
    fn observe(&mut self, reading: Cell) -> Result<f32, ObservationError> {
        Evidence::Outcome(reading.index()).check(POSITION, self.cells)?;
        let (correct, off) = (self.sensor.correct(), self.sensor.off());
        let belief = self.belief.as_flat_mut().get_mut(..self.cells).unwrap_or_default();
        let (before, others) = belief.split_at_mut_checked(reading.index()).unwrap_or_default();
        let Some((here, after)) = others.split_first_mut() else { return Ok(0.0) };
        let add = |sum, run: &[f32]| run.iter().fold(sum, |sum, q| sum + q * off);
        let probability = add(add(0.0, before) + *here * correct, after);
        if !(probability > 0.0 && probability.is_finite()) {
            return Err(Impossible { modality: POSITION }.into());
        }
        *here = *here * correct / probability;
        before.iter_mut().chain(after).for_each(|q| *q = *q * off / probability);
        Ok(-math::ln(probability))
    }

    /// Learns from the last move once it is sure where it led. `blocked` are cells into which a
    /// failed move says nothing about the drive.
    pub fn learn<const W: usize>(&mut self, map: &Map<W>, here: Cell, blocked: impl Fn(Cell) -> bool) {
        let Some((from, step)) = self.attempt.take() else { return };
        let to = map.neighbour(from, step);
        if to != from && (here == to || here == from) && !blocked(to) {
            self.slips.learn(step.code(), here == to);
        }
    }

    /// Returns the most likely cell and its probability.
    #[must_use]
    pub const fn position(&self) -> (Cell, f32) {
        self.position
    }

    /// Returns the cell on which the robot stands, if it is sure.
    #[must_use]
    pub fn here(&self) -> Option<Cell> {
        let (cell, probability) = self.position();
        (probability >= Self::CONFIDENCE).then_some(cell)
    }

    /// Returns the probability of a cell; zero for one outside the map.
    #[must_use]
    pub fn probability_of(&self, cell: Cell) -> f32 {
        self.belief.as_flat().get(cell.index()).copied().unwrap_or(0.0)
    }

    /// Returns the surprise of the last reading, -ln P(o).
    ///
    /// # Errors
    /// [`ObservationError`] when the reading was impossible; the belief was left as it was.
    pub const fn surprise(&self) -> Result<f32, ObservationError> {
        self.surprise
    }

    /// Returns how often each move fails, as learned, by the moves' codes.
    #[must_use]
    pub fn slips(&self) -> [f32; MOVES] {
        self.slips.slips()
    }

    /// The chance with which a move is taken to fail.
    pub(super) fn chance_of_slip(&self, step: Move) -> f32 {
        self.slips().get(usize::from(step.code())).copied().unwrap_or(0.0).max(LEAST_SLIP)
    }
}

/// The most likely cell, and its probability.
fn likeliest(belief: &[f32]) -> (Cell, f32) {
    let state = math::argmax(belief);
    (Cell(state as u16), belief.get(state).copied().unwrap_or(0.0))
}

/// The motion of a robot on a map: a move into a wall or out of the map stays.
struct GridMotion<'m, const W: usize>(&'m Map<W>);

impl<const W: usize> GridMotion<'_, W> {
    fn next(&self, action: Action, state: usize) -> usize {
        let here = Cell(state as u16);
        let next = Move::from_code(action).map_or(here, |step| self.0.neighbour(here, step));
        if self.0.is_free(next) { next.index() } else { state }
    }
}

impl<const W: usize> Transition for GridMotion<'_, W> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        let here = states.first().copied().unwrap_or(0);
        f32::from(u8::from(self.next(action, here) == next))
    }

    // One visit of each cell in the place of one for each pair.
    fn predict(&self, _: &Shape, action: Action, beliefs: &[&[f32]], to: &mut [f32]) {
        to.fill(0.0);
        for (state, p) in beliefs.first().copied().unwrap_or(&[]).iter().enumerate() {
            if let Some(next) = to.get_mut(self.next(action, state)) {
                *next += p;
            }
        }
    }

    fn actions(&self) -> Action {
        MOVES as Action
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::{Factor, Modality, Model};

    fn robot(sensor: f32) -> (Map<2>, Localisation<49>) {
        let map = Map::new(7, 7).unwrap();
        (map, Localisation::new(&map, Some(Cell(0)), sensor, Rates::new(1.0, 0.02)))
    }

    #[test]
    fn a_reading_from_before_the_move_does_not_count() {
        let (map, mut robot) = robot(0.9952);
        let mut elsewhere = robot.clone();
        elsewhere.update(&map, Some(Cell(9)));
        assert_eq!(elsewhere.here(), None, "one reading is not enough away from the start");
        elsewhere.update(&map, Some(Cell(9)));
        assert_eq!(elsewhere.here(), Some(Cell(9)));
        robot.update(&map, Some(Cell(0)));
        assert_eq!(robot.here(), Some(Cell(0)));
        robot.begin(Move::Right);
        robot.update(&map, Some(Cell(0)));
        assert!(robot.probability_of(Cell(1)) > 0.4 && robot.here().is_none());
        robot.update(&map, Some(Cell(0)));
        robot.update(&map, Some(Cell(0)));
        assert_eq!(robot.here(), Some(Cell(0)), "it has slipped");
    }

    #[test]
    fn without_a_start_one_reading_is_not_enough_anywhere() {
        let map = Map::<2>::new(7, 7).unwrap();
        for cell in [0, 9] {
            let mut robot = Localisation::<49>::new(&map, None, 0.9952, Rates::new(1.0, 0.02));
            let sum: f32 = (0..49).map(|cell| robot.probability_of(Cell(cell))).sum();
            assert!((sum - 1.0).abs() < 1e-5);
            robot.update(&map, Some(Cell(cell)));
            assert_eq!(robot.here(), None, "on {cell}");
            robot.update(&map, Some(Cell(cell)));
            assert_eq!(robot.here(), Some(Cell(cell)));
        }
    }

    #[test]
    fn a_robot_that_slips_wants_a_second_reading() {
        let (map, mut robot) = robot(0.99);
        let sure = |robot: &mut Localisation<49>| {
            robot.begin(Move::Right);
            (1..9).find(|_| {
                robot.update(&map, Some(Cell(1)));
                robot.here().is_some()
            })
        };
        for _ in 0..4 {
            robot.update(&map, Some(Cell(0)));
        }
        let mut slipping = robot.clone();
        for _ in 0..20 {
            slipping.slips.learn(Move::Right.code(), false);
        }
        assert_eq!(sure(&mut robot), Some(1));
        assert!(sure(&mut slipping) > Some(1));
    }

    #[test]
    fn a_sensor_that_errs_often_wants_a_second_reading_of_every_move() {
        let readings = |sensor: f32| {
            let (map, mut robot) = robot(sensor);
            (0..9).for_each(|_| robot.update(&map, Some(Cell(0))));
            robot.begin(Move::Right);
            (1..9).find(|_| {
                robot.update(&map, Some(Cell(1)));
                robot.here().is_some()
            })
        };
        assert_eq!([0.9952, 0.9].map(readings), [Some(1), Some(2)]);
    }

    #[test]
    fn a_move_counts_once_a_reading_confirms_where_it_led() {
        let (map, mut robot) = robot(0.9952);
        let right = |robot: &Localisation<49>| *robot.slips.counts(Move::Right.code()).unwrap();
        let read = |robot: &mut Localisation<49>, cell, blocked: bool| {
            robot.update(&map, Some(Cell(cell)));
            if let Some(here) = robot.here() {
                robot.learn(&map, here, |_| blocked);
            }
        };
        read(&mut robot, 0, false);
        read(&mut robot, 0, false);
        robot.begin(Move::Right);
        read(&mut robot, 0, false);
        assert_eq!(right(&robot), [TRUST, 0.0], "the first reading may be from before the move");
        read(&mut robot, 0, true);
        read(&mut robot, 0, true);
        assert_eq!(right(&robot), [TRUST, 0.0], "an obstacle says nothing about the drive");
        robot.begin(Move::Right);
        for _ in 0..3 {
            read(&mut robot, 0, false);
        }
        assert_eq!(right(&robot), [TRUST, 1.0]);
        let learned = right(&robot);
        robot.begin(Move::Right);
        for _ in 0..4 {
            read(&mut robot, 40, false);
        }
        assert_eq!((robot.here(), right(&robot)), (Some(Cell(40)), learned), "it was put elsewhere");
    }

    /// Some readings are outside of the map, or impossible for a sensor that never errs.
    #[test]
    fn belief_and_surprise_are_those_of_the_model() {
        let mut map = Map::<2>::new(7, 7).unwrap();
        [8, 9, 30].into_iter().for_each(|cell| _ = map.block(Cell(cell)));
        let (motion, place, mut impossible) = (GridMotion(&map), Shape::new(49, &[49]).unwrap(), 0);
        for correct in [0.9, 0.9952, 1.0] {
            let mut robot = Localisation::<49>::new(&map, Some(Cell(0)), correct, Rates::new(1.0, 0.02));
            let (prior, sensor) = (robot.prior, robot.sensor);
            let factors = [Factor::new(&motion, place, prior.as_flat())];
            let modalities = [Modality::new(&sensor, place, &[POSITION], &[0.0; 49])];
            let model = Model::new(&factors, &modalities);
            let mut random = 1_u32;
            let mut draw = |below: u32| {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (random >> 16) % below
            };
            for _ in 0..500 {
                let moved = Move::from_code(draw(8) as u8).map(|step| (step, draw(9) as f32 / 10.0));
                let reading = Some(Cell(draw(60) as u16)).filter(|cell| cell.0 < 52);
                let (mut belief, mut surprise) = (robot.belief, robot.surprise);
                if let Some((step, slip)) = moved {
                    belief.predict(&model, &[Some(step.code())]).unwrap();
                    belief.mix(&robot.belief, slip);
                }
                belief.mix(&prior, DOUBT);
                if let Some(reading) = reading {
                    surprise = belief.observe(&model, POSITION, Evidence::Outcome(reading.index()));
                }
                robot.infer(&map, moved, reading);
                assert_eq!((robot.belief, robot.surprise), (belief, surprise), "{moved:?} {reading:?}");
                impossible += usize::from(matches!(surprise, Err(ObservationError::Impossible(_))));
            }
        }
        assert!(impossible > 5, "{impossible}");
    }

    #[test]
    fn the_motion_of_the_map_is_that_of_its_table() {
        let mut map = Map::<2>::new(7, 7).unwrap();
        map.block(Cell(8));
        let motion = GridMotion(&map);
        let shape = Shape::new(49, &[49]).unwrap();
        let belief: [f32; 49] = core::array::from_fn(|state| state as f32);
        for action in 0..MOVES as Action {
            let (mut fast, mut slow) = ([0.0; 49], [0.0; 49]);
            motion.predict(&shape, action, &[&belief], &mut fast);
            for (next, to) in slow.iter_mut().enumerate() {
                *to = (0..49).map(|state| belief[state] * motion.probability(action, next, &[state])).sum();
            }
            assert_eq!(fast, slow);
        }
    }
}
