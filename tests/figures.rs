//! Flights on narrow maps, held against what the planner finds for their missions.

use host_sim::missions::{Ground, RandomMissions};
use host_sim::{Conditions, Outcome, Scenario, fly};
use iibt_core::grid::joint::{Errand, JointPlan, PolicyList, Problem, Target};
use iibt_core::grid::{Cell, Map};
use std::path::Path;

/// The missions on each map with each team. `tests/nightly` sets another number in `IIBT_FIGURES`.
const MISSIONS: u64 = 25;

const MAPS: [&str; 6] = ["tunnel", "tree", "string", "loop-chain", "corners", "connector"];

fn missions() -> u64 {
    match std::env::var("IIBT_FIGURES") {
        Ok(missions) => missions.parse().expect("IIBT_FIGURES is a number of missions"),
        Err(_) => MISSIONS,
    }
}

/// The missions of a narrow map with this many robots.
fn on(name: &str, robots: usize) -> RandomMissions {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("figures/maps/{name}.toml"));
    let text = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let scenario = Scenario::read(name, &text).expect("a sound scenario");
    let ground = Ground::Given(Box::new(scenario.map));
    RandomMissions {
        ground,
        robots: robots..=robots,
        goals: None,
        is_owned: false,
        is_solvable: false,
        limit: 200,
    }
}

/// The best joint plan of a mission, with the sizes of the simulator.
fn best(scenario: &Scenario) -> (Map<2>, JointPlan<8>) {
    let map = Map::<2>::new(scenario.map.width(), scenario.map.height()).expect("at most 64 cells");
    let walls = (0..map.len() as u16).map(Cell).filter(|&cell| !scenario.map.is_free(cell));
    let map = map.avoiding(walls.collect::<Vec<_>>());
    let errand = |robot: &host_sim::RobotSpec| Errand { from: robot.start, target: Target::Any };
    let errands: Vec<Errand> = scenario.robots.iter().map(errand).collect();
    let (goals, need) = (&scenario.goals, scenario.need);
    let problem = Problem { goals, need, ..Problem::new(&map, &errands) };
    let mut list = Box::new(PolicyList::<2, 65, 8, 4096, 16>::new());
    list.start();
    while !list.work(&problem, 1, &mut u32::MAX.clone()) {}
    (map, list.policies()[0])
}

/// How the missions of one map with one team went.
#[derive(Default)]
struct Narrow {
    arrived: u64,
    together: u64,
    /// The planner has a plan that brings all there together.
    possible: u64,
    /// Of these, the missions in which they came apart.
    apart: Vec<u64>,
}

impl Narrow {
    fn fly(name: &str, robots: usize) -> Self {
        let mut count = Self::default();
        for seed in 0..missions() {
            let text = on(name, robots).draw(seed).expect("there is room");
            let scenario = Scenario::parse(name, &text).expect("what is drawn is sound");
            let (map, plan) = best(&scenario);
            let execution = plan.execute(&map).expect("no standstill");
            let can = plan.is_together() && u32::from(execution.spread) <= host_sim::TOGETHER;
            let record =
                fly(&scenario, Conditions { seed, ..Conditions::default() }, &mut ()).expect("it fits");
            let comes = record.outcome == Outcome::Together;
            count.arrived += u64::from(record.outcome.is_success());
            count.together += u64::from(comes);
            count.possible += u64::from(can);
            count.apart.extend((can && !comes).then_some(seed));
        }
        count
    }
}

#[test]
fn on_narrow_maps_all_robots_arrive_and_together_where_the_planner_has_such_a_plan() {
    let (mut planned, mut missed) = (0, 0);
    for name in MAPS {
        for robots in [4, 8] {
            let (Narrow { arrived, together, possible, apart }, all) =
                (Narrow::fly(name, robots), missions());
            println!(
                "{name}, {robots} robots: {arrived} of {all} arrive, {together} together; planned so: {possible}, but apart: {apart:?}"
            );
            assert_eq!(arrived, all, "{name}, {robots} robots");
            (planned, missed) = (planned + possible, missed + apart.len() as u64);
        }
    }
    assert!(planned > 0 && missed == 0, "{missed} of {planned} missions come apart");
}
