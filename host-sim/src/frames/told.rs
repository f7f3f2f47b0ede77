//! What recorded frames tell, whatever the team does.

use super::heard::{Heard, Round};
use crate::text::counted;
use iibt_core::team::RobotId;
use iibt_core::team::rounds::Fact;
use std::collections::BTreeMap;
use std::fmt;

/// What is known from recorded frames of a team whose joint policies are told as `C`.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardFrames<C> {
    /// The number of frames of the mission.
    pub accepted: u32,
    /// The reasons why others were refused, and how often.
    pub refused: BTreeMap<String, u32>,
    /// The names under which two robots have sent, or one in two recordings, and how many frames
    /// are not of the first.
    pub twins: BTreeMap<String, u32>,
    /// The rounds by their numbers.
    pub rounds: Vec<HeardRound<C>>,
}

/// A round as its frames tell it.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardRound<C> {
    /// Its number.
    pub round: u32,
    /// The names of its members.
    pub members: Vec<String>,
    /// The names of the members whose facts are missing.
    pub missing: Vec<String>,
    /// Whether a frame has the choice.
    pub is_decided: bool,
    /// The joint policy, if a frame has the choice and no fact is missing.
    pub chosen: Option<C>,
}

/// A chosen joint policy, as it is written.
pub trait ToldChoice: fmt::Display {
    /// What cannot be told without the facts of all members.
    const UNKNOWN: &'static str;
}

impl<C> HeardFrames<C> {
    /// Names the robots of what was heard by `name`, and tells their choices by `chosen`.
    pub(super) fn of<F: Fact, M>(
        heard: Heard<F, M>,
        name: impl Fn(RobotId) -> String,
        chosen: impl Fn(&Round<F, M>) -> Option<C>,
    ) -> Self {
        let told = |round: &Round<F, M>| HeardRound {
            round: round.proposal.round,
            members: round.members().map(&name).collect(),
            missing: round.missing().map(&name).collect(),
            is_decided: round.choice.is_some(),
            chosen: chosen(round),
        };
        let rounds = heard.rounds.iter().map(told).collect();
        let twins = heard.twins.iter().map(|(&robot, &frames)| (name(robot), frames)).collect();
        Self { accepted: heard.accepted, refused: heard.refused, twins, rounds }
    }
}

impl<C: ToldChoice> fmt::Display for HeardFrames<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for round in &self.rounds {
            write!(f, "{round}")?;
        }
        write!(f, "{} read", counted(self.accepted, "frame"))?;
        for (reason, times) in &self.refused {
            write!(f, ", {times} refused: {reason}")?;
        }
        writeln!(f)?;
        self.twins.iter().try_for_each(|(name, &frames)| {
            let frames = counted(frames, "frame");
            writeln!(f, "two robots send as {name}: {frames} cannot be of the one that sent the others")
        })
    }
}

impl<C: ToldChoice> fmt::Display for HeardRound<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let missing = self.missing.join(" ");
        write!(f, "round {}, {}: ", self.round, self.members.join(" "))?;
        match &self.chosen {
            Some(chosen) => write!(f, "{chosen}"),
            None if !self.is_decided => writeln!(f, "no choice was sent"),
            None if missing.is_empty() => writeln!(f, "the choice is not in the list of its facts"),
            None => writeln!(f, "{} is unknown without the facts of {missing}", C::UNKNOWN),
        }
    }
}
