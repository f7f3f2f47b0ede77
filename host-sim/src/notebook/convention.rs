//! The conventions of the tools whose models are read.

use super::sweeps::Sweeps;
use iibt_core::inference::{Scoring, Terms};

/// The convention for beliefs and expected free energies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Convention {
    /// Exact beliefs; the information gain is the sum of each modality's own
    #[default]
    Default,
    /// numpy pymdp 0.0.7: parallel sweeps, the information gain of all modalities at once, its
    /// floors under logarithms
    #[value(alias = "numpy-pymdp")]
    Joint,
    /// JAX pymdp 1.0: parallel sweeps, the information gain is the sum of each modality's own
    #[value(alias = "jax-pymdp")]
    PerModality,
    /// As `default`, with the sign of the ambiguity that the paper prints: G = risk - ambiguity
    AsPrinted,
}

/// The method of state inference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum BeliefMethod {
    /// Exactly while it fits the core's limit, else by coordinate ascent
    Exact,
    /// By coordinate ascent on the free energy
    Ascent,
    /// By the parallel sweeps of the convention's tool; exactly where these do not come to rest
    Sweeps,
}

impl Convention {
    /// The name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Joint => "joint",
            Self::PerModality => "per-modality",
            Self::AsPrinted => "as-printed",
        }
    }

    pub(super) const fn scoring(self) -> Scoring {
        match self {
            Self::Default | Self::PerModality | Self::AsPrinted => Scoring::JAX_PYMDP,
            Self::Joint => Scoring::NUMPY_PYMDP,
        }
    }

    /// G from its terms; lower is better.
    pub(super) fn expected_free_energy(self, terms: &Terms) -> f32 {
        match self {
            Self::AsPrinted => terms.risk() - terms.ambiguity - terms.novelty,
            _ => terms.expected_free_energy(),
        }
    }

    /// The method unless the caller asks for another.
    pub(super) const fn beliefs(self) -> BeliefMethod {
        match self {
            Self::Default | Self::AsPrinted => BeliefMethod::Exact,
            Self::Joint | Self::PerModality => BeliefMethod::Sweeps,
        }
    }

    pub(super) const fn sweeps(self) -> Sweeps {
        match self {
            Self::Joint => Sweeps::NUMPY_PYMDP,
            _ => Sweeps::JAX_PYMDP,
        }
    }
}
