//! The generative model: hidden factors, how they change, and what can be observed of them.

use super::evidence::Evidence;
use super::likelihood::Likelihood;
use super::shape::{MAX_CONDITIONS, Shape};
use super::transition::Transition;
use crate::actions::Action;
use crate::math;

/// The most hidden factors of one model.
pub const MAX_FACTORS: usize = 16;

/// The most modalities of one model.
pub const MAX_MODALITIES: usize = 40;

/// A hidden factor: its transition B, its prior D, and what acts on it.
#[derive(Clone, Copy)]
pub struct Factor<'a> {
    transition: &'a dyn Transition,
    shape: Shape,
    coupled_to: &'a [usize],
    control: Control,
    prior: &'a [f32],
}

/// Which of a joint policy's action sequences moves a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Control {
    /// The one with the factor's own number.
    Own,
    /// The one with this number, which may move other factors as well.
    Shared(u8),
    /// None: the factor changes by itself, by action zero, in every step.
    None,
}

impl<'a> Factor<'a> {
    /// A factor that changes by itself and by its own action: `shape` is the transition's.
    ///
    /// # Panics
    /// When `prior` is no distribution over the factor's states; in a `const` or `static` this fails the build.
    #[must_use]
    pub const fn new(transition: &'a dyn Transition, shape: Shape, prior: &'a [f32]) -> Self {
        assert!(prior.len() == shape.values(), "D, the prior, does not have an entry per state");
        assert!(math::is_distribution(prior), "D, the prior, is no distribution");
        Self { transition, shape, coupled_to: &[], control: Control::Own, prior }
    }

    /// The same for a prior that is only known at run time; `None` when it is no distribution over the factor's states.
    #[must_use]
    pub const fn try_new(transition: &'a dyn Transition, shape: Shape, prior: &'a [f32]) -> Option<Self> {
        if prior.len() == shape.values() && math::is_distribution(prior) {
            Some(Self { transition, shape, coupled_to: &[], control: Control::Own, prior })
        } else {
            None
        }
    }

    /// The same for a prior that is sound by its making.
    pub(crate) const fn trusted(transition: &'a dyn Transition, shape: Shape, prior: &'a [f32]) -> Self {
        Self { transition, shape, coupled_to: &[], control: Control::Own, prior }
    }

    /// The same factor, its transition conditioned on other factors as well, in the order of the shape's further
    /// conditions: the blocks B^ij.
    #[must_use]
    pub const fn coupled_to(mut self, factors: &'a [usize]) -> Self {
        self.coupled_to = factors;
        self
    }

    /// The same factor, moved by another action sequence or by none.
    #[must_use]
    pub const fn controlled_by(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// P(s' = `next` | `states`, u = `action`), with a state for the factor itself and each that it is coupled to.
    #[must_use]
    pub fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        self.transition.probability(action, next, states)
    }

    /// How many states it has.
    #[must_use]
    pub const fn states(&self) -> usize {
        self.shape.values()
    }
}

/// A modality: its likelihood A, the factors that it depends on, and the preference C over its outcomes.
#[derive(Clone, Copy)]
pub struct Modality<'a> {
    likelihood: &'a dyn Likelihood,
    shape: Shape,
    factors: &'a [usize],
    preference: &'a [f32],
}

impl<'a> Modality<'a> {
    /// A modality that depends on `factors`, one for each condition of `shape`, which is the likelihood's. `preference` is C
    /// on a log scale: P(o) = softmax(C).
    ///
    /// # Panics
    /// When the numbers of factors or preferences do not fit the shape, or a preference is not finite; in a `const` or
    /// `static` this fails the build.
    #[must_use]
    pub const fn new(
        likelihood: &'a dyn Likelihood,
        shape: Shape,
        factors: &'a [usize],
        preference: &'a [f32],
    ) -> Self {
        assert!(factors.len() == shape.conditions(), "A, the likelihood, needs a factor for each condition");
        assert!(preference.len() == shape.values(), "C, the preference, does not have an entry per outcome");
        assert!(all_finite(preference), "C, the preference, has a value that is not finite");
        Self { likelihood, shape, factors, preference }
    }

