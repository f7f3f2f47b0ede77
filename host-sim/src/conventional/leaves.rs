//! The leaves of the trees, bound by name to the robot's skills.

use crate::tree::{BoundTree, Diagnostic, LeafNode, library};
use std::sync::LazyLock;

/// A condition or action of a conventional tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ConventionalLeaf {
    /// The charge is sufficient to continue.
    BatteryEnough,
    /// Every robot stands on a goal of its own.
    AllArrived,
    /// This robot stands on a goal.
    OneArrived,
    /// An obstacle, or a teammate with the right of way, is on the policy.
    ObstacleExists,
    /// There is a way-point to visit.
    WayPointsExist,
    /// The first goal is this robot's in the best assignment.
    SmallestSum,
    /// The first goal is nearer than the second.
    FirstGoalNearer,
    /// The next move does not keep the team from arriving together.
    JointArrival,
    /// Go and charge.
    MoveToCharger,
    /// Construct a policy around the obstacle.
    AroundObstacle,
    /// Construct a policy through the way-points.
    ByWayPoints,
    /// Make the next move to the first or the second goal.
    MoveTo(Choice),
}

/// The goals of the figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Choice {
    First,
    Second,
}

/// The conventional tree of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ConventionalTree {
    /// Figure 5(a): two robots, two goals.
    Five,
    /// Figure 8, table 3.
    Eight,
}

static FIVE: LazyLock<BoundTree<ConventionalLeaf>> = LazyLock::new(|| built_in("figure-5-classical"));
static EIGHT: LazyLock<BoundTree<ConventionalLeaf>> = LazyLock::new(|| built_in("figure-8-classical"));

impl ConventionalTree {
    /// The tree of the file, bound once for all robots.
    pub(super) fn tree(self) -> &'static BoundTree<ConventionalLeaf> {
        match self {
            Self::Five => &FIVE,
            Self::Eight => &EIGHT,
        }
    }
}

fn built_in(file: &str) -> BoundTree<ConventionalLeaf> {
    bind(file).unwrap_or_else(|reason| unreachable!("{file} is built in, but {reason}"))
}

fn bind(file: &str) -> Result<BoundTree<ConventionalLeaf>, Diagnostic> {
    library::instance(file).unwrap_or_else(|| unreachable!("{file} is built in"))?.bind(ConventionalLeaf::of)
}

fn skill(kind: &str, port: &str) -> Option<ConventionalLeaf> {
    Some(match (kind, port) {
        ("BatteryEnough", "") => ConventionalLeaf::BatteryEnough,
        ("AllArrived", "") => ConventionalLeaf::AllArrived,
        ("OneArrived", "") => ConventionalLeaf::OneArrived,
        ("ObstacleExists", "") => ConventionalLeaf::ObstacleExists,
        ("WayPointsExist", "") => ConventionalLeaf::WayPointsExist,
        ("SmallestSum", "") => ConventionalLeaf::SmallestSum,
        ("FirstGoalNearer", "") => ConventionalLeaf::FirstGoalNearer,
        ("JointArrival", "") => ConventionalLeaf::JointArrival,
        ("MoveToCharger", "") => ConventionalLeaf::MoveToCharger,
        ("ConstructPolicy", "obstacle") => ConventionalLeaf::AroundObstacle,
        ("ConstructPolicy", "way points") => ConventionalLeaf::ByWayPoints,
        ("MoveTo", "goal1") => ConventionalLeaf::MoveTo(Choice::First),
        ("MoveTo", "goal2") => ConventionalLeaf::MoveTo(Choice::Second),
        _ => return None,
    })
}

impl ConventionalLeaf {
    fn of(leaf: &LeafNode) -> Result<Self, String> {
        let port = leaf.ports.first().map_or("", |(_, value)| value.as_str());
        skill(&leaf.kind, port).ok_or_else(|| format!("no skill is called {} {port}", leaf.kind))
    }

    /// The name on the screen.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::BatteryEnough => "BatteryEnough",
            Self::AllArrived => "AllArrived",
            Self::OneArrived => "OneArrived",
            Self::ObstacleExists => "ObstacleExists",
            Self::WayPointsExist => "WayPointsExist",
            Self::SmallestSum => "SmallestSum",
            Self::FirstGoalNearer => "FirstGoalNearer",
            Self::JointArrival => "JointArrival",
            Self::MoveToCharger => "MoveToCharger",
            Self::AroundObstacle => "ConstructPolicy obstacle",
            Self::ByWayPoints => "ConstructPolicy way points",
            Self::MoveTo(Choice::First) => "MoveTo goal1",
            Self::MoveTo(Choice::Second) => "MoveTo goal2",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use iibt_core::tree::Node;

    #[test]
    fn every_leaf_of_the_figures_has_its_skill() {
        let leaves = |figure: ConventionalTree| {
            figure.tree().by_ref().nodes().filter(|node| node.children().is_none()).count()
        };
        assert_eq!((leaves(ConventionalTree::Five), ConventionalTree::Five.tree().len()), (6, 9));
        assert_eq!((leaves(ConventionalTree::Eight), ConventionalTree::Eight.tree().len()), (12, 21));
        assert!(
            ConventionalTree::Eight
                .tree()
                .by_ref()
                .nodes()
                .any(|node| *node == Node::Action(ConventionalLeaf::MoveToCharger))
        );
        assert_eq!(skill("MoveTo", "goal3"), None);
    }
}
