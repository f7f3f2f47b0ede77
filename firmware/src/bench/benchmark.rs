//! A benchmark: a model with a decision, and the agent that makes it.

use iibt_core::inference::{Agent, Candidates, Evidence, Model, OutOfRange, Scoring};

/// The joint policies of a benchmark.
pub const POLICIES: usize = 16;

/// One robot's candidates in a benchmark.
const CANDIDATES: usize = 4;

/// Two robots of `S` states each, who choose among 4 x 4 joint policies.
#[derive(Clone, Copy, Debug)]
pub struct Benchmark<const S: usize> {
    /// Its name.
    pub name: &'static str,
    /// The generative model.
    pub model: &'static Model<'static>,
    /// The candidates.
    pub candidates: &'static Candidates<'static>,
    /// The observations.
    pub observed: [Evidence<'static>; 3],
}

/// The agent that a benchmark is run by.
pub type Workspace<const S: usize> = Agent<'static, S, 2, CANDIDATES, CANDIDATES>;

impl<const S: usize> Benchmark<S> {
    /// An agent that has observed nothing.
    ///
    /// # Errors
    /// [`OutOfRange`] when `S` does not fit the model.
    pub fn agent(&self, scoring: Scoring) -> Result<Workspace<S>, OutOfRange> {
        Ok(Workspace::try_new(self.model)?.with_scoring(scoring))
    }

    /// One belief update and the posterior over the policies; `None` when something does not fit
    /// the model, or the observation has probability zero, which is not so for the benchmarks.
    pub fn run(&self, agent: &mut Workspace<S>) -> Option<[f32; POLICIES]> {
        agent.reset();
        agent.observe(&self.observed).ok()?;
        agent.decide(*self.candidates).ok()?;
        agent.posterior().try_into().ok()
    }
}