    /// The same for numbers that are only known at run time; `None` when they do not fit.
    #[must_use]
    pub const fn try_new(
        likelihood: &'a dyn Likelihood,
        shape: Shape,
        factors: &'a [usize],
        preference: &'a [f32],
    ) -> Option<Self> {
        let fits = factors.len() == shape.conditions() && preference.len() == shape.values();
        if fits && all_finite(preference) {
            Some(Self { likelihood, shape, factors, preference })
        } else {
            None
        }
    }

    /// The same for numbers that fit by their making.
    pub(crate) const fn trusted(
        likelihood: &'a dyn Likelihood,
        shape: Shape,
        factors: &'a [usize],
        preference: &'a [f32],
    ) -> Self {
        Self { likelihood, shape, factors, preference }
    }

    /// A: how the outcomes depend on the states.
    #[must_use]
    pub const fn likelihood(&self) -> &'a dyn Likelihood {
        self.likelihood
    }

    /// Outcomes and states.
    #[must_use]
    pub const fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The factors that it depends on.
    #[must_use]
    pub const fn factors(&self) -> &'a [usize] {
        self.factors
    }

    /// P(e | s) for the states that all factors of the model have now.
    pub(super) fn probability(&self, evidence: Evidence, now: &[usize]) -> f32 {
        let mut states = [0; MAX_CONDITIONS];
        for (state, &factor) in states.iter_mut().zip(self.factors) {
            *state = now.get(factor).copied().unwrap_or(0);
        }
        let states = states.get(..self.factors.len()).unwrap_or(&[]);
        evidence.probability(self.shape.values(), |outcome| self.likelihood.probability(outcome, states))
    }

    /// C to begin with.
    #[must_use]
    pub const fn preference(&self) -> &'a [f32] {
        self.preference
    }
}

/// P(o, s | π) = Π_f D_f(s_1) Π_τ Π_m A_m(o_τ | s_τ) Π_f B_f(s_τ | s_τ-1, π), with the preferences C (the paper's equation 1,
/// its blocks written as factors and modalities).
///
/// A model never changes after it is built: put it in a `static` and it stays in flash, checked by the compiler.
///
/// ```
/// use iibt_core::inference::{Beliefs, Evidence, Factor, IdentityNoise, Modality, Model, NextState};
///
/// // A corridor of three cells, a sensor that is right nine times in ten, two moves, a goal on the right.
/// static MOTION: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// static FACTORS: [Factor; 1] = [Factor::new(&MOTION, MOTION.shape(), &[0.8, 0.1, 0.1])];
/// static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 1.0])];
/// static CORRIDOR: Model = Model::new(&FACTORS, &MODALITIES);
///
/// let mut beliefs = Beliefs::<3, 1>::prior(&CORRIDOR);
/// let update = beliefs.update(&CORRIDOR, &[Evidence::Outcome(1)])?;
/// assert!(update.free_energy > 0.0 && beliefs.most_likely(&CORRIDOR, 0).0 == 1);
/// # Ok::<(), iibt_core::inference::Impossible>(())
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
    /// Where each factor's states begin in a flat list.
    offsets: [u16; MAX_FACTORS + 1],
    /// The group of each factor: factors that move together.
    groups: [u8; MAX_FACTORS],
    group_count: u8,
    controls: u8,
    /// The action sequences that move each group, a bit for each.
    moved_by: [u16; MAX_FACTORS],
    /// The groups that each modality depends on, a bit for each.
    scopes: [u16; MAX_MODALITIES],
}

/// What does not fit together in a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ModelError {
    /// This many factors: none, or more than [`MAX_FACTORS`], or more than 65,535 states in all.
    Factors(usize),
    /// This many modalities: none, or more than [`MAX_MODALITIES`].
    Modalities(usize),
    /// This modality names a factor that does not exist, or one twice.
    Dependency(usize),
    /// This modality's likelihood has another number of states than a factor that it depends on.
    Likelihood(usize),
    /// This factor's transition is coupled to a factor that does not exist, or does not have the states of those it
    /// is coupled to.
    Transition(usize),
}

