//! The trees' leaves, bound by name to what the robot can do.

use crate::tree::{Hooked, library};
use iibt_core::tree::{Basic, Row, TreeRef};
use std::sync::OnceLock;

/// What a leaf stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Skill {
    /// There is charge enough to go on.
    BatteryEnough,
    /// Every robot stands on a goal of its own.
    AllArrived,
    /// This robot stands on a goal.
    OneArrived,
    /// An obstacle, or a teammate with the right of way, is on the policy.
    ObstacleExists,
    /// There is a way-point to visit.
    WayPointsExist,
    /// The first goal is this robot's part of the least sum of ways.
    SmallestSum,
    /// The first goal is nearer than the second.
    FirstGoalNearer,
    /// The next move may be made, as far as arriving together is concerned.
    JointArrival,
    /// Go and charge.
    MoveToCharger,
    /// Construct a policy around the obstacle.
    AroundObstacle,
    /// Construct a policy by the way-points.
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

/// Which conventional tree a robot ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Figure {
    /// Figure 5(a): two robots, two goals.
    Five,
    /// Figure 8, table 3.
    Eight,
}

/// A tree ready to be ticked; robots share it.
#[derive(Debug)]
pub(super) struct Bound {
    pub(super) tree: TreeRef<'static, u16, Basic>,
    pub(super) nodes: usize,
    skills: Vec<Skill>,
}

static FIVE: OnceLock<Bound> = OnceLock::new();
static EIGHT: OnceLock<Bound> = OnceLock::new();

impl Figure {
    const fn file(self) -> &'static str {
        match self {
            Self::Five => "figure-5-classical",
            Self::Eight => "figure-8-classical",
        }
    }

    /// The tree of the file, put together once for all robots.
    pub(super) fn bound(self) -> &'static Bound {
        let place = match self {
            Self::Five => &FIVE,
            Self::Eight => &EIGHT,
        };
        place.get_or_init(|| {
            let file = self.file();
            bind(file).unwrap_or_else(|reason| unreachable!("{file} is built in, but {reason}"))
        })
    }
}

impl Bound {
    /// What leaf number `hook` stands for.
    pub(super) fn skill(&self, hook: u16) -> Option<Skill> {
        self.skills.get(usize::from(hook)).copied()
    }
}

/// Loads a tree that is built in, lowers it to the core's table and binds its leaves.
fn bind(file: &str) -> Result<Bound, String> {
    let instance =
        library::instance(file).ok_or("there is no such tree")?.map_err(|error| error.to_string())?;
    let hooked: Hooked = instance.hooked().map_err(|error| error.to_string())?;
    let skills = hooked.leaves.iter().map(|leaf| {
        let port = leaf.ports.first().map_or("", |(_, value)| value.as_str());
        skill(&leaf.kind, port).ok_or_else(|| format!("no skill is called {} {port}", leaf.kind))
    });
    let skills = skills.collect::<Result<_, _>>()?;
    let nodes = hooked.rows.len();
    let rows: &'static mut [Row<u16>] = Box::leak(hooked.rows.into_iter().map(Row::new).collect());
    let tree = TreeRef::try_new(rows).map_err(|error| format!("{:?}", error.rule))?;
    Ok(Bound { tree, nodes, skills })
}

fn skill(kind: &str, port: &str) -> Option<Skill> {
    Some(match (kind, port) {
        ("BatteryEnough", "") => Skill::BatteryEnough,
        ("AllArrived", "") => Skill::AllArrived,
        ("OneArrived", "") => Skill::OneArrived,
        ("ObstacleExists", "") => Skill::ObstacleExists,
        ("WayPointsExist", "") => Skill::WayPointsExist,
        ("SmallestSum", "") => Skill::SmallestSum,
        ("FirstGoalNearer", "") => Skill::FirstGoalNearer,
        ("JointArrival", "") => Skill::JointArrival,
        ("MoveToCharger", "") => Skill::MoveToCharger,
        ("ConstructPolicy", "obstacle") => Skill::AroundObstacle,
        ("ConstructPolicy", "way points") => Skill::ByWayPoints,
        ("MoveTo", "goal1") => Skill::MoveTo(Choice::First),
        ("MoveTo", "goal2") => Skill::MoveTo(Choice::Second),
        _ => return None,
    })
}

impl Skill {
    /// What the leaf is called on the screen.
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

    #[test]
    fn every_leaf_of_the_figures_has_its_skill() {
        let skills = |figure: Figure| figure.bound().skills.len();
        assert_eq!((skills(Figure::Five), figure_nodes(Figure::Five)), (6, 9));
        assert_eq!((skills(Figure::Eight), figure_nodes(Figure::Eight)), (12, 21));
        assert_eq!(skill("MoveTo", "goal3"), None);
    }

    fn figure_nodes(figure: Figure) -> usize {
        figure.bound().nodes
    }
}
