//! The work of a tick of robots with table tasks: bounded by a budget that changes nothing but
//! when.

use firmware::prelude::*;
use host_sim::{Radio, Testbed, settings};

/// The stages of a robot's work: one operator leads to each, from the one before.
const STAGES: usize = 8;

const NAMES: [&str; STAGES] = ["0", "1", "2", "3", "4", "5", "6", "7"];

const AT: [Fact; STAGES] = {
    let mut facts = [Fact::sure("at", 0, &[0]); STAGES];
    let mut stage = 0;
    while stage < STAGES {
        facts[stage] = Fact::sure(NAMES[stage], 0, FEWEST[stage]);
        stage += 1;
    }
    facts
};

const FEWEST: [&[u8]; STAGES] = [&[0], &[1], &[2], &[3], &[4], &[5], &[6], &[7]];

const STEPS: [Operator; STAGES] = {
    let mut steps = [Operator::IDLE; STAGES];
    let mut stage = 1;
    while stage < STAGES {
        let name = NAMES[stage];
        let step = Operator { name, ..Operator::bringing("", stage as u8, 0.9) };
        steps[stage] = Operator { requires: FEWEST[stage - 1], forbids: FEWEST[stage], ..step };
        stage += 1;
    }
    steps
};

/// From the last stage to the first, each one is wanted for the next.
const WANTED: [Remedy; STAGES - 1] = {
    let mut remedies = [Remedy::above_all(0, 0); STAGES - 1];
    let mut stage = 0;
    while stage < STAGES - 1 {
        remedies[stage] = Remedy::above_all(stage as u8, stage as u8);
        stage += 1;
    }
    remedies
};

const FACTORS: &[HiddenFactor] = &[HiddenFactor::known("stage", &NAMES)];

const SENSORS: &[Sensor] = &[Sensor::even("stage", Reads::Factor(0), 0.9999)];

const AIMS: &[Aim] = &[Aim::new("finish", &[7], &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])];

const fn worker(name: &'static str) -> Role<'static> {
    Role {
        name,
        sensors: SENSORS,
        operators: &STEPS,
        facts: &AT,
        remedies: &WANTED,
        aims: AIMS,
        ..Role::of(FACTORS)
    }
}

/// Three robots with eight operators each: 512 joint policies, and six raises for the first step.
static WORKERS: Tables = Tables::new(&[worker("one"), worker("two"), worker("three")]);

static TREE: Tree<TaskLeaf<()>, 1> = tree! { Inference(TaskLeaf::Aim(0)) };

/// A bench on which every operator takes three ticks and succeeds.
#[derive(Debug, Default)]
struct Work {
    stage: u8,
    left: u8,
    begun: Vec<u8>,
}

impl Equipment for Work {
    fn read(&mut self, _: usize) -> Option<u8> {
        Some(self.stage)
    }
    fn is_busy(&mut self) -> bool {
        self.left > 0
    }
    fn begin(&mut self, command: Command) {
        self.begun.push(command.operator);
        self.left = 3;
    }
}

type Worker = TableRobot<'static, Work, (), Memory<1>, 8, 3, 512>;

/// What a flight came to: the ticks, the operators of each robot, the most units of a tick.
fn fly(budget: u32, loss: f64, seed: u64) -> (u32, Vec<Vec<u8>>, u32) {
    let robot = |robot| {
        let settings = settings(RobotId(robot), 3).expect("a team");
        let worker = Worker::new(&WORKERS, &settings, &TREE, (), Duration(1_000_000)).expect("it fits");
        (worker.with_budget(budget), Work::default())
    };
    let radio = Radio { loss, ..Radio::default() };
    let mut testbed = Testbed::new((0..3).map(robot), radio, seed).expect("a team");
    let mut most = 0;
    for tick in 1..200_000 {
        for robot in 0..3 {
            let work = testbed.parts_mut(robot);
            if work.left == 1 {
                work.stage = work.begun.last().copied().unwrap_or(0);
            }
            work.left = work.left.saturating_sub(1);
        }
        let statuses = testbed.tick();
        most = testbed.robots().map(|robot| robot.task().work()).fold(most, u32::max);
        if statuses == [Status::Success; 3] {
            let begun = (0..3).map(|robot| testbed.parts(robot).begun.clone()).collect();
            return (tick, begun, most);
        }
    }
    panic!("budget {budget}: not done");
}

#[test]
fn no_tick_does_more_than_its_budget_and_what_is_decided_does_not_depend_on_it() {
    let (ticks, begun, most) = fly(u32::MAX, 0.0, 1);
    assert_eq!(begun, vec![(1..STAGES as u8).collect::<Vec<_>>(); 3]);
    // Seven inferences over 512 joint policies, the list, and its eight scores: all in one tick.
    assert_eq!(most, 7 * 512 + 512 + 8);
    let mut before = ticks;
    for budget in [1000, 100, 7, 1] {
        let (ticks, same, most) = fly(budget, 0.0, 1);
        assert!(most <= budget, "{most} units in a tick for {budget}");
        assert_eq!(same, begun, "budget {budget}");
        assert!(ticks > before, "budget {budget}: {ticks} ticks");
        before = ticks;
    }
}

#[test]
fn a_small_budget_and_a_radio_that_loses_frames_are_slow_and_nothing_else() {
    let begun = fly(u32::MAX, 0.3, 1).1;
    for seed in 0..3 {
        let (_, same, most) = fly(50, 0.3, seed);
        assert!(most <= 50 && same == begun, "seed {seed}: {same:?}");
    }
}
