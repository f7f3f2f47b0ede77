//! Algorithm 1 of the paper, line by line, on a task that only notes what it is asked.

use iibt_core::iibt::{Literal, Node, Task};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;

/// The policies the scripted task knows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Policy {
    Go,
    Stop,
}

const CLEAR: Literal = Literal { variable: 0, value: false };

/// A task that plays a script and keeps a log of the node's calls.
struct Script {
    calls: Vec<&'static str>,
    /// What each inference chooses; the last repeats.
    choices: Vec<Option<Policy>>,
    inferences: usize,
    /// How many raises it takes until the precondition holds.
    raises_needed: usize,
    raises: usize,
    connected: bool,
    last_step: bool,
    /// C with its temporary part, to see that a roll-back is exact.
    preference: f32,
    at_choice: Vec<f32>,
}

impl Script {
    fn new() -> Self {
        Self {
            calls: vec![],
            choices: vec![Some(Policy::Go)],
            inferences: 0,
            raises_needed: 0,
            raises: 0,
            connected: true,
            last_step: false,
            preference: 1.0,
            at_choice: vec![],
        }
    }

    fn choosing(choices: &[Option<Policy>]) -> Self {
        Self { choices: choices.to_vec(), ..Self::new() }
    }

    fn needing(raises: usize) -> Self {
        Self { raises_needed: raises, ..Self::new() }
    }

    fn tick(&mut self, node: &mut Node, now: u32) -> Status {
        self.calls.clear();
        node.tick(self, Instant(now))
    }

    fn position(&self, call: &str) -> usize {
        self.calls
            .iter()
            .position(|&made| made == call)
            .unwrap_or_else(|| panic!("{call} in {:?}", self.calls))
    }

    fn count(&self, call: &str) -> usize {
        self.calls.iter().filter(|&&made| made == call).count()
    }
}

impl Task for Script {
    type Policy = Policy;

    fn prepare(&mut self) {
        self.calls.push("prepare");
        self.preference = 1.0;
    }
    fn observe(&mut self) {
        self.calls.push("observe");
    }
    fn update(&mut self) {
        self.calls.push("update");
    }
    fn candidates(&mut self) {
        self.calls.push("candidates");
    }
    fn intentions(&mut self) {
        self.calls.push("intentions");
    }
    fn infer(&mut self) -> Option<Policy> {
        self.calls.push("infer");
        self.at_choice.push(self.preference);
        let choice = self.choices[self.inferences.min(self.choices.len() - 1)];
        self.inferences += 1;
        choice
    }
    fn is_stop(&self, policy: Policy) -> bool {
        policy == Policy::Stop
    }
    fn unmet(&self, _: Policy) -> Option<Literal> {
        (self.raises < self.raises_needed).then_some(CLEAR)
    }
    fn raise(&mut self, missing: Literal) {
        assert_eq!(missing, CLEAR);
        self.calls.push("raise");
        self.raises += 1;
        self.preference += 2.5;
    }
    fn connected(&self) -> bool {
        self.connected
    }
    fn execute(&mut self, _: Policy) {
        self.calls.push("execute");
    }
    fn roll_back(&mut self) {
        self.calls.push("roll back");
        self.preference = 1.0;
    }
    fn wait(&mut self) {
        self.calls.push("wait");
    }
    fn reaches_stop(&self, _: Policy) -> bool {
        self.last_step
    }
    fn promote_stop(&mut self) {
        self.calls.push("promote stop");
        self.choices = vec![Some(Policy::Stop)];
        self.inferences = 0;
    }
}

fn node() -> Node {
    Node::new(Duration(10))
}

#[test]
fn line_2_the_task_is_running_from_the_first_tick() {
    assert_eq!(Script::new().tick(&mut node(), 0), Status::Running);
}

#[test]
fn lines_3_and_4_the_model_and_preferences_are_the_tasks_own_at_every_tick() {
    let (mut task, mut node) = (Script::new(), node());
    for now in 0..3 {
        task.tick(&mut node, now);
        assert_eq!(task.position("prepare"), 0);
    }
}

#[test]
fn line_5_observes_before_it_believes() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!(task.position("observe"), task.position("prepare") + 1);
}

#[test]
fn line_6_updates_belief_and_logic_from_the_observation() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!(task.position("update"), task.position("observe") + 1);
}

#[test]
fn line_7_builds_its_own_candidates_from_the_belief() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!(task.position("candidates"), task.position("update") + 1);
}

#[test]
fn lines_8_to_11_join_the_teammates_intentions() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!(task.position("intentions"), task.position("candidates") + 1);
}

#[test]
fn line_12_infers_once_everything_is_known() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!(task.position("infer"), task.position("intentions") + 1);
    assert_eq!(task.count("infer"), 1);
}

#[test]
fn lines_13_to_15_choosing_to_stop_is_success_and_executes_nothing() {
    let mut task = Script::choosing(&[Some(Policy::Stop)]);
    assert_eq!(task.tick(&mut node(), 0), Status::Success);
    assert_eq!(task.calls.last(), Some(&"infer"));
}

#[test]
fn line_17_a_precondition_that_holds_is_not_touched() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!(task.count("raise"), 0);
}

#[test]
fn lines_18_and_19_raise_the_preference_for_the_missing_evidence_before_the_next_inference() {
    let mut task = Script::needing(2);
    task.tick(&mut node(), 0);
    assert_eq!(task.count("raise"), 2);
    assert_eq!(task.at_choice, [1.0, 3.5, 6.0]);
}

