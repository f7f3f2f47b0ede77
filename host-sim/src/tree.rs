//! Behavior tree files.

mod alarm;
mod blackboard;
mod census;
mod check;
mod codegen;
mod diagnostic;
mod document;
mod dry_run;
mod export;
mod instance;
pub mod library;
mod log;
mod lower;
mod model;
mod parameter;
mod player;
mod scope;
mod script;
mod show;
mod statuses;
mod structure;
mod timeline;
mod value;
mod xml;

pub use census::Census;
pub use check::check;
pub use diagnostic::{Diagnostic, Place, Remarks, Severity};
pub use document::{Document, Extras, Files, LoadError};
pub use dry_run::{DryRecord, DryRun, Mode};
pub use instance::Instance;
pub use model::{Class, Direction, Model, Port};
pub use statuses::Statuses;
pub use value::ValueType;