impl<'a> Model<'a> {
    /// A model from its factors and modalities.
    ///
    /// # Panics
    /// When they do not fit together, see [`ModelError`]; in a `const` or `static` this fails the build.
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

    /// The same for parts that are only known at run time.
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

    /// Numbers the groups in the order of their first factors: factors that are coupled in motion, or moved by the same
    /// actions, are in one.
    const fn find_groups(&mut self) {
        let mut grouped: u32 = 0;
        let mut factor = 0;
        while factor < self.factors.len() && factor < MAX_FACTORS {
            if let Some(control) = self.control(factor)
                && control >= self.controls as usize
            {
                self.controls = control as u8 + 1;
            }
            if grouped >> factor & 1 == 0 {
                let members = self.moved_with(1 << factor);
                self.assign_group(members);
                grouped |= members;
            }
            factor += 1;
        }
    }

    const fn assign_group(&mut self, members: u32) {
        let mut factor = 0;
        while factor < self.factors.len() && factor < MAX_FACTORS {
            if members >> factor & 1 == 1 {
                self.groups[factor] = self.group_count;
                if let Some(control) = self.control(factor)
                    && (self.group_count as usize) < MAX_FACTORS
                {
                    self.moved_by[self.group_count as usize] |= 1 << control;
                }
            }
            factor += 1;
        }
        self.group_count += 1;
    }

    const fn find_scopes(&mut self) {
        let mut modality = 0;
        while modality < self.modalities.len() && modality < MAX_MODALITIES {
            let factors = self.modalities[modality].factors;
            let mut at = 0;
            while at < factors.len() {
                if factors[at] < MAX_FACTORS {
                    self.scopes[modality] |= 1 << self.groups[factors[at]];
                }
                at += 1;
            }
            modality += 1;
        }
    }

    /// The factors that move together with `members`, themselves included, a bit for each.
    const fn moved_with(&self, mut members: u32) -> u32 {
        loop {
            let before = members;
            let mut first = 0;
            while first < self.factors.len() {
                let mut second = 0;
                while second < self.factors.len() {
                    let one = members >> first & 1 == 1 || members >> second & 1 == 1;
                    if one && self.move_together(first, second) {
                        members |= 1 << first | 1 << second;
                    }
                    second += 1;
                }
                first += 1;
            }
            if members == before {
                return members;
            }
        }
    }

    const fn move_together(&self, first: usize, second: usize) -> bool {
        let shared = match (self.control(first), self.control(second)) {
            (Some(one), Some(other)) => one == other,
            _ => false,
        };
        shared || (first < self.factors.len() && contains(self.factors[first].coupled_to, second))
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

    /// How many states all factors have together: the size of [`Beliefs`](super::Beliefs).
    #[must_use]
    pub const fn states(&self) -> usize {
        if self.factors.len() <= MAX_FACTORS { self.offsets[self.factors.len()] as usize } else { 0 }
    }

    /// How many action sequences a joint policy has.
    #[must_use]
    pub const fn controls(&self) -> usize {
        self.controls as usize
    }

    /// How many groups of factors there are that move independently of each other.
    #[must_use]
    pub const fn groups(&self) -> usize {
        self.group_count as usize
    }

    /// The group that an action sequence moves.
    pub(super) fn group_of_control(&self, control: usize) -> Option<usize> {
        (0..self.groups()).find(|&group| self.moved_by(group) >> control & 1 == 1)
    }

    /// The action sequences that move a group, a bit for each.
    pub(super) fn moved_by(&self, group: usize) -> u16 {
        self.moved_by.get(group).copied().unwrap_or(0)
    }

    /// A group's factors, a bit for each.
    pub(super) fn in_group(&self, group: usize) -> u32 {
        let numbered = self.groups.iter().take(self.factors.len()).enumerate();
        let members = numbered.filter(|(_, of)| usize::from(**of) == group);
        members.fold(0, |members, (factor, _)| members | 1 << factor)
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

    /// The same, to write to.
    #[inline]
    pub(super) fn part_mut<'b>(&self, flat: &'b mut [f32], factor: usize) -> &'b mut [f32] {
        match (self.offsets.get(factor), self.offsets.get(factor + 1)) {
            (Some(&from), Some(&to)) => flat.get_mut(usize::from(from)..usize::from(to)).unwrap_or(&mut []),
            _ => &mut [],
        }
    }

