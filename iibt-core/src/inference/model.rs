//! The generative model: hidden factors, their transitions, and the modalities through which they
//! are observed.

mod error;
mod factor;
mod groups;
mod members;
mod modality;

pub use error::ModelError;
pub use factor::{Control, Factor};
pub(super) use members::{Members, Product};
pub use modality::Modality;

use super::error::{Argument, OutOfRange, at_most};
use super::evidence::Evidence;
use super::shape::MAX_CONDITIONS;
use crate::actions::Action;
use crate::bounded::up_to;

/// Parts of a flat list of beliefs: no table has more conditions.
pub(super) type Parts<'b> = heapless::Vec<&'b [f32], MAX_CONDITIONS>;

/// The most hidden factors of one model.
pub const MAX_FACTORS: usize = 16;

/// The most modalities of one model.
pub const MAX_MODALITIES: usize = 40;

/// P(o, s | π) = Π_f D_f(s_1) Π_τ Π_m A_m(o_τ | s_τ) Π_f B_f(s_τ | s_τ-1, π), with the preferences
/// C (the paper's equation 1, its blocks written as factors and modalities).
///
/// A model never changes after it is built: put it in a `static` and it stays in flash, checked by
/// the compiler.
///
/// ```
/// use iibt_core::inference::{
///     Beliefs, Evidence, Factor, IdentityNoise, Modality, Model, NextState,
/// };
///
/// // A corridor of three cells, a sensor that is right nine times in ten, two moves, a goal on the
/// // right.
/// static MOTION: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// static FACTORS: [Factor; 1] = [Factor::new(&MOTION, MOTION.shape(), &[0.8, 0.1, 0.1])];
/// static MODALITIES: [Modality; 1] =
///     [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 1.0])];
/// static CORRIDOR: Model = Model::new(&FACTORS, &MODALITIES);
///
/// let mut beliefs = Beliefs::<3, 1>::prior(&CORRIDOR);
/// let update = beliefs.update(&CORRIDOR, &[Evidence::Outcome(1)])?;
/// assert!(update.free_energy > 0.0 && beliefs.most_likely(&CORRIDOR, 0)?.0 == 1);
/// # Ok::<(), iibt_core::inference::ObservationError>(())
/// ```
///
/// A prior that is no distribution fails the build:
///
/// ```compile_fail,E0080
/// use iibt_core::inference::{Factor, NextState};
///
/// static MOTION: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// static FACTORS: [Factor; 1] = [Factor::new(&MOTION, MOTION.shape(), &[0.8, 0.1, 0.2])];
/// # let _ = &FACTORS;
/// ```
#[derive(Clone, Copy)]
pub struct Model<'a> {
    factors: &'a [Factor<'a>],
    modalities: &'a [Modality<'a>],
    /// The offset of each factor's states in a flat list.
    offsets: [u16; MAX_FACTORS + 1],
    /// The group of each factor: factors that move together.
    groups: [u8; MAX_FACTORS],
    group_count: u8,
    controls: u8,
    /// The factors of each group, a bit for each.
    members: [u16; MAX_FACTORS],
    /// The action sequences that move each group, a bit for each.
    moved_by: [u16; MAX_FACTORS],
    /// The groups that each modality depends on, a bit for each.
    scopes: [u16; MAX_MODALITIES],
}

