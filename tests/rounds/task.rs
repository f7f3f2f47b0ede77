//! The smallest task that shares space: robots on at most 16 places, each on a timed path.

use iibt_core::iibt::cheapest_policy;
use iibt_core::team::RobotId;
use iibt_core::team::rounds::{Claim, Fact, JointPolicies, Score};
use serde::{Deserialize, Serialize};

/// Places, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) struct Places(pub(super) u16);

impl Places {
    pub(super) fn at(place: u8) -> Self {
        Self(1 << place)
    }
}

impl Claim for Places {
    type Wire = Self;
    const WIRE_BYTES: usize = 4 * 3;
    const EMPTY: Self = Self(0);

    fn union(&self, other: &Self) -> Self {
        Self(self.0 | other.0)
    }

    fn contains(&self, other: &Self) -> bool {
        other.0 & !self.0 == 0
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.0 & other.0 != 0
    }

    fn to_wire(&self, _: usize) -> Self {
        *self
    }

    fn from_wire(wire: &Self) -> Self {
        *wire
    }
}

/// Where a robot stands, and a number that stands for all else it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) struct Place {
    pub(super) at: Places,
    pub(super) errand: u8,
}

impl Place {
    pub(super) fn at(place: u8) -> Self {
        Self { at: Places::at(place), errand: 0 }
    }
}

impl Fact for Place {
    type Claim = Places;
    const MAX_BYTES: usize = 4;

    fn anchor(&self) -> Places {
        self.at
    }
}

/// One joint policy: a path for each robot of the team, what it occupies after each step. A robot
/// that is left out has none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Joint {
    pub(super) paths: Vec<Vec<Places>>,
    pub(super) cost: u16,
    pub(super) is_together: bool,
}

/// The policies in the order of the list.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct List(pub(super) Vec<Joint>);

impl List {
    /// What the robot occupies after a step; where its path ends, after the last.
    pub(super) fn place(&self, policy: usize, robot: RobotId, step: u16) -> Places {
        let path = self.path(policy, robot);
        path.get(usize::from(step)).or(path.last()).copied().unwrap_or_default()
    }

    pub(super) fn path(&self, policy: usize, robot: RobotId) -> &[Places] {
        self.0.get(policy).and_then(|joint| joint.paths.get(robot.index())).map_or(&[], Vec::as_slice)
    }

    /// What the robot occupies while it makes the step after `step`.
    pub(super) fn between(&self, policy: usize, robot: RobotId, step: u16) -> Places {
        self.place(policy, robot, step).union(&self.place(policy, robot, step + 1))
    }
}

impl JointPolicies for List {
    type Claim = Places;

    fn len(&self) -> usize {
        self.0.len()
    }

    fn cost(&self, policy: usize) -> u16 {
        self.0[policy].cost
    }

    fn claim(&self, policy: usize, robot: RobotId, step: u16) -> Places {
        let path = self.path(policy, robot);
        let from = usize::from(step).min(path.len().saturating_sub(1));
        path.iter().skip(from).fold(Places::EMPTY, |all, place| all.union(place))
    }

    fn moves(&self, policy: usize, robot: RobotId) -> u16 {
        let path = self.path(policy, robot);
        path.windows(2).rposition(|pair| pair[0] != pair[1]).map_or(0, |last| last as u16 + 1)
    }

    fn is_clear(&self, policy: usize, robot: RobotId, step: u16, teammate: RobotId, reported: u16) -> bool {
        let (here, next) = (self.place(policy, robot, step), self.place(policy, robot, step + 1));
        let entered = Places(next.0 & !here.0);
        (0..=step + 1)
            .rev()
            .find(|&earlier| self.place(policy, teammate, earlier).overlaps(&entered))
            .is_none_or(|last| reported > last)
    }

    fn is_together(&self, policy: usize) -> bool {
        self.0[policy].is_together
    }

    fn choose<'s>(&self, members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize> {
        cheapest_policy(self, members)
    }
}
