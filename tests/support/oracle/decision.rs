//! A decision described by its numbers, for the core and for the oracle.

use super::description::Description;
use host_sim::Random;
use iibt_core::actions::Action;
use iibt_core::inference::{
    Beliefs, Candidates, Combinations, Habits, Model, PairPreference, Policy, Problem, Scoring,
};

/// What is to be decided about a described model.
#[derive(Clone, Debug)]
pub struct Decision {
    /// For each control its action sequences.
    pub sequences: Vec<Vec<Vec<Action>>>,
    /// The joint policies, a sequence number per control; all combinations where there is no list.
    pub listed: Option<Vec<Vec<u8>>>,
    /// ln E.
    pub habits: Habit,
    /// How it is scored.
    pub scoring: Scoring,
    /// How many steps are looked at.
    pub horizon: usize,
    /// C in place of the model's, for each modality; empty where the model's stays.
    pub preferences: Vec<Vec<f32>>,
    /// The part of C that counts under way, for each modality; empty where all of it does.
    pub negative_preferences: Vec<Vec<f32>>,
    /// The preferences for moves beyond outcomes.
    pub meetings: Vec<Meeting>,
    /// The groups that are looked at.
    pub scope: u16,
}

/// ln E, as the core takes it.
#[derive(Clone, Debug)]
pub enum Habit {
    /// All alike.
    Flat,
    /// One for each joint policy.
    Joint(Vec<f32>),
    /// One for each sequence of each control.
    PerSequence(Vec<Vec<f32>>),
}

/// A preference for every combination of two factors' states and actions, made from a seed.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// The two factors.
    pub pair: [usize; 2],
    /// Where its numbers come from.
    pub seed: u64,
}

impl Meeting {
    /// The preference for being in two states, before these actions or after.
    #[must_use]
    pub fn worth(&self, states: [usize; 2], actions: Option<[Option<Action>; 2]>) -> f32 {
        let code = |action: Option<Action>| action.map_or(17, u64::from);
        let moves = actions.map_or(999, |[one, other]| code(one) * 20 + code(other));
        let place = states[0] as u64 * 7919 + states[1] as u64 * 104_729 + moves;
        Random::new(self.seed ^ place).bits() as f32 / (1_u32 << 30) as f32 - 2.0
    }

    fn expected(&self, [one, other]: [&[f32]; 2], actions: Option<[Option<Action>; 2]>) -> f32 {
        let mut worth = 0.0;
        for (s, p) in one.iter().enumerate() {
            for (t, q) in other.iter().enumerate() {
                worth += p * q * self.worth([s, t], actions);
            }
        }
        worth
    }
}

impl PairPreference for Meeting {
    fn factors(&self) -> [usize; 2] {
        self.pair
    }

    fn departing(&self, beliefs: [&[f32]; 2], actions: [Option<Action>; 2]) -> f32 {
        self.expected(beliefs, Some(actions))
    }

    fn arrived(&self, beliefs: [&[f32]; 2]) -> f32 {
        self.expected(beliefs, None)
    }
}

impl Decision {
    /// The joint policies, each a sequence number per control.
    #[must_use]
    pub fn policies(&self) -> Vec<Vec<u8>> {
        if let Some(listed) = &self.listed {
            return listed.clone();
        }
        let mut policies = vec![vec![]];
        for list in &self.sequences {
            let choices = list.len().max(1) as u8;
            let longer = |policy: &Vec<u8>, choice| policy.iter().copied().chain([choice]).collect();
            policies = policies
                .iter()
                .flat_map(|policy| (0..choices).map(move |choice| longer(policy, choice)))
                .collect();
        }
        policies
    }

    /// The actions of a joint policy, for each control.
    #[must_use]
    pub fn actions(&self, policy: &[u8]) -> Vec<Vec<Action>> {
        let of = |(list, &number): (&Vec<Vec<Action>>, &u8)| list.get(usize::from(number)).cloned();
        self.sequences.iter().zip(policy).map(|pair| of(pair).unwrap_or_default()).collect()
    }

