//! Trees whose leaves are bound to a program's own.

use super::*;
use host_sim::tree::{BoundTree, LeafNode};
use iibt_core::time::Instant;
use iibt_core::tree::{Halt, Leaves, NodeMemory, Status, StatusChange};

const TREE: &str = r#"<root BTCPP_format="4"><BehaviorTree ID="Main"><ReactiveFallback>
  <Sequence><IsLow/><GoTo place="dock"/></Sequence><GoTo place="field"/>
</ReactiveFallback></BehaviorTree>
<TreeNodesModel><Condition ID="IsLow"/>
  <Action ID="GoTo"><input_port name="place" type="std::string"/></Action></TreeNodesModel></root>"#;

#[derive(Clone, Debug, PartialEq)]
enum Skill {
    IsLow,
    GoTo(String),
}

fn find(leaf: &LeafNode) -> Result<Skill, String> {
    match (leaf.kind.as_str(), leaf.port("place")) {
        ("IsLow", None) => Ok(Skill::IsLow),
        ("GoTo", Some(place)) if place != "moon" => Ok(Skill::GoTo(place.into())),
        (kind, port) => Err(format!("nothing is called {kind} {}", port.unwrap_or(""))),
    }
}

#[derive(Default)]
struct Robot {
    low: bool,
    calls: Vec<String>,
    transitions: usize,
}

impl Leaves<Skill> for Robot {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        *leaf == Skill::IsLow && self.low
    }

    fn on_start(&mut self, leaf: &Skill, _: Instant) -> Status {
        self.calls.push(format!("start {leaf:?}"));
        Status::Running
    }

    fn on_running(&mut self, _: &Skill, _: Instant) -> Status {
        Status::Running
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        self.calls.push(format!("halt {leaf:?}"));
        Halt::Done
    }

    fn transition(&mut self, _: StatusChange) {
        self.transitions += 1;
    }
}

#[test]
fn robots_share_a_tree_and_each_has_its_own_memory() {
    let tree: BoundTree<Skill> = instance(TREE).bind(find).unwrap();
    let mut robots = [Robot { low: true, ..Robot::default() }, Robot::default()];
    let mut memories = [vec![NodeMemory::NEW; tree.len()], vec![NodeMemory::NEW; tree.len()]];
    for tick in 0..2 {
        for (robot, memory) in robots.iter_mut().zip(&mut memories) {
            assert_eq!(tree.tick(memory, robot, Instant(tick)).status, Status::Running);
        }
    }
    let running = memories.each_ref().map(|memory| tree.running(memory));
    let place = |name: &str| Skill::GoTo(name.into());
    assert_eq!(running, [Some(&place("dock")), Some(&place("field"))]);
    assert_eq!(robots[0].calls, ["start GoTo(\"dock\")"]);
    assert_eq!(robots[1].calls, ["start GoTo(\"field\")"]);

    let [memory, other] = &mut memories;
    assert_eq!(tree.halt(memory, &mut robots[0], Instant(2)), Halt::Done);
    assert_eq!(robots[0].calls[1..], ["halt GoTo(\"dock\")"]);
    assert_eq!((tree.running(memory), tree.running(other)), (None, Some(&place("field"))));
    assert!(robots[0].transitions >= 6, "the robot is told what its tree does");
}

#[test]
fn a_leaf_that_the_program_does_not_have_is_named_with_its_place() {
    let text = TREE.replace("field", "moon");
    let error = instance(&text).bind(find).unwrap_err();
    assert_eq!(error.message, "nothing is called GoTo moon");
    assert_eq!(error.place.line, 1 + text[..text.find("moon").unwrap()].matches('\n').count());
}

#[test]
fn a_script_is_no_leaf() {
    let error = instance(&file(r#"<Script name="count" code="n := 1"/>"#)).bind(find).unwrap_err();
    assert_eq!(error.message, "'count' is more than a leaf");
}
