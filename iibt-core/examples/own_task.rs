//! A task of one's own: a robot has to open one of two boxes. It listens until it is worth opening
//! one, because a wrong box costs more than a few ticks.
//!
//! The model and the choice are the inference engine's; the task says what is sensed, what may be
//! chosen, and what a choice does. `cargo run -p iibt-core --example own_task`
#![cfg_attr(target_os = "none", no_std, no_main)]

#[macro_use]
mod chip;

use iibt_core::iibt::{InferenceNode, Literal, Task};
use iibt_core::inference::{
    Candidates, Control, Evidence, Factor, Modality, Model, NextState, OutcomeTable, Policy, Shape, Terms,
};
use iibt_core::team::{Limits, Member, Message, Peers, RobotId, Roster};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;
use iibt_core::{Agent, agent};
use serde::{Deserialize, Serialize};

const LISTEN: usize = 0;
const FOUND: usize = 1;

// Two hidden factors: which box has the part, and what the hand does.
static STAYS: NextState = NextState::new(&[0, 1], 2);
static HAND: NextState = NextState::new(&[0, 0, 0, 1, 1, 1, 2, 2, 2], 3);
static FACTORS: [Factor; 2] = [
    Factor::new(&STAYS, Shape::new(2, &[2]).unwrap(), &[0.5, 0.5]).controlled_by(Control::None),
    Factor::new(&HAND, HAND.shape(), &[1.0, 0.0, 0.0]),
];

// A knock is heard from the right side 85 times in a hundred, while the robot listens.
static SOUND: OutcomeTable =
    OutcomeTable::new(&[&[0, 1], &[0, 1, 1]], &[0, 2, 1, 2], &[0.85, 0.15, 0.15, 0.85, 0.5, 0.5], 2);
// Opening a box shows at once whether it was the right one.
static RESULT: OutcomeTable = OutcomeTable::new(
    &[&[0, 1], &[0, 1, 2]],
    &[0, 1, 2, 0, 2, 1],
    &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    3,
);
static MODALITIES: [Modality; 2] = [
    Modality::new(&SOUND, SOUND.shape(), &[0, 1], &[0.0, 0.0]),
    Modality::new(&RESULT, RESULT.shape(), &[0, 1], &[0.0, 3.0, -30.0]),
];
static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
static ACTIONS: [Policy; 3] = [Policy::of(&[0]), Policy::of(&[1]), Policy::of(&[2])];

/// The readings of a tick.
#[derive(Clone, Copy)]
struct Percept {
    knock: usize,
    result: usize,
}

/// The robot has no teammates.
#[derive(Clone, Serialize, Deserialize)]
struct Silence;

impl Message for Silence {
    const SCHEMA: &'static str = "nothing";
    const MAX_BYTES: usize = 0;
}

struct Boxes {
    agent: Agent!(MODEL, 3),
    found: bool,
    /// The command to the hand.
    command: Option<usize>,
    /// The terms of each action in the last decision.
    why: [Terms; 3],
}

impl Task for Boxes {
    type Percept = Percept;
    type Message = Silence;
    type Preference = ();
    type Candidates = ();
    type Policy = usize;

    fn observe(&mut self, percept: &Percept, _: Peers<'_, Silence>) {
        let evidence = [Evidence::Outcome(percept.knock), Evidence::Outcome(percept.result)];
        // Both outcomes exist, and none is impossible in every state that the robot believes in.
        self.found = self.agent.observe(&evidence).is_ok() && percept.result == FOUND;
    }

    fn is_done(&self) -> bool {
        self.found
    }

    fn preference(&self) {}

    fn candidates(&mut self, (): &(), _: Peers<'_, Silence>) {}

    fn infer(&mut self, (): &(), (): &(), _: Peers<'_, Silence>) -> Option<usize> {
        let choice = self.agent.decide(Candidates::all(&[&[], &ACTIONS])).ok()?.policy();
        self.why.iter_mut().zip(self.agent.terms()).for_each(|(why, terms)| *why = *terms);
        Some(choice)
    }

    fn unmet(&self, _: usize, (): &()) -> Option<Literal> {
        None
    }

    fn raise(&mut self, _: Literal, (): &(), (): &mut ()) {}

    fn execute(&mut self, action: usize, (): &(), _: Peers<'_, Silence>) {
        self.command = Some(action);
    }

    fn wait(&mut self) {
        self.command = None;
    }
}

fn play() {
    let alone = Roster::new(Member::new(RobotId(0), 1).unwrap(), Limits::for_beacons(Duration(1)).unwrap());
    let mut task = Boxes { agent: agent!(MODEL, 3), found: false, command: None, why: [Terms::ZERO; 3] };
    let mut node = InferenceNode::new(Duration(50));
    // The part is in the right box, 1. The first knock misleads.
    let knocks = [0, 1, 1, 1, 1, 1, 1];
    let (mut done, mut ticks, mut result) = ([LISTEN; 8], 0, 0);
    for (tick, knock) in (0..).zip(knocks) {
        let status = node.tick(&mut task, &Percept { knock, result }, alone.at(Instant(tick)), Instant(tick));
        if status == Status::Success {
            break;
        }
        let action = task.command.expect("it always has something to do");
        let [listen, open] = [LISTEN, 2].map(|action| task.why[action]);
        show!(
            "tick {tick}: knock from {knock}, right box {:.3}; does {action}: epistemic value of listening {:.3}, pragmatic \
             value of opening {:.3}",
            task.agent.belief(0).unwrap()[1],
            listen.information_gain,
            open.utility,
        );
        let action_of_hand = u8::try_from(action).unwrap();
        task.agent.act(&[None, Some(action_of_hand)]).unwrap();
        result = if action == LISTEN { 0 } else { 2 - usize::from(action == 2) };
        done[ticks] = action;
        ticks += 1;
    }
    assert!(task.found, "it has found the part");
    let (last, before) = done[..ticks].split_last().expect("it acted");
    assert_eq!(*last, 2, "it opened the right box");
    assert!(
        before.len() >= 3 && before.iter().all(|&action| action == LISTEN),
        "it listened first: {done:?}"
    );
}

play!(play);
