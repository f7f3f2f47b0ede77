//! Behavior tree files.

mod census;
mod check;
mod diagnostic;
mod document;
mod export;
mod instance;
pub mod library;
mod lower;
mod model;
mod parameter;
mod scope;
mod script;
mod show;
mod structure;
mod value;
mod xml;

pub use census::Census;
pub use check::check;
pub use diagnostic::{Diagnostic, Place, Remarks, Severity};
pub use document::{Document, Extras, Files, LoadError};
pub use instance::Instance;
pub use model::{Class, Direction, Model, Port};
pub use value::ValueType;
