//! Random problems of a team, the same on the host and on the target, and the plans for them.

use iibt_core::grid::joint::{Errand, JointPlan, JointPlanner, PolicyList, Problem, Target};
use iibt_core::grid::{Cell, CellSet, Map};
use iibt_core::inference::{PolicyCost, WeighedPolicies};
use iibt_core::navigation::Mission;

/// The planner of an image: 64 cells, horizon 32, eight robots.
pub type Planner = JointPlanner<2, 33, 8, 64>;

/// The list of joint policies of an image.
pub type List = PolicyList<2, 33, 8, 64, 16>;

/// How many joint policies are listed where nothing is unknown.
pub const LISTED: usize = 4;

/// How many problems of each size are planned.
pub const PROBLEMS: u32 = 200;

/// Of how many problems of each size the [`hardest`] are known.
pub const SEARCHED: usize = 20_000;

/// The draws of the problems whose plans take the most work units or instructions of the first
/// [`SEARCHED`] that have one, for teams of a size.
#[must_use]
pub const fn hardest(robots: usize) -> &'static [u32] {
    match robots {
        2 => &[0, 412, 4619, 19923],
        4 => &[6676, 15828, 16067, 17696],
        8 => &[749, 1247, 13996, 21391],
        _ => &[],
    }
}

/// A generator of numbers (Marsaglia's 32-bit xorshift).
#[derive(Clone, Debug)]
pub struct Problems(u32);

/// A map of 8 x 8 cells of which about a fifth are blocked, with as many goals as robots.
#[derive(Clone, Debug)]
pub struct Instance {
    map: Map<2>,
    starts: [Cell; 8],
    errands: [Errand; 8],
    goals: [Cell; 8],
    owned: [Option<Cell>; 8],
    robots: usize,
}

impl Problems {
    /// The problems of a seed, which is not zero.
    #[must_use]
    pub const fn new(seed: u32) -> Self {
        Self(seed)
    }

    fn below(&mut self, count: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0 % count.max(1)
    }

    /// The next one, for at most eight robots; `None` where the map has too few free cells.
    pub fn next(&mut self, robots: usize) -> Option<Instance> {
        let mut map = Map::new(8, 8).ok()?;
        for cell in (0..64).map(Cell) {
            if self.below(5) == 0 {
                map.block(cell);
            }
        }
        let mut free = map.free_cells();
        let mut goals = [Cell(0); 8];
        let mut errands = [Errand { from: Cell(0), target: Target::Any }; 8];
        for (errand, goal) in errands.iter_mut().zip(&mut goals).take(robots) {
            errand.from = self.draw(&mut free)?;
            *goal = self.draw(&mut free)?;
        }
        let (starts, owned) = (errands.map(|errand| errand.from), goals.map(Some));
        Some(Instance { map, starts, errands, goals, owned, robots })
    }

    fn draw(&mut self, from: &mut CellSet<2>) -> Option<Cell> {
        let index = self.below(from.len() as u32);
        let cell = from.iter().nth(index as usize)?;
        *from = from.without(&[cell].into_iter().collect());
        Some(cell)
    }
}

/// Figures of the plans for [`PROBLEMS`] problems of one size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plans {
    /// A hash of all plans.
    pub digest: u32,
    /// The work units that they took.
    pub units: u32,
    /// The mean of what was measured of each.
    pub mean: u32,
    /// The most of what was measured.
    pub worst: u32,
}

/// Plans for a number of robots. `measure` plans, and returns what that took beside the plan.
pub fn plan_all(
    robots: usize,
    mut measure: impl FnMut(&Instance) -> (Option<(JointPlan<8>, u32)>, u32),
) -> Plans {
    let mut problems = Problems::new(2026);
    let mut plans = Plans::default();
    let (mut solved, mut sum) = (0, 0_u64);
    while solved < PROBLEMS {
        let Some(problem) = problems.next(robots) else { continue };
        let (Some((plan, units)), took) = measure(&problem) else { continue };
        solved += 1;
        sum += u64::from(took);
        plans.worst = plans.worst.max(took);
        plans.units += units;
        plans.digest = plans.digest.rotate_left(1) ^ problem.hash(&plan);
    }
    plans.mean = (sum / u64::from(PROBLEMS)) as u32;
    plans
}

/// The most that is measured of the plans for the hardest problems for a number of robots.
pub fn worst(robots: usize, mut measure: impl FnMut(&Instance) -> (Option<(JointPlan<8>, u32)>, u32)) -> u32 {
    let mut problems = Problems::new(2026);
    let draws = 0..=hardest(robots).last().copied().unwrap_or(0);
    let drawn = draws.filter_map(|draw| Some((draw, problems.next(robots)?)));
    let hard = drawn.filter(|(draw, _)| hardest(robots).contains(draw));
    hard.map(|(_, problem)| measure(&problem).1).max().unwrap_or(0)
}

impl Instance {
    /// The mission of a team that has the problem.
    #[must_use]
    pub fn mission(&self) -> Mission<'_, 2> {
        let (starts, goals) = (self.starts.get(..self.robots), self.goals.get(..self.robots));
        Mission::new(self.map, starts.unwrap_or_default(), goals.unwrap_or_default())
    }

    /// The mission of a team in which each robot owns one of the goals.
    #[must_use]
    pub fn mission_with_owners(&self) -> Mission<'_, 2> {
        Mission { own_goals: self.owned.get(..self.robots).unwrap_or_default(), ..self.mission() }
    }

    /// Plans, all at once; returns the plan and the work units that it took, or `None` where not
    /// all goals can be reached.
    pub fn plan(&self, planner: &mut Planner) -> Option<(JointPlan<8>, u32)> {
        let mut budget = u32::MAX;
        planner.start();
        let plan = planner.work(&self.problem()?, &mut budget)?.ok().filter(|plan| plan.short_by() == 0)?;
        Some((plan, u32::MAX - budget))
    }

    /// Decides, all at once: lists joint policies and weighs them by their steps; returns the one
    /// that is chosen and the work units that it took, or `None` where not all goals can be
    /// reached.
    pub fn decide<const K: usize>(
        &self,
        list: &mut PolicyList<2, 33, 8, 64, K>,
    ) -> Option<(JointPlan<8>, u32)> {
        let mut budget = u32::MAX;
        list.start();
        let is_done = list.work(&self.problem()?, LISTED, &mut budget);
        let costs = list
            .policies()
            .iter()
            .map(|plan| PolicyCost { time: 8 * plan.steps() as u16, ..PolicyCost::FREE });
        let choice = WeighedPolicies::<K>::new(costs, 1.0).ok()?.choose().filter(|_| is_done)?;
        let plan = *list.policies().get(choice.policy)?;
        (plan.short_by() == 0 && list.failure().is_none()).then_some((plan, u32::MAX - budget))
    }

    fn problem(&self) -> Option<Problem<'_, 2>> {
        let Self { map, errands, goals, robots, .. } = self;
        let (errands, goals) = (errands.get(..*robots)?, goals.get(..*robots)?);
        Some(Problem { goals, need: *robots, ..Problem::new(map, errands) })
    }

    /// A hash of the cells of a plan.
    pub(super) fn hash(&self, plan: &JointPlan<8>) -> u32 {
        let cells = plan.paths().iter().flat_map(|path| path.cells(&self.map));
        cells.fold(u32::from(plan.is_together()), |hash, cell| {
            (hash ^ u32::from(cell.0)).wrapping_mul(0x0100_0193)
        })
    }
}