#[test]
fn line_20_rebuilds_the_candidates_after_every_raise() {
    let mut task = Script::needing(3);
    task.tick(&mut node(), 0);
    assert_eq!(task.count("candidates"), 1 + 3);
    let after_raise = |pair: &[&str]| pair[0] != "raise" || pair[1] == "candidates";
    assert!(task.calls.windows(2).all(after_raise), "{:?}", task.calls);
}

#[test]
fn lines_21_to_24_read_the_intentions_again() {
    let mut task = Script::needing(3);
    task.tick(&mut node(), 0);
    assert_eq!(task.count("intentions"), 1 + 3);
}

#[test]
fn line_25_infers_again_until_the_precondition_holds() {
    let mut task = Script::needing(3);
    task.tick(&mut node(), 0);
    assert_eq!(task.count("infer"), 1 + 3);
    assert_eq!(task.count("execute"), 1);
}

#[test]
fn lines_26_to_28_fail_at_the_timeout_and_not_before() {
    let (mut task, mut node) = (Script::needing(usize::MAX), node());
    for now in 100..110 {
        assert_eq!(task.tick(&mut node, now), Status::Running, "tick {now}");
        assert_eq!(task.count("execute"), 0);
        assert_eq!(task.calls.last(), Some(&"wait"));
    }
    assert_eq!(task.tick(&mut node, 110), Status::Failure);
    assert_eq!(task.count("execute"), 0);
}

#[test]
fn lines_26_to_28_the_timeout_starts_anew_after_it_has_struck_or_the_precondition_held() {
    let (mut task, mut node) = (Script::needing(usize::MAX), node());
    task.tick(&mut node, 0);
    assert_eq!(task.tick(&mut node, 10), Status::Failure);
    assert_eq!(task.tick(&mut node, 11), Status::Running);
    task.raises_needed = 0;
    task.tick(&mut node, 20);
    task.raises_needed = usize::MAX;
    assert_eq!(task.tick(&mut node, 25), Status::Running);
}

#[test]
fn lines_26_to_28_the_timeout_survives_a_wrap_of_the_clock() {
    let (mut task, mut node) = (Script::needing(usize::MAX), node());
    assert_eq!(task.tick(&mut node, u32::MAX - 4), Status::Running);
    assert_eq!(task.tick(&mut node, 4), Status::Running);
    assert_eq!(task.tick(&mut node, 5), Status::Failure);
}

#[test]
fn lines_17_to_30_do_bounded_work_in_a_tick_and_go_on_in_the_next() {
    let (mut task, mut node) = (Script::needing(Node::PASSES + 2), node());
    assert_eq!(task.tick(&mut node, 0), Status::Running);
    assert_eq!(task.count("raise"), Node::PASSES);
    assert_eq!(task.count("execute"), 0);
    assert_eq!(task.tick(&mut node, 1), Status::Running);
    assert_eq!(task.count("prepare"), 0, "what was raised is kept");
    assert_eq!(task.count("raise"), 2);
    assert_eq!(task.count("execute"), 1);
}

#[test]
fn lines_17_to_30_nothing_to_choose_from_is_unmet_too() {
    let (mut task, mut node) = (Script::choosing(&[None]), node());
    assert_eq!(task.tick(&mut node, 0), Status::Running);
    assert_eq!(task.calls.last(), Some(&"wait"));
    assert_eq!(task.tick(&mut node, 10), Status::Failure);
}

#[test]
fn lines_31_and_32_execute_when_the_whole_team_is_connected() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!((task.count("execute"), task.count("wait")), (1, 0));
}

#[test]
fn line_33_rolls_the_preference_back_exactly_after_executing() {
    let mut task = Script::needing(2);
    task.tick(&mut node(), 0);
    assert_eq!(task.position("roll back"), task.position("execute") + 1);
    assert_eq!(task.preference.to_bits(), 1.0_f32.to_bits());
}

#[test]
fn lines_34_to_36_wait_while_a_teammate_is_missing() {
    let mut task = Script { connected: false, last_step: true, ..Script::new() };
    assert_eq!(task.tick(&mut node(), 0), Status::Running);
    assert_eq!((task.count("execute"), task.count("wait")), (0, 1));
    assert_eq!(task.count("promote stop"), 0);
}

#[test]
fn lines_37_and_38_the_last_step_promotes_stopping_and_the_next_tick_succeeds() {
    let (mut task, mut node) = (Script { last_step: true, ..Script::new() }, node());
    assert_eq!(task.tick(&mut node, 0), Status::Running);
    assert_eq!(task.calls.last(), Some(&"promote stop"));
    assert_eq!(task.tick(&mut node, 1), Status::Success);
}

#[test]
fn lines_37_and_38_any_other_step_promotes_nothing() {
    let mut task = Script::new();
    task.tick(&mut node(), 0);
    assert_eq!(task.count("promote stop"), 0);
}

#[test]
fn lines_40_and_41_the_node_stays_running_while_the_policy_is_under_way() {
    let (mut task, mut node) = (Script::new(), node());
    assert!((0..20).all(|now| task.tick(&mut node, now) == Status::Running));
}

#[test]
fn a_halted_node_waits_and_takes_back_what_it_raised() {
    let (mut task, mut node) = (Script::needing(usize::MAX), node());
    task.tick(&mut node, 0);
    node.halt(&mut task);
    assert_eq!(task.preference, 1.0);
    task.tick(&mut node, 9);
    assert_eq!(task.position("prepare"), 0);
    assert_eq!(task.tick(&mut node, 18), Status::Running, "the timeout starts anew");
}