    /// The parts of `factors`, in their order; `MAX_CONDITIONS` at the most.
    #[inline]
    pub(super) fn parts<'b>(&self, flat: &'b [f32], factors: &[usize]) -> Parts<'b> {
        Parts::new(factors.iter().map(|&factor| self.part(flat, factor)))
    }

    /// One step of one factor: q(s') = Σ_s B_u(s', s) q(s), from the flat beliefs `from` into `to`. Returns how much the step
    /// will tell about the transition itself.
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
        Parts::new(factors.map(|factor| self.part(flat, factor)))
    }

    /// D of one factor.
    #[must_use]
    pub fn prior(&self, factor: usize) -> &'a [f32] {
        self.factors.get(factor).map_or(&[], |factor| factor.prior)
    }
}

/// A few slices of a flat list.
pub(super) struct Parts<'b> {
    count: usize,
    parts: [&'b [f32]; MAX_CONDITIONS],
}

impl<'b> Parts<'b> {
    #[inline]
    pub(super) fn new(parts: impl Iterator<Item = &'b [f32]>) -> Self {
        let mut new = Self { count: 0, parts: [&[]; MAX_CONDITIONS] };
        for (slot, part) in new.parts.iter_mut().zip(parts) {
            *slot = part;
            new.count += 1;
        }
        new
    }

    #[inline]
    pub(super) fn as_slice(&self) -> &[&'b [f32]] {
        self.parts.get(..self.count).unwrap_or(&[])
    }
}

impl Modality<'_> {
    const fn check(&self, number: usize, factors: &[Factor]) -> Result<(), ModelError> {
        let mut condition = 0;
        while condition < self.factors.len() {
            let factor = self.factors[condition];
            let (before, _) = self.factors.split_at(condition);
            if factor >= factors.len() || contains(before, factor) {
                return Err(ModelError::Dependency(number));
            }
            if factors[factor].states() != self.shape.states(condition) {
                return Err(ModelError::Likelihood(number));
            }
            condition += 1;
        }
        Ok(())
    }
}

impl Factor<'_> {
    const fn fits(&self, factors: &[Factor]) -> bool {
        let controlled = match self.control {
            Control::Shared(control) => (control as usize) < MAX_FACTORS,
            Control::Own | Control::None => true,
        };
        let conditions = self.shape.conditions() == 1 + self.coupled_to.len();
        if !controlled || !conditions || self.shape.states(0) != self.shape.values() {
            return false;
        }
        let mut at = 0;
        while at < self.coupled_to.len() {
            let factor = self.coupled_to[at];
            if factor >= factors.len() || factors[factor].states() != self.shape.states(at + 1) {
                return false;
            }
            at += 1;
        }
        true
    }
}

const fn all_finite(values: &[f32]) -> bool {
    let mut at = 0;
    while at < values.len() {
        if !values[at].is_finite() {
            return false;
        }
        at += 1;
    }
    true
}

const fn contains(list: &[usize], wanted: usize) -> bool {
    let mut at = 0;
    while at < list.len() {
        if list[at] == wanted {
            return true;
        }
        at += 1;
    }
    false
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

impl core::fmt::Display for ModelError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Factors(count) => {
                write!(f, "{count} factors: a model has 1 to {MAX_FACTORS}, of 65,535 states in all")
            }
            Self::Modalities(count) => write!(f, "{count} modalities: a model has 1 to {MAX_MODALITIES}"),
            Self::Dependency(modality) => {
                write!(f, "modality {modality} depends on a factor that does not exist, or on one twice")
            }
            Self::Likelihood(modality) => {
                write!(f, "A[{modality}], the likelihood, does not have the states of its factors")
            }
            Self::Transition(factor) => {
                write!(f, "B[{factor}], the transition, does not have the states of its factors")
            }
        }
    }
}

impl core::error::Error for ModelError {}
