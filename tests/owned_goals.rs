//! Teams that have to be sorted: robots that own their goals on narrow ground, where a search over
//! all joint states knows which of them can.

use host_sim::Random;
use iibt_core::grid::joint::{Errand, Failure, JointPlan, JointPlanner, Problem, Target};
use iibt_core::grid::{Cell, Map};
use std::collections::HashSet;

const SIDE: u16 = 7;

/// The teams on ground of each kind.
const TEAMS: usize = 60;

/// The kinds of narrow ground.
#[derive(Clone, Copy, Debug)]
enum Ground {
    /// Winds, with one or two niches.
    Corridor,
    Tree,
    /// A ring with branches.
    Loop,
    /// Winds around four corners, with a niche at the second one.
    Corners,
}

impl Ground {
    /// Ground of up to 16 cells.
    fn draw(self, random: &mut Random) -> Map<2> {
        let mut map = walls();
        match self {
            Self::Corridor => {
                wind(&mut map, random);
                branch(&mut map, random, 2);
            }
            Self::Tree => {
                map.clear(Cell(random.below(map.len()) as u16));
                branch(&mut map, random, 14);
            }
            Self::Loop => {
                let (right, below) = (3 + random.below(2) as u16, 3 + random.below(2) as u16);
                let ring = |x: u16, y: u16| x == 1 || y == 1 || x == right || y == below;
                let cells = (1..=below).flat_map(|y| (1..=right).map(move |x| (x, y)));
                cells.filter(|&(x, y)| ring(x, y)).for_each(|(x, y)| _ = map.clear(Cell(y * SIDE + x)));
                branch(&mut map, random, 4);
            }
            Self::Corners => return Map::drawn("....#\n###..\n#...#\n#.###\n#....").expect("a map"),
        }
        map
    }
}

fn walls() -> Map<2> {
    let map = Map::new(SIDE, SIDE).expect("49 cells");
    map.avoiding((0..SIDE * SIDE).map(Cell))
}

/// Whether a cell is a wall that touches one free cell only.
fn may_grow(map: &Map<2>, cell: Cell) -> bool {
    !map.is_free(cell) && map.free_neighbours(cell).count() <= 1
}

/// Frees a winding line of up to 13 cells.
fn wind(map: &mut Map<2>, random: &mut Random) {
    let mut at = Cell(random.below(map.len()) as u16);
    map.clear(at);
    for _ in 0..12 {
        let (x, y) = (at.0 % SIDE, at.0 / SIDE);
        let around = [(x + 1, y), (x.wrapping_sub(1), y), (x, y + 1), (x, y.wrapping_sub(1))];
        let inside = around.into_iter().filter(|&(x, y)| x < SIDE && y < SIDE);
        let open: Vec<Cell> =
            inside.map(|(x, y)| Cell(y * SIDE + x)).filter(|&cell| may_grow(map, cell)).collect();
        let Some(&next) = open.get(random.below(open.len().max(1))) else { return };
        map.clear(next);
        at = next;
    }
}

/// Frees up to so many cells that touch one free cell each.
fn branch(map: &mut Map<2>, random: &mut Random, cells: usize) {
    for _ in 0..1 + random.below(cells) {
        let walls = (0..SIDE * SIDE).map(Cell);
        let open: Vec<Cell> =
            walls.filter(|&cell| may_grow(map, cell) && map.free_neighbours(cell).next().is_some()).collect();
        if let Some(&cell) = open.get(random.below(open.len().max(1))) {
            map.clear(cell);
        }
    }
}

/// A team whose robots own their goals.
struct Team {
    map: Map<2>,
    starts: Vec<Cell>,
    goals: Vec<Cell>,
}

impl Team {
    fn draw(ground: Ground, random: &mut Random) -> Self {
        loop {
            let map = ground.draw(random);
            let (robots, free) = (2 + random.below(3), map.free_cells());
            if (robots + 1..=16).contains(&free.len()) {
                let mut cells = || {
                    let mut left: Vec<Cell> = free.iter().collect();
                    (0..robots).map(|_| left.swap_remove(random.below(left.len()))).collect()
                };
                return Self { map, starts: cells(), goals: cells() };
            }
        }
    }

    /// Whether moves of one robot at a time, into free cells, bring all to their goals.
    fn can_be_sorted(&self) -> bool {
        let (mut seen, mut open) = (HashSet::from([self.starts.clone()]), vec![self.starts.clone()]);
        while let Some(robots) = open.pop() {
            if robots == self.goals {
                return true;
            }
            for (robot, &at) in robots.iter().enumerate() {
                let free = self.map.free_neighbours(at).map(|(_, to)| to).filter(|to| !robots.contains(to));
                for to in free {
                    let mut next = robots.clone();
                    next[robot] = to;
                    if seen.insert(next.clone()) {
                        open.push(next);
                    }
                }
            }
        }
        false
    }

    fn plan<const L: usize, const M: usize>(
        &self,
        planner: &mut JointPlanner<2, L, 8, M>,
    ) -> Result<JointPlan<8>, Failure> {
        let errand = |(&from, &to): (&Cell, &Cell)| Errand { from, target: Target::Own(to) };
        let errands: Vec<Errand> = self.starts.iter().zip(&self.goals).map(errand).collect();
        planner.start();
        planner.work(&Problem::new(&self.map, &errands), &mut u32::MAX.clone()).expect("within the budget")
    }

    /// Panics unless a plan takes every robot from its start to its goal and no two get in each
    /// other's way.
    fn check(&self, plan: &JointPlan<8>) {
        let paths = plan.paths();
        assert!(paths.iter().map(|path| path.start).eq(self.starts.iter().copied()), "{plan:?}");
        assert!(paths.iter().map(|path| path.end(&self.map)).eq(self.goals.iter().copied()), "{plan:?}");
        assert!(paths.iter().all(|path| path.is_open(&self.map)), "{plan:?}");
        assert_eq!(plan.conflict(&self.map), None, "{plan:?}");
        assert!(plan.execute(&self.map).is_some(), "a standstill: {plan:?}");
    }
}

/// With the sizes of the simulator all teams are sorted that can be, and of the others that is
/// proved; with those of images most are.
#[test]
fn teams_that_can_be_sorted_are() {
    let mut host = Box::new(JointPlanner::<2, 65, 8, 4096>::new());
    let mut image = Box::new(JointPlanner::<2, 33, 8, 64>::new());
    let mut of_all = 0;
    for ground in [Ground::Corridor, Ground::Tree, Ground::Loop, Ground::Corners] {
        let (mut random, mut sorted, mut by_image, mut impossible) = (Random::new(16), 0, 0, 0);
        while sorted < TEAMS {
            let team = Team::draw(ground, &mut random);
            let answers = [team.plan(&mut host), team.plan(&mut image)];
            answers.iter().flatten().for_each(|plan| team.check(plan));
            if team.can_be_sorted() {
                assert!(answers[0].is_ok(), "{ground:?}: {answers:?} {:?} to {:?}", team.starts, team.goals);
                sorted += 1;
                by_image += usize::from(answers[1].is_ok());
            } else {
                assert_eq!(answers[0], Err(Failure::Impossible), "{ground:?}: {:?}", team.starts);
                assert!(matches!(answers[1], Err(Failure::Impossible | Failure::NotFound)), "{answers:?}");
                impossible += 1;
            }
        }
        println!(
            "{ground:?}: {sorted} sorted, {by_image} with the sizes of images; {impossible} cannot be sorted"
        );
        of_all += by_image;
    }
    assert!(of_all * 100 >= 4 * TEAMS * 84, "{of_all} of {} with the sizes of images", 4 * TEAMS);
}
