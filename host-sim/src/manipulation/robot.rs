//! The leaves of figure 14, and the robots that run it.

use super::record::Thought;
use super::run::Hand;
use super::skill::place;
use super::tables::{AT_MEETING, EMPTY, GOAL_C, GRIP, HOLDS, MOVE_TO, PLACE, PLACED, TO_HOLD, TO_PLACE};
use super::terms::Order;
use crate::task::{HostRobot, Station};
use crate::tree::LeafNode;
use firmware::{Skills, TaskLeaf, Turn};
use iibt_core::tree::Status;

/// The plain leaf MoveTo, with its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct MoveTo(u8);

/// The leaf that a file names.
pub(super) fn leaf(leaf: &LeafNode, _: usize) -> Result<TaskLeaf<MoveTo>, String> {
    match leaf.kind.as_str() {
        "HoldBottle" | "HoldPlate" => Ok(TaskLeaf::Aim(TO_HOLD)),
        "PlaceBottle" => Ok(TaskLeaf::Aim(TO_PLACE)),
        "IsReached" if place(leaf, "place")? == GOAL_C => Ok(TaskLeaf::Fact(AT_MEETING)),
        "MoveTo" => place(leaf, "goal").map(|place| TaskLeaf::Own(MoveTo(place))),
        id => Err(format!("the robots that infer have no leaf '{id}' here")),
    }
}

/// What such a robot does by itself: it moves, and may wait for its turn to.
pub(super) struct Mover(pub(super) Order);

impl Skills<Station> for Mover {
    type Leaf = MoveTo;
    type Message = ();

    /// Leaves for the meeting place when, in turn, the teammate has its object too; fails when the
    /// robot is sure to have nothing to bring there, so that the tree begins again.
    fn on_running(&mut self, &MoveTo(place): &MoveTo, turn: &mut Turn<'_, ()>) -> Status {
        if !turn.is_settled {
            return Status::Running;
        }
        let meets = place == GOAL_C;
        if meets && turn.sure(GRIP) == Some(EMPTY) {
            return Status::Failure;
        }
        if turn.sure(PLACE) == Some(place) {
            return Status::Success;
        }
        let mut grips = turn.peers.fresh().filter_map(|peer| peer.message().fact().state(GRIP.into()));
        let leaves = !meets || self.0 == Order::Together || grips.any(|grip| [HOLDS, PLACED].contains(&grip));
        if turn.peers.all_connected() && leaves {
            turn.begin(MOVE_TO, Some(place));
        }
        Status::Running
    }

    fn message(&self) {}
}

impl<'t> Hand<'t> for HostRobot<'t, Mover> {
    fn thought(&self) -> Option<Thought> {
        Some(Thought::of(self.task(), self.node().raised()))
    }

    fn leaf(&self) -> Option<&'static str> {
        Some(match self.running()? {
            TaskLeaf::Aim(TO_HOLD) => "Hold",
            TaskLeaf::Aim(_) => "PlaceOn",
            _ => "MoveTo",
        })
    }
}
