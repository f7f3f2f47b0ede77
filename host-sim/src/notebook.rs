//! From a notebook to flash: a model as JSON, run through the core or written as Rust source.
//!
//! ```text
//! JSON ─► Notebook ─┬─ infer ─► InferenceReport      beliefs, expected free energies, a decision
//!                   └─ to_rust ─► source    tables for the firmware
//! ```

mod assembly;
mod choices;
mod convention;
mod entries;
mod fault;
mod json;
mod model;
mod numpy;
mod observations;
mod observing;
mod policies;
mod reading;
mod report;
mod running;
mod source;
mod structure;
mod sweeps;
mod tally;
mod tensor;

pub use convention::{BeliefMethod, Convention};
pub use model::Notebook;
pub use report::{
    InferenceOutcome, InferenceReport, PolicyReport, StepReport, StructureReport, TermsReport, Why,
};
pub use running::{InferenceProgress, InferenceRun};
pub use structure::Forms;
pub use sweeps::{ProbabilityFloor, Sweeps};

use crate::input::FileError;

impl Notebook {
    /// Reads a model from JSON. `file` is what errors call it.
    ///
    /// # Errors
    /// A [`FileError`] that names what is wrong and where.
    pub fn read(file: &str, text: &[u8]) -> Result<Self, FileError> {
        json::read(text).and_then(|value| reading::model(file, &value)).map_err(|fault| fault.in_file(file))
    }

    /// Replaces the observations of the file by one: for each modality an outcome, null or a list
    /// of weights, as the entries of a JSON list, with or without its brackets.
    ///
    /// # Errors
    /// A [`FileError`] that names what is wrong and where.
    pub fn observing(mut self, text: &str) -> Result<Self, FileError> {
        let read = |text: &str| observations::observation(&json::read(text.as_bytes())?, "obs", &self);
        let bare = read(&format!("[{text}]"));
        let observation = bare.or_else(|fault| read(text).map_err(|_| fault));
        self.observations = model::Observations::Once(observation.map_err(|fault| fault.in_file("--obs"))?);
        Ok(self)
    }

    /// Replaces the precision γ.
    ///
    /// # Errors
    /// A [`FileError`] when it is negative, too large or no number.
    pub fn with_precision(mut self, gamma: f64) -> Result<Self, FileError> {
        self.precision = reading::precision(gamma).map_err(|fault| fault.in_file("--gamma"))?;
        Ok(self)
    }
}
