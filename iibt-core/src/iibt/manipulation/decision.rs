//! The choice among the sixteen joint policies.

use super::announcement::Announcement;
use super::deed::{Deed, JOINT, Joint, STATES};
use super::mission::Preset;
use super::model;
use crate::inference::{Beliefs, Candidates, Evaluation, Evidence, Policy, Preference, Problem, Scoring};

/// The last decision of a robot: what it was made from and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// C of robots 0 and 1 as it was, raises included.
    pub preferences: [[f32; STATES]; 2],
    /// q(s) of robots 0 and 1.
    pub beliefs: [[f32; STATES]; 2],
    /// The posterior over all joint policies, by their numbers.
    pub posterior: [f32; JOINT],
    /// The most probable joint policy in which the teammate does what it has announced.
    pub choice: Joint,
}

/// What a decision is made from.
pub(super) struct Question<'a> {
    pub(super) preset: Preset,
    /// The robot that decides.
    pub(super) own: usize,
    /// q(s) of its own.
    pub(super) states: [f32; STATES],
    /// What the teammate said last.
    pub(super) teammate: Option<Announcement>,
    pub(super) preferences: &'a [Preference<STATES>; 2],
    /// The robot whose preconditions of placing hold.
    pub(super) placer: Option<usize>,
}

impl Question<'_> {
    /// Algorithm 2 over the joint policies; `None` for a preset that is no model.
    pub(super) fn decide(&self) -> Option<Decision> {
        model::with_decision(self.preset, self.placer, |model| {
            let other = 1 - self.own.min(1);
            let mut beliefs = Beliefs::<STATES, 2>::try_prior(model).unwrap_or(Beliefs::EMPTY);
            let _ = beliefs.set(model, self.own, &self.states);
            if let Some(said) = self.teammate {
                // A message is read like a sensor; no outcome is impossible to this one.
                let _ = beliefs.observe(model, other, Evidence::Outcome(said.state as usize));
            }
            let policies = Deed::ALL.map(Deed::policy);
            let posterior = self.posterior(model, &beliefs, [&policies; 2]);
            let copy = |robot| core::array::from_fn(|at| at_or_zero(beliefs.of(model, robot), at));
            Decision {
                preferences: self.preferences.each_ref().map(Preference::values),
                beliefs: [copy(0), copy(1)],
                choice: self.best(&posterior, other),
                posterior,
            }
        })
    }

    fn posterior(
        &self,
        model: &crate::inference::Model,
        beliefs: &Beliefs<STATES, 2>,
        sequences: [&[Policy]; 2],
    ) -> [f32; JOINT] {
        let values = self.preferences.each_ref().map(Preference::values);
        let problem = Problem {
            preferences: &values.each_ref().map(|values| &values[..]),
            ..Problem::new(
                model,
                beliefs,
                Candidates::all(&sequences),
                Scoring { precision: self.preset.precision, ..Scoring::DEFAULT },
            )
        };
        let mut evaluation = Evaluation::<STATES, 2, STATES, STATES>::new();
        let _ = evaluation.evaluate(&problem);
        let posterior = evaluation.posterior();
        core::array::from_fn(|policy| at_or_zero(posterior.as_flattened(), policy))
    }

    /// The best of the joint policies in which the teammate does what it has announced; the first of equals.
    fn best(&self, posterior: &[f32; JOINT], other: usize) -> Joint {
        let mut best = (Joint([Deed::Idle; 2]), f32::NEG_INFINITY);
        for (number, &p) in posterior.iter().enumerate() {
            let Some(joint) = Joint::of(number) else { continue };
            let fits = self.teammate.is_none_or(|said| said.deed == joint.deed(other));
            if fits && p > best.1 {
                best = (joint, p);
            }
        }
        best.0
    }
}

fn at_or_zero(list: &[f32], at: usize) -> f32 {
    list.get(at).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The posterior for the preferences of equations 10 to 12.
    fn posterior(preset: Preset, rows: [[f32; STATES]; 2], placer: Option<usize>) -> [f32; JOINT] {
        let preferences = rows.map(Preference::new);
        let states = [0.0, 0.0, 0.0, 1.0];
        let question = Question { preset, own: 0, states, teammate: None, preferences: &preferences, placer };
        question.decide().unwrap().posterior
    }

    const FREE: [f32; STATES] = [0.0, 0.0, 0.0, 1.0];
    const HOLD: [f32; STATES] = [0.0, 1.0, 0.0, 0.0];
    const LOC_HOLD: [f32; STATES] = [2.0, 1.0, 0.0, 0.0];

    /// The four probabilities that section 6.2 reports.
    fn reported(preset: Preset) -> [f32; 4] {
        let of = |rows, policy: usize| posterior(preset, rows, None)[policy];
        [of([LOC_HOLD, FREE], 3), of([HOLD, FREE], 7), of([FREE, LOC_HOLD], 12), of([FREE, HOLD], 13)]
    }

    #[test]
    fn the_default_is_within_five_thousandths_of_the_reported_probabilities() {
        for (ours, published) in reported(Preset::DEFAULT).into_iter().zip([0.255, 0.205, 0.255, 0.205]) {
            assert!((ours - published).abs() < 0.005, "{ours} against {published}");
        }
    }

    #[test]
    fn the_calibrated_preset_is_within_a_thousandth_of_the_reported_probabilities() {
        for (ours, published) in reported(Preset::CALIBRATED).into_iter().zip([0.255, 0.205, 0.255, 0.205]) {
            assert!((ours - published).abs() < 0.001, "{ours} against {published}");
        }
    }

    #[test]
    fn the_posterior_equals_its_closed_form() {
        // exp(γ (diag - off) C) per robot, normalised: every column of A has one entropy, and the state is certain.
        let preset = Preset::DEFAULT;
        let x = preset.precision * (preset.sensor - (1.0 - preset.sensor) / 3.0);
        let e = crate::math::exp(x);
        let expected = e * e / (e * e + e + 2.0) * e / (e + 3.0);
        assert!((posterior(preset, [LOC_HOLD, FREE], None)[3] - expected).abs() < 1e-6);
    }

    #[test]
    fn success_is_wanted_only_where_it_can_be_reached() {
        let rows = [[0.0, 0.0, 1.0, 0.0], FREE];
        let before = posterior(Preset::DEFAULT, rows, None);
        let placing = posterior(Preset::DEFAULT, rows, Some(0));
        assert_eq!(crate::math::argmax(&before), 11);
        assert_eq!(crate::math::argmax(&placing), 11);
        assert!(placing[11] > before[11] + 0.1, "{} {}", placing[11], before[11]);
        let mirrored = posterior(Preset::DEFAULT, [rows[1], rows[0]], Some(1));
        assert!((mirrored[14] - placing[11]).abs() < 1e-6);
    }
}
