//! What decides where something is unknown: inference, or a rule in its place.
//!
//! The rules are there to measure what each part of the decision is worth, on the same rounds,
//! plans and sensors. Without the feature `ablation` inference decides, and no code of them is in
//! an image.
#![cfg_attr(not(feature = "ablation"), allow(dead_code, unreachable_pub, reason = "only inference decides"))]

use super::alternatives::{Alternative, Others};
use super::mission::Mission;
use super::outlook::Seekers;
use super::policies::TeamPlan;
use super::prospects::{Bits, LONGEST, Prospects, Robots, bits, descending, worlds_of};
use super::ways::Way;
use crate::grid::{Cell, Path};
use crate::inference::Eighths;
use crate::team::Fnv1a;

/// The probability below which a rule takes a world for impossible.
const IMPLAUSIBLE: f32 = 0.05;

/// What decides where something is unknown.
///
/// All robots of a team have the same one. A rule decides again when what it has assumed is no
/// longer believed; what is unknown, read and announced is the same for all.
///
/// ```
/// # #[cfg(feature = "ablation")] {
/// use iibt_core::grid::{Cell, Map};
/// use iibt_core::navigation::{Decider, Mission};
///
/// let (starts, goals) = ([Cell(0)], [Cell(3)]);
/// let mission = Mission::new(Map::<1>::new(4, 1)?, &starts, &goals);
/// assert_eq!(mission.decider, Decider::Inference);
/// // The same mission, flown as if the likeliest world were the only one.
/// let blind = Mission { decider: Decider::Likeliest, ..mission };
/// # assert_eq!(blind.decider, Decider::Likeliest);
/// # }
/// # Ok::<(), iibt_core::grid::MapError>(())
/// ```
#[doc(alias = "baseline")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Decider {
    /// The posterior over the joint policies, each weighed over the worlds.
    #[default]
    Inference,
    /// The same, but what is seen on the way changes nothing.
    WithoutBranching,
    /// The same without policies by which a robot looks first.
    WithoutLooking,
    /// The same, but a robot's last reading of an unknown is all that it believes.
    LastReading,
    /// The same, but a robot's first reading of an unknown is a fact that stays.
    StayingFacts,
    /// The same, but no reading enters a joint decision: a robot asks for another one by its own.
    Unshared,
    /// A policy drawn by the paths of all.
    Random,
    /// The first policy of the list.
    First,
    /// The policy that takes the fewest ticks if nothing is seen.
    Shortest,
    /// The policy whose robots have the least distance to go altogether, walls not counted.
    Matching,
    /// Go to the goals of the likeliest world.
    Likeliest,
    /// Go to the goals of the world where they are nearest: free space, until it is seen otherwise.
    Nearest,
    /// Go to the goals of the world where they are farthest: all is blocked, until it is seen
    /// otherwise.
    Farthest,
    /// The policy that takes the fewest ticks with this many times p / (1 - p) ticks for each of
    /// its cells that is blocked with probability p.
    Priced(u8),
    /// The nearest robot reads what is unknown first, if it has no more than this many moves to
    /// there, and the others stand; else as [`Likeliest`](Self::Likeliest).
    LookFirst(u8),
    /// The same, but the others go on to the goals of the likeliest world.
    LookOnTheWay(u8),
}

/// How a robot counts what it reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Counting {
    /// Readings add up.
    Sums,
    /// The last one is all that counts.
    Last,
    /// The first one is all that counts.
    First,
}

impl Decider {
    /// Whether what is seen on the way can change how the team goes on.
    pub(super) const fn branches(self) -> bool {
        !matches!(self, Self::WithoutBranching)
    }

    /// Whether policies are weighed over the worlds.
    pub(super) const fn infers(self) -> bool {
        use Decider::{Inference, LastReading, StayingFacts, Unshared, WithoutBranching, WithoutLooking};
        matches!(self, Inference | WithoutBranching | WithoutLooking | LastReading | StayingFacts | Unshared)
    }

    /// Whether it may send a robot to look.
    pub(super) const fn looks(self) -> bool {
        use Decider::{First, LookFirst, LookOnTheWay, Random};
        self.infers() && !matches!(self, Self::WithoutLooking)
            || matches!(self, Random | First | LookFirst(_) | LookOnTheWay(_))
    }

    /// The most moves that a robot goes to where it looks, if there is a limit.
    pub(super) const fn farthest_look(self) -> u8 {
        match self {
            Self::LookFirst(moves) | Self::LookOnTheWay(moves) => moves,
            _ => u8::MAX,
        }
    }

