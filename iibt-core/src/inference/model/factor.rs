//! A hidden factor.

use crate::actions::Action;
use crate::inference::model::MAX_FACTORS;
use crate::inference::shape::Shape;
use crate::inference::transition::Transition;
use crate::math;

/// A hidden factor: its transition B, its prior D, and its control.
///
/// ```
/// use iibt_core::inference::{Control, Factor, NextState};
///
/// // A lamp that an action switches on or off, and that stays as it is when the switch fails.
/// static SWITCH: NextState = NextState::with_slip(&[1, 1, 0, 0], 2, 0.1);
/// static LAMP: Factor = Factor::new(&SWITCH, SWITCH.shape(), &[0.5, 0.5]);
/// assert_eq!(LAMP.states(), 2);
/// assert_eq!(LAMP.probability(0, 1, &[0]), 0.9); // switched on
/// assert_eq!(LAMP.probability(0, 0, &[0]), 0.1); // the switch failed
///
/// // A prior that is only known at run time.
/// assert!(Factor::try_new(&SWITCH, SWITCH.shape(), &[0.5, 0.4]).is_none());
/// // A lamp that changes by itself.
/// let other = LAMP.controlled_by(Control::None);
/// assert_eq!(other.states(), 2);
/// ```
#[doc(alias = "hidden state")]
#[doc(alias = "state factor")]
#[derive(Clone, Copy)]
pub struct Factor<'a> {
    pub(super) transition: &'a dyn Transition,
    pub(super) shape: Shape,
    pub(super) coupled_to: &'a [usize],
    pub(super) control: Control,
    pub(super) prior: &'a [f32],
}

/// The action sequence of a joint policy that moves a factor.
///
/// ```
/// use iibt_core::inference::{Control, Factor, IdentityNoise, Modality, Model, NextState};
///
/// static TURN: NextState = NextState::new(&[0, 1, 1, 0], 2);
/// static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
/// // Two wheels on one axle, and a door that no action moves.
/// static FACTORS: [Factor; 3] = [
///     Factor::new(&TURN, TURN.shape(), &[0.5, 0.5]),
///     Factor::new(&TURN, TURN.shape(), &[0.5, 0.5]).controlled_by(Control::Shared(0)),
///     Factor::new(&TURN, TURN.shape(), &[0.5, 0.5]).controlled_by(Control::None),
/// ];
/// static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[2], &[0.0, 0.0])];
/// static CART: Model = Model::new(&FACTORS, &MODALITIES);
/// assert_eq!(CART.controls(), 1); // one action sequence moves both wheels
/// assert_eq!(CART.groups(), 2); // the wheels move together, the door apart
/// assert_eq!(CART.actions(0), 2);
/// ```
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
    /// When `prior` is no distribution over the factor's states; in a `const` or `static` this
    /// fails the build.
    #[must_use]
    pub const fn new(transition: &'a dyn Transition, shape: Shape, prior: &'a [f32]) -> Self {
        assert!(prior.len() == shape.values(), "D, the prior, does not have an entry per state");
        assert!(math::is_distribution(prior), "D, the prior, is no distribution");
        Self::trusted(transition, shape, prior)
    }

    /// Builds a factor with a prior that is only known at run time; `None` when it is no
    /// distribution over the factor's states.
    #[must_use]
    pub const fn try_new(transition: &'a dyn Transition, shape: Shape, prior: &'a [f32]) -> Option<Self> {
        if prior.len() == shape.values() && math::is_distribution(prior) {
            Some(Self::trusted(transition, shape, prior))
        } else {
            None
        }
    }

    /// Builds a factor with a prior that is valid by construction.
    const fn trusted(transition: &'a dyn Transition, shape: Shape, prior: &'a [f32]) -> Self {
        Self { transition, shape, coupled_to: &[], control: Control::Own, prior }
    }

    /// Couples the factor's transition to other factors, in the order of the shape's further
    /// conditions: the blocks B^ij.
    #[must_use]
    pub const fn coupled_to(mut self, factors: &'a [usize]) -> Self {
        self.coupled_to = factors;
        self
    }

    /// Sets the action sequence that moves the factor.
    #[must_use]
    pub const fn controlled_by(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// P(s' = `next` | `states`, u = `action`), with a state for the factor itself and each that it
    /// is coupled to.
    #[must_use]
    pub fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        self.transition.probability(action, next, states)
    }

    /// The number of its states.
    #[must_use]
    pub const fn states(&self) -> usize {
        self.shape.values()
    }
}

impl Factor<'_> {
    pub(super) const fn fits(&self, factors: &[Factor]) -> bool {
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