impl<'a> Model<'a> {
    /// A model from its factors and modalities.
    ///
    /// # Panics
    /// When they do not fit together, see [`ModelError`]; in a `const` or `static` this fails the
    /// build.
    #[must_use]
    pub const fn new(factors: &'a [Factor<'a>], modalities: &'a [Modality<'a>]) -> Self {
        match Self::try_new(factors, modalities) {
            Ok(model) => model,
            Err(ModelError::Factors(_)) => panic!("a model has no factors, or too many"),
            Err(ModelError::Modalities(_)) => panic!("a model has no modalities, or too many"),
            Err(ModelError::Dependency(_)) => {
                panic!("a modality depends on a factor that does not exist, or on one twice")
            }
            Err(ModelError::Likelihood(_)) => {
                panic!("A, the likelihood, does not have the states of its factors")
            }
            Err(ModelError::Transition(_)) => {
                panic!("B, the transition, does not have the states of its factors")
            }
        }
    }

    /// Builds a model from parts that are only known at run time.
    ///
    /// # Errors
    /// The first [`ModelError`] found.
    pub const fn try_new(
        factors: &'a [Factor<'a>],
        modalities: &'a [Modality<'a>],
    ) -> Result<Self, ModelError> {
        if factors.is_empty() || factors.len() > MAX_FACTORS {
            return Err(ModelError::Factors(factors.len()));
        }
        if modalities.is_empty() || modalities.len() > MAX_MODALITIES {
            return Err(ModelError::Modalities(modalities.len()));
        }
        let mut modality = 0;
        while modality < modalities.len() {
            if let Err(error) = modalities[modality].check(modality, factors) {
                return Err(error);
            }
            modality += 1;
        }
        let mut model = Self {
            factors,
            modalities,
            offsets: [0; MAX_FACTORS + 1],
            groups: [0; MAX_FACTORS],
            group_count: 0,
            controls: 0,
            members: [0; MAX_FACTORS],
            moved_by: [0; MAX_FACTORS],
            scopes: [0; MAX_MODALITIES],
        };
        let (mut factor, mut total) = (0, 0);
        while factor < factors.len() {
            if !factors[factor].fits(factors) {
                return Err(ModelError::Transition(factor));
            }
            total += factors[factor].states();
            if total > u16::MAX as usize {
                return Err(ModelError::Factors(factors.len()));
            }
            factor += 1;
            model.offsets[factor] = total as u16;
        }
        model.find_groups();
        model.find_scopes();
        Ok(model)
    }

    /// The action sequence that moves a factor.
    pub(super) const fn control(&self, factor: usize) -> Option<usize> {
        if factor >= self.factors.len() {
            return None;
        }
        match self.factors[factor].control {
            Control::Own => Some(factor),
            Control::Shared(control) => Some(control as usize),
            Control::None => None,
        }
    }

    /// The hidden factors.
    #[must_use]
    pub const fn factors(&self) -> &'a [Factor<'a>] {
        self.factors
    }

    /// The modalities.
    #[must_use]
    pub const fn modalities(&self) -> &'a [Modality<'a>] {
        self.modalities
    }

    /// The number of states of all factors together: the size of [`Beliefs`](super::Beliefs).
    #[must_use]
    pub const fn states(&self) -> usize {
        if self.factors.len() <= MAX_FACTORS { self.offsets[self.factors.len()] as usize } else { 0 }
    }

    /// The number of action sequences in a joint policy.
    #[must_use]
    pub const fn controls(&self) -> usize {
        self.controls as usize
    }

    /// The number of groups of factors that move independently of each other.
    #[must_use]
    pub const fn groups(&self) -> usize {
        self.group_count as usize
    }

    /// Every group, a bit for each.
    #[must_use]
    pub const fn all_groups(&self) -> u16 {
        (1_u32 << self.group_count).wrapping_sub(1) as u16
    }

    /// The action sequences that move a group, a bit for each.
    pub(super) const fn moved_by(&self, group: usize) -> u16 {
        if group < MAX_FACTORS { self.moved_by[group] } else { 0 }
    }

    /// A group's factors, a bit for each.
    pub(super) fn members_of(&self, group: usize) -> u32 {
        self.members.get(group).copied().map_or(0, u32::from)
    }

    /// The group of a factor; zero for one that does not exist.
    pub(super) fn group(&self, factor: usize) -> usize {
        self.groups.get(factor).copied().map_or(0, usize::from)
    }

    /// The groups that a modality depends on, a bit for each.
    pub(super) fn scope(&self, modality: usize) -> u16 {
        self.scopes.get(modality).copied().unwrap_or(0)
    }

    /// A factor's part of a flat list of states.
    #[inline]
    pub(super) fn part<'b>(&self, flat: &'b [f32], factor: usize) -> &'b [f32] {
        match (self.offsets.get(factor), self.offsets.get(factor + 1)) {
            (Some(&from), Some(&to)) => flat.get(usize::from(from)..usize::from(to)).unwrap_or(&[]),
            _ => &[],
        }
    }

    /// A factor's part of a flat list of states, mutably.
    #[inline]
    pub(super) fn part_mut<'b>(&self, flat: &'b mut [f32], factor: usize) -> &'b mut [f32] {
        match (self.offsets.get(factor), self.offsets.get(factor + 1)) {
            (Some(&from), Some(&to)) => flat.get_mut(usize::from(from)..usize::from(to)).unwrap_or(&mut []),
            _ => &mut [],
        }
    }

    /// The parts of the factors that a table is conditioned on, in their order.
    #[inline]
    pub(super) fn parts<'b>(&self, flat: &'b [f32], factors: &[usize]) -> Parts<'b> {
        up_to(factors.iter().map(|&factor| self.part(flat, factor)))
    }

    /// One step of one factor: q(s') = Σ_s B_u(s', s) q(s), from the flat beliefs `from` into `to`.
    /// Returns how much the step will tell about the transition itself.
    #[inline]
    pub(super) fn move_factor(&self, factor: usize, action: Action, from: &[f32], to: &mut [f32]) -> f32 {
        let Some(of) = self.factors.get(factor) else { return 0.0 };
        let step = |beliefs: &[&[f32]], to: &mut [f32]| {
            of.transition.predict(&of.shape, action, beliefs, to);
            of.transition.novelty(&of.shape, action, beliefs)
        };
        if of.coupled_to.is_empty() {
            step(&[self.part(from, factor)], to)
        } else {
            step(self.conditions(factor, from).as_slice(), to)
        }
    }

    /// The beliefs that a factor's transition is conditioned on, its own first.
    fn conditions<'b>(&self, factor: usize, flat: &'b [f32]) -> Parts<'b> {
        let others = self.factors.get(factor).map_or(&[][..], |of| of.coupled_to);
        let factors = core::iter::once(factor).chain(others.iter().copied());
        up_to(factors.map(|factor| self.part(flat, factor)))
    }

    /// The number of actions of a control: that of each factor that it moves.
    #[must_use]
    pub fn actions(&self, control: usize) -> usize {
        let factors = self.factors.iter().enumerate();
        let moved = factors.filter(|(factor, _)| self.control(*factor) == Some(control));
        moved.map(|(_, of)| usize::from(of.transition.actions())).min().unwrap_or(0)
    }

    /// Writes D of all factors, one after the other.
    pub(super) const fn write_prior(&self, flat: &mut [f32]) -> Result<(), OutOfRange> {
        if let Err(error) = self.check_room(flat.len()) {
            return Err(error);
        }
        let (mut rest, mut factor) = (flat, 0);
        while factor < self.factors.len() {
            let prior = self.factors[factor].prior;
            let Some((part, others)) = rest.split_at_mut_checked(prior.len()) else { break };
            part.copy_from_slice(prior);
            (rest, factor) = (others, factor + 1);
        }
        Ok(())
    }

    /// Whether `room` states are enough for all factors.
    pub(super) const fn check_room(&self, room: usize) -> Result<(), OutOfRange> {
        at_most(Argument::States, 0, self.states(), room)
    }

    /// Whether something can be observed through a modality.
    pub(super) fn check_evidence(&self, number: usize, evidence: &Evidence) -> Result<(), OutOfRange> {
        let count = self.modalities.len();
        let unknown = OutOfRange::new(Argument::Modality, 0, number, count);
        evidence.check(number, self.modalities.get(number).ok_or(unknown)?.shape().values())
    }

    /// Checks the evidence of the first modalities of the model, one after the other.
    pub(super) fn check_all_evidence(&self, evidence: &[Evidence]) -> Result<(), OutOfRange> {
        at_most(Argument::Evidence, 0, evidence.len(), self.modalities.len())?;
        let mut pairs = self.modalities.iter().zip(evidence).enumerate();
        pairs.try_for_each(|(number, (of, evidence))| evidence.check(number, of.shape().values()))
    }

    /// D of one factor.
    #[must_use]
    pub fn prior(&self, factor: usize) -> &'a [f32] {
        self.factors.get(factor).map_or(&[], |factor| factor.prior)
    }
}

impl core::fmt::Debug for Model<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Model")
            .field("factors", &self.factors.len())
            .field("modalities", &self.modalities.len())
            .field("states", &self.states())
            .finish()
    }
}