    /// ln E of a joint policy.
    #[must_use]
    pub fn ln_prior(&self, number: usize, policy: &[u8]) -> f64 {
        match &self.habits {
            Habit::Flat => 0.0,
            Habit::Joint(habits) => habits[number].into(),
            Habit::PerSequence(habits) => {
                habits.iter().zip(policy).map(|(of, &choice)| f64::from(of[usize::from(choice)])).sum()
            }
        }
    }

    /// Puts the problem together as the core takes it and hands it to `with`.
    pub fn pose<const S: usize, const G: usize, T>(
        &self,
        model: &Model,
        beliefs: &Beliefs<S, G>,
        with: impl FnOnce(&Problem<'_, S, G>) -> T,
    ) -> T {
        let policy = |actions: &Vec<Action>| Policy::new(actions).expect("short, and codes that exist");
        let lists: Vec<Vec<Policy>> =
            self.sequences.iter().map(|list| list.iter().map(policy).collect()).collect();
        let sequences: Vec<&[Policy]> = lists.iter().map(Vec::as_slice).collect();
        let rows: Vec<u16> = self.listed.iter().flatten().flatten().map(|&number| number.into()).collect();
        let slices = |lists: &'_ [Vec<f32>]| -> Vec<Vec<f32>> { lists.to_vec() };
        let habits = match &self.habits {
            Habit::PerSequence(habits) => slices(habits),
            _ => vec![],
        };
        let habits: Vec<&[f32]> = habits.iter().map(Vec::as_slice).collect();
        let preferences: Vec<&[f32]> = self.preferences.iter().map(Vec::as_slice).collect();
        let negative_preferences: Vec<&[f32]> = self.negative_preferences.iter().map(Vec::as_slice).collect();
        let meetings: Vec<&dyn PairPreference> =
            self.meetings.iter().map(|of| of as &dyn PairPreference).collect();
        let candidates = Candidates {
            sequences: &sequences,
            combinations: if self.listed.is_some() { Combinations::Listed(&rows) } else { Combinations::All },
            habits: match &self.habits {
                Habit::Flat => Habits::Flat,
                Habit::Joint(habits) => Habits::Joint(habits),
                Habit::PerSequence(_) => Habits::PerSequence(&habits),
            },
            announced: &[],
        };
        with(&Problem {
            horizon: self.horizon,
            preferences: &preferences,
            negative_preferences: &negative_preferences,
            pair_preferences: &meetings,
            scope: self.scope,
            ..Problem::new(model, beliefs, candidates, self.scoring)
        })
    }
}

impl Description {
    /// The group of each factor: factors that move together, by coupling or by a shared control,
    /// counted in the order of their first factors.
    #[must_use]
    pub fn groups(&self) -> Vec<usize> {
        let mut name: Vec<usize> = (0..self.factors.len()).collect();
        let together = |one: usize, other: usize| {
            let (a, b) = (&self.factors[one], &self.factors[other]);
            a.coupled_to.contains(&other)
                || b.coupled_to.contains(&one)
                || (a.control.is_some() && a.control == b.control)
        };
        // As often as a name can be handed on.
        for _ in 0..name.len() {
            for one in 0..name.len() {
                for other in 0..name.len() {
                    if together(one, other) {
                        let least = name[one].min(name[other]);
                        (name[one], name[other]) = (least, least);
                    }
                }
            }
        }
        let mut firsts = name.clone();
        firsts.sort_unstable();
        firsts.dedup();
        name.iter().map(|of| firsts.iter().position(|first| first == of).expect("it is there")).collect()
    }

    /// Every group, a bit for each.
    #[must_use]
    pub fn all_groups(&self) -> u16 {
        self.groups().iter().fold(0, |all, group| all | 1 << group)
    }

    /// How many actions every factor that a control moves knows.
    #[must_use]
    pub fn actions(&self, control: usize) -> usize {
        let moved = self.factors.iter().filter(|factor| factor.control == Some(control));
        moved.map(|factor| factor.actions).min().unwrap_or(0)
    }

    /// How many action sequences a joint policy has.
    #[must_use]
    pub fn controls(&self) -> usize {
        self.factors.iter().filter_map(|factor| factor.control).map(|control| control + 1).max().unwrap_or(0)
    }
}
