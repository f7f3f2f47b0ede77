//! The leaves of conventional trees, by the names they have in the files.

use super::tables::{GOAL_A, GOAL_B, GOAL_C};
use crate::tree::LeafNode;

/// The skill of a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Skill {
    IsReached(u8),
    MoveTo(u8),
    IsHolding,
    IsPlaced,
    /// Whether the teammate announces this place.
    IsTeammateAt(u8),
    /// Whether the teammate announces that it holds its object.
    IsTeammateHolding,
    Pick,
    Place,
    /// Waits for a tick, then fails, so that the tree asks again.
    Wait,
    /// Takes readings until the state is settled again.
    Look,
    /// Succeeds: a robot announces its action in every tick.
    Announce,
}

impl Skill {
    /// The skill of robot `own` that a leaf names.
    pub(super) fn of(leaf: &LeafNode, own: usize) -> Result<Self, String> {
        match leaf.kind.as_str() {
            "IsReached" => place(leaf, "place").map(Self::IsReached),
            "MoveTo" => place(leaf, "goal").map(Self::MoveTo),
            "IsHolding" => own_thing(leaf, own).map(|()| Self::IsHolding),
            "IsPlacedAt" => own_thing(leaf, own).map(|()| Self::IsPlaced),
            "Pick" => own_thing(leaf, own).map(|()| Self::Pick),
            "Place" => own_thing(leaf, own).map(|()| Self::Place),
            "IsReachedBy" => teammate(leaf, own).and_then(|()| place(leaf, "place")).map(Self::IsTeammateAt),
            "IsHeldBy" => teammate(leaf, own).map(|()| Self::IsTeammateHolding),
            "Wait" => Ok(Self::Wait),
            "Look" => Ok(Self::Look),
            "Announce" => Ok(Self::Announce),
            id => Err(format!("the robots that handle things have no leaf '{id}'")),
        }
    }

    /// The name on the screen.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::IsReached(_) => "IsReached",
            Self::MoveTo(_) => "MoveTo",
            Self::IsHolding => "IsHolding",
            Self::IsPlaced => "IsPlacedAt",
            Self::IsTeammateAt(_) => "IsReachedBy",
            Self::IsTeammateHolding => "IsHeldBy",
            Self::Pick => "Pick",
            Self::Place => "Place",
            Self::Wait => "Wait",
            Self::Look => "Look",
            Self::Announce => "Announce",
        }
    }
}

fn port<'l>(leaf: &'l LeafNode, name: &str) -> Result<&'l str, String> {
    leaf.port(name).ok_or_else(|| format!("{} needs a value for its port '{name}'", leaf.kind))
}

/// A place by its name, or by the thing that is there to begin with.
pub(super) fn place(leaf: &LeafNode, name: &str) -> Result<u8, String> {
    match leaf.port(name) {
        Some("goal A" | "bottle") => Ok(GOAL_A),
        Some("goal B" | "plate") => Ok(GOAL_B),
        Some("goal C") => Ok(GOAL_C),
        given => {
            let given = given.unwrap_or("nothing");
            Err(format!("'{given}' for port '{name}' is no place: goal A, goal B, goal C, bottle, plate"))
        }
    }
}

/// Robot 1 handles the bottle, robot 2 the plate.
fn own_thing(leaf: &LeafNode, own: usize) -> Result<(), String> {
    let (thing, given) = (["bottle", "plate"][own.min(1)], port(leaf, "thing")?);
    if given == thing {
        return Ok(());
    }
    Err(format!("'{given}' for port 'thing' is not what robot {} handles, the {thing}", own + 1))
}

fn teammate(leaf: &LeafNode, own: usize) -> Result<(), String> {
    let (number, given) = (["2", "1"][own.min(1)], port(leaf, "robot")?);
    if given == number {
        return Ok(());
    }
    Err(format!("'{given}' for port 'robot' is not the teammate of robot {}, which is {number}", own + 1))
}
