//! The decision of one robot or of a team.

use crate::actions::Action;
use crate::inference::candidates::{Candidates, JointPolicy};
use crate::inference::model::MAX_FACTORS;

/// The most probable of all joint policies, for one robot or for a team.
///
/// It is exact: every joint policy was weighed. A teammate that has announced its policy is held to
/// it with [`Candidates::with_announced`](super::super::Candidates::with_announced), or by a list
/// of one.
///
/// ```
/// use iibt_core::agent;
/// use iibt_core::inference::{
///     Candidates, Factor, IdentityNoise, Modality, Model, NextState, OutcomeTable, Policy,
/// };
///
/// // Two robots at two doors: an action leads to a door. They want one robot at each.
/// static GO: NextState = NextState::new(&[0, 0, 1, 1], 2);
/// static APART: OutcomeTable =
///     OutcomeTable::new(&[&[0, 1], &[0, 1]], &[0, 1, 1, 0], &[1.0, 0.0, 0.0, 1.0], 2);
/// static FACTORS: [Factor; 2] = [Factor::new(&GO, GO.shape(), &[1.0, 0.0]); 2];
/// static MODALITIES: [Modality; 1] = [Modality::new(&APART, APART.shape(), &[0, 1], &[0.0, 1.0])];
/// static TEAM: Model = Model::new(&FACTORS, &MODALITIES);
/// static DOORS: [Policy; 2] = [Policy::of(&[0]), Policy::of(&[1])];
///
/// let mut team = agent!(TEAM, 2);
/// let decision = team.decide(Candidates::all(&[&DOORS, &DOORS]))?;
/// // Robot 0 at door 0 and robot 1 at door 1, or the other way round: equals, of which the first
/// // is taken.
/// assert_eq!((decision.sequence(0), decision.sequence(1)), (0, 1));
/// assert!((decision.probability() - 0.5).abs() < 1e-6 && team.posterior().len() == 4);
///
/// // The teammate has announced that it goes to door 0.
/// let announced = [None, Some(0)];
/// let decision = team.decide(Candidates::all(&[&DOORS, &DOORS]).with_announced(&announced))?;
/// assert_eq!((decision.sequence(0), decision.sequence(1)), (1, 0));
/// assert_eq!(decision.first_actions(), [Some(1), Some(0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    policy: usize,
    probability: f32,
    sequences: JointPolicy,
    first: [Option<Action>; MAX_FACTORS],
    controls: usize,
}

impl Decision {
    pub(super) fn new(candidates: &Candidates, controls: usize, policy: usize, probability: f32) -> Self {
        let sequences = candidates.row(policy);
        let mut first = [None; MAX_FACTORS];
        for (control, action) in first.iter_mut().enumerate().take(controls) {
            *action = candidates.policy(control, sequences.get(control)).get(0);
        }
        Self { policy, probability, sequences, first, controls }
    }

    /// The number of the most probable joint policy; the first of equals.
    #[must_use]
    pub const fn policy(&self) -> usize {
        self.policy
    }

    /// The posterior probability of the chosen joint policy.
    #[must_use]
    pub const fn probability(&self) -> f32 {
        self.probability
    }

    /// The number of the action sequence that the chosen joint policy has for a control; zero for a
    /// control that stays.
    #[must_use]
    pub fn sequence(&self, control: usize) -> usize {
        self.sequences.get(control)
    }

    /// The first action of each control, `None` for one that stays, as
    /// [`Agent::act`](super::Agent::act) takes it.
    #[must_use]
    pub fn first_actions(&self) -> &[Option<Action>] {
        self.first.get(..self.controls).unwrap_or(&[])
    }
}
