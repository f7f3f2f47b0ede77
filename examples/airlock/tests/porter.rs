//! The porter of docs/your-robot.md: an operator that makes another one possible, by a remedy.

use firmware::prelude::*;
use host_sim::{Radio, Testbed, settings};
use std::error::Error;

/// Two of the states of a crate.
const HELD: u8 = 1;
const BENCH: u8 = 2;

/// A porter lifts a crate from its shelf, and puts it on the bench.
static PORTER: Tables = Tables::new(&[Role {
    name: "porter",
    sensors: &[Sensor::even("scales", Reads::Factor(0), 0.9)],
    operators: &[
        Operator::IDLE,
        Operator::bringing("lift", HELD, 0.9),
        Operator { requires: &[0], ..Operator::bringing("put", BENCH, 0.9) },
    ],
    facts: &[Fact::sure("held", 0, &[HELD]), Fact::sure("on the bench", 0, &[BENCH])],
    aims: &[Aim::new("deliver", &[1], &[0.0, 1.0, 2.0])],
    remedies: &[Remedy::above_all(0, HELD)], // while it does not hold the crate, prefer to hold it
    ..Role::of(&[HiddenFactor::known("crate", &["shelf", "held", "bench"])])
}]);

static TREE: Tree<TaskLeaf<()>, 2> = tree! { Sequence { Inference(TaskLeaf::Aim(0)) } };

/// The crate as it is, and what was begun.
#[derive(Default)]
struct Crate {
    state: u8,
    begun: Vec<u8>,
}

impl Equipment for Crate {
    fn read(&mut self, _: usize) -> Option<u8> {
        Some(self.state)
    }
    fn is_busy(&mut self) -> bool {
        false
    }
    fn begin(&mut self, command: Command) {
        self.state = command.operator; // each operator brings the state with its number
        self.begun.push(command.operator);
    }
}

#[test]
fn a_remedy_lets_the_porter_lift_what_it_is_to_put_down() -> Result<(), Box<dyn Error>> {
    type Porter = table_robot!(PORTER, Crate, (), 2);
    let settings = settings(RobotId(0), 1)?;
    let porter = Porter::new(&PORTER, &settings, &TREE, (), Duration(100))?;
    let mut testbed = Testbed::new([(porter, Crate::default())], Radio::default(), 7)?;
    let ticks = (0..50).find(|_| testbed.tick() == [Status::Success]);
    assert!(ticks.is_some_and(|ticks| ticks < 20), "{ticks:?}");
    assert_eq!(testbed.parts(0).begun, [1, 2], "it lifts the crate, and then puts it down");

    // What the page says about looking into a robot.
    let task = testbed.robots().next().ok_or("there is one robot")?.task();
    assert_eq!(task.sure(0), Some(usize::from(BENCH)));
    assert!(task.logic(None).is(1) && !task.logic(None).is(0));
    Ok(())
}