    pub(super) const fn counting(self) -> Counting {
        match self {
            Self::LastReading => Counting::Last,
            Self::StayingFacts => Counting::First,
            _ => Counting::Sums,
        }
    }

    /// Whether robots announce what they have read.
    pub(super) const fn shares(self) -> bool {
        !matches!(self, Self::Unshared)
    }
}

impl<const S: usize, const W: usize> Prospects<S, W> {
    /// Whether a decider has plans made for an alternative.
    pub(super) fn is_listed(
        &self,
        mission: &Mission<'_, W>,
        robots: &[Cell],
        alternative: Alternative,
    ) -> bool {
        let is_world = |way| {
            let assumed = self.assume(way, robots, self.plausible());
            let rank = |world| self.by_belief().position(|other| other == world);
            alternative == Alternative::World(assumed.and_then(rank).unwrap_or(0))
        };
        match mission.decider() {
            Decider::Likeliest => is_world(Way::Likeliest),
            Decider::Nearest => is_world(Way::Nearest),
            Decider::Farthest => is_world(Way::Farthest),
            Decider::LookFirst(_) => {
                is_world(Way::Likeliest) || matches!(alternative, Alternative::Look(_, Others::Stand))
            }
            Decider::LookOnTheWay(_) => {
                is_world(Way::Likeliest) || matches!(alternative, Alternative::Look(_, Others::GoOn))
            }
            Decider::Random | Decider::First | Decider::Shortest | Decider::Matching | Decider::Priced(_) => {
                // Where one of several goals serves, they go to those of a world that may be.
                match alternative {
                    Alternative::Free => !self.has_doubtful_goals(mission),
                    Alternative::World(rank) => {
                        self.by_belief().nth(rank).is_some_and(|world| self.plausible() >> world & 1 == 1)
                    }
                    _ => true,
                }
            }
            _ => true,
        }
    }

    fn plausible(&self) -> Bits {
        let likeliest = self.likeliest();
        bits((0..self.belief().len()).filter(|&world| world == likeliest || self.p(world) >= IMPLAUSIBLE))
    }

    /// What a policy is worth by a rule, in eighths of a tick: the least is chosen.
    pub(super) fn by_rule(&self, mission: &Mission<'_, W>, index: usize, plan: &TeamPlan) -> Eighths {
        let ticks = 8 * u16::from(plan.execution().ticks);
        match mission.decider() {
            Decider::Random => {
                let bytes = plan.paths().iter().flat_map(|path| {
                    [path.start, path.end(&mission.map)].into_iter().flat_map(|cell| cell.0.to_le_bytes())
                });
                let hash = bytes.fold(Fnv1a::EMPTY, |hash, byte| hash.write(&[byte]));
                (hash.finish() >> 32) as u16 % (8 * LONGEST)
            }
            Decider::First => 8 * index as u16,
            Decider::Matching => {
                let distance = |path: &Path| mission.map.manhattan(path.start, path.end(&mission.map));
                8 * plan.paths().iter().map(distance).sum::<u16>()
            }
            Decider::Priced(times) => {
                let price = |p: f32| 8.0 * f32::from(times) * p / (1.0 - p).max(0.001);
                let cells = plan.paths().iter().flat_map(|path| path.cells(&mission.map));
                let prices: f32 = cells.map(|cell| price(self.p_blocked(mission, cell))).sum();
                // A cast saturates.
                ticks.saturating_add(prices as u16).min(8 * LONGEST)
            }
            // The list begins with the plan for the likeliest world; one to look goes before it.
            Decider::LookFirst(_) | Decider::LookOnTheWay(_) => 8 * u16::from(index != 1),
            _ => ticks,
        }
    }

    /// Whether what a rule has assumed for a plan is no longer believed.
    pub(super) fn is_refuted(
        &self,
        decider: Decider,
        seekers: Seekers,
        ends: &Robots,
        belief: &[f32],
    ) -> bool {
        let served = bits((0..belief.len()).filter(|&world| self.is_done(world, ends)));
        let p = |world: usize| belief.get(world).copied().unwrap_or(0.0);
        let is_served = |world: usize| served >> world & 1 == 1;
        match decider {
            _ if seekers.is_empty() => false,
            Decider::Nearest | Decider::Farthest | Decider::Shortest | Decider::Priced(_) => {
                worlds_of(served).map(p).sum::<f32>() < IMPLAUSIBLE
            }
            _ => !descending(bits(0..belief.len()), p).next().is_some_and(is_served),
        }
    }
}
