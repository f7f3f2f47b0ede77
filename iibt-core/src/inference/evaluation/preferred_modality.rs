//! The expected terms of one modality under the preferences that count at a step.

use crate::inference::free_energy::{Gain, PreferenceTiming, Terms};
use crate::inference::model::{MAX_MODALITIES, Modality};
use crate::inference::problem::Problem;
use crate::math;

/// A modality and its preferences.
pub(in crate::inference) struct PreferredModality<'a> {
    pub(super) modality: &'a Modality<'a>,
    pub(super) on_arrival: bool,
    pub(super) joint: bool,
    pub(super) arriving: LogPreference<'a>,
    pub(super) under_way: LogPreference<'a>,
}

/// C, and ln Σ exp C.
#[derive(Clone, Copy)]
pub(super) struct LogPreference<'a> {
    pub(super) preference: &'a [f32],
    pub(super) normaliser: f32,
}

impl<'a> PreferredModality<'a> {
    pub(in crate::inference) fn new<const S: usize, const G: usize>(
        problem: &Problem<'a, S, G>,
        number: usize,
        modality: &'a Modality<'a>,
        normalisers: [f32; 2],
    ) -> Self {
        let [arriving, under_way] =
            [true, false].map(|arrives| problem.preference(number, modality, arrives));
        Self {
            modality,
            on_arrival: problem.scoring.timing == PreferenceTiming::OnArrival,
            joint: problem.scoring.gain == Gain::Joint,
            arriving: LogPreference { preference: arriving, normaliser: normalisers[0] },
            under_way: LogPreference { preference: under_way, normaliser: normalisers[1] },
        }
    }

    /// The terms under these beliefs, at a step at which a policy arrives or at another.
    pub(in crate::inference) fn expect(&self, beliefs: &[&[f32]], arrives: bool) -> Terms {
        let preference = if arrives { self.arriving } else { self.under_way };
        let (form, shape) = (self.modality.likelihood(), self.modality.shape());
        self.weigh_up(form.expect(shape, beliefs, preference.preference), preference.normaliser)
    }

    /// Terms as they count: with the preferences normalised, and without a gain that is found
    /// jointly.
    #[inline]
    pub(super) fn weigh_up(&self, expected: Terms, normaliser: f32) -> Terms {
        let information_gain = if self.joint { 0.0 } else { expected.information_gain };
        Terms { utility: expected.utility - normaliser, information_gain, ..expected }
    }
}

/// ln Σ exp C of each modality in scope: at a step at which a policy arrives, and at another.
pub(in crate::inference) type Normalisers = [[f32; 2]; MAX_MODALITIES];

pub(in crate::inference) fn normalisers<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
) -> Normalisers {
    let mut normalisers = [[0.0; 2]; MAX_MODALITIES];
    for (normalisers, (number, modality, _)) in normalisers.iter_mut().zip(problem.modalities()) {
        let arriving = math::log_sum_exp(problem.preference(number, modality, true));
        *normalisers = match problem.scoring.timing {
            PreferenceTiming::EveryStep => [arriving; 2],
            PreferenceTiming::OnArrival => {
                [arriving, math::log_sum_exp(problem.preference(number, modality, false))]
            }
        };
    }
    normalisers
}
