//! Learned preferences for goals: how often a robot is served at each.
//!
//! All goals begin with the same preference. With experience, the preference for a goal becomes ln
//! P(served | goal), learned from the robot's own visits over many missions. A goal that has not
//! been visited counts as a good one, so that it is tried.

use super::MAX_GOALS;
/// The preference for a goal of which nothing is known.
const GOAL: f32 = 1.0;

use crate::inference::Evidence;
use crate::inference::learning::{PreferenceCounts, Rates};

/// The outcome "served" of standing at a goal; the other outcome is "not served".
const SERVED: usize = 1;

/// The prior counts of an unknown goal: a weak belief that the robot is served there.
const TRUST: [f32; 2] = [0.1, 1.0];

/// The most by which the preference for a goal can fall; the remainder keeps it a goal.
const BOUND: f32 = 0.9;

/// A robot's experience with the goals of a mission, which outlives the mission. Memory: about 30
/// bytes a goal.
///
/// ```
/// use iibt_core::navigation::Experience;
///
/// let mut experience = Experience::default();
/// experience.learn(0, true);
/// experience.learn(1, false);
/// let [first, second, unknown, ..] = experience.values();
/// assert!(first > unknown && unknown > second && second > 0.0);
/// ```
#[doc(alias = "preference learning")]
#[doc(alias = "bandit")]
#[derive(Clone, Debug, PartialEq)]
pub struct Experience {
    goals: [PreferenceCounts<2>; MAX_GOALS],
}

impl Experience {
    /// Creates an experience without any visit.
    #[must_use]
    pub fn new(rates: Rates) -> Self {
        Self { goals: core::array::from_fn(|_| PreferenceCounts::new(TRUST, rates, BOUND)) }
    }

    /// Counts a visit to a goal, given by its index in the mission's list, and whether the robot
    /// was served; returns `false` for an index without a goal.
    pub fn learn(&mut self, goal: usize, served: bool) -> bool {
        let outcome = if served { SERVED } else { 1 - SERVED };
        self.goals.get_mut(goal).is_some_and(|counts| counts.learn(Evidence::Outcome(outcome), 1.0))
    }

    /// Returns the preference for each goal on the log scale of C, always above zero, for
    /// [`Navigation::set_goal_preferences`](super::Navigation::set_goal_preferences).
    #[must_use]
    pub fn values(&self) -> [f32; MAX_GOALS] {
        self.goals.each_ref().map(|counts| {
            let [_, served] = counts.values();
            GOAL + served
        })
    }
}

impl Default for Experience {
    fn default() -> Self {
        Self::new(Rates::DEFAULT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_goal_is_worth_as_much_as_it_serves_and_never_nothing() {
        let mut experience = Experience::default();
        for turn in 0..1000 {
            assert!(experience.learn(0, turn % 5 != 0) && experience.learn(1, turn % 2 == 0));
            assert!(experience.learn(2, false) && !experience.learn(MAX_GOALS, true));
        }
        let [often, even, never, unknown, ..] = experience.values();
        let near = |value: f32, chance: f32| (value - 1.0 - crate::math::ln(chance)).abs() < 0.01;
        assert!(near(often, 0.8) && near(even, 0.5), "{often} {even}");
        assert!((never - (GOAL - BOUND)).abs() < 1e-6 && unknown > often, "{never} {unknown}");
    }
}
