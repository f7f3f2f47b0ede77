//! Behavior trees in files: BehaviorTree.CPP's XML, version 4, as Groot2 edits it and Nav2 ships
//! it.
//!
//! ```text
//! XML ─► Document ─► Instance ─► table ─► run, code
//!           │            └─► text, graph, counts, logs, pages
//!           └─► XML
//! ```
//!
//! A [`Document`] is a file with all that it includes: trees, models of nodes, and remarks on its
//! structure. An [`Instance`] is one of its trees, every SubTree in its place and every port
//! resolved. It becomes the table of [`iibt_core::tree`](mod@iibt_core::tree), so a dry run ticks
//! the engine that firmware ticks, and [`codegen`](Instance::codegen) writes the table that
//! firmware keeps in flash.
//!
//! | what a file has | [`check`](fn@check) | [`run`](DryRun) | [`codegen`](Instance::codegen) |
//! |---|---|---|---|
//! | nodes of BehaviorTree.CPP 4.10 | yes | yes, but those below | yes, but those below |
//! | `PipelineSequence`, `RoundRobin`, `RecoveryNode`, `RateController` of Nav2 | yes | yes | yes |
//! | `TryCatch`, `WaitValueUpdate`, `Loop*` | yes | refused | refused |
//! | `SkipUnlessUpdated`, `WasEntryUpdated` | yes | refused | refused |
//! | `<include>`, several trees, SubTrees with ports | yes | yes | yes |
//! | `<include ros_pkg>` | refused | refused | refused |
//! | leaves of your own, from `<TreeNodesModel>` | yes | scripted statuses | variants of an enum |
//! | control nodes and decorators of your own | yes | refused | refused |
//! | scripts: nodes, `Precondition`, `_while` | yes | run | questions to the program |
//! | `_skipIf`, `_failureIf`, `_successIf` | yes | run | on conditions, else refused |
//! | `_onSuccess`, `_onFailure`, `_onHalted`, `_post` | yes | run | refused |
//! | parameters from the blackboard (`num_cycles="{n}"`) | yes | refused | refused |
//! | the same given by a SubTree's attribute, as a constant | yes | yes | yes |
//!
//! What is refused is refused with its place; nothing is ignored. Beyond BehaviorTree.CPP there are
//! limits: 32,768 nodes and 256 levels with all SubTrees, 500 levels of XML, 255 children of a
//! node.
//!
//! ```
//! use host_sim::tree::{self, Document, DryRun, Extras, Instance, Mode};
//!
//! let text = r#"<root BTCPP_format="4"><BehaviorTree ID="Main">
//!   <Fallback><L name="door" s="F"/><L name="window" s="RS"/></Fallback>
//! </BehaviorTree></root>"#;
//! let document = Document::parse("house.xml", text, &Extras::default())?;
//! assert!(tree::check(&document, None).is_empty());
//! let instance = Instance::of(&document, "Main").expect("it was checked");
//! let run = DryRun {
//!     ticks: 2,
//!     mode: Mode::ExactlyOnce,
//!     tick_ms: 10,
//!     leaves: &[],
//!     halt_after: None,
//!     compat: false,
//! };
//! let expected = "tick 1: door:F window:R => RUNNING\ntick 2: window:S => SUCCESS\n";
//! assert_eq!(run.run(&instance)?.text, expected);
//! # Ok::<(), host_sim::tree::Diagnostic>(())
//! ```

mod binding;
mod blackboard;
mod check;
mod codegen;
mod counts;
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
mod recorded;
mod records;
mod replay;
mod scope;
mod script;
mod show;
mod statuses;
mod structure;
mod timeline;
mod timers;
mod value;
mod xml;

pub use binding::{BoundTree, LeafNode};
pub use check::check;
pub use counts::KindCounts;
pub use diagnostic::{Diagnostic, Place, Remarks, Severity};
pub use document::{Document, Extras, Files, LoadError};
pub use dry_run::{DryRecord, DryRun, Mode};
pub use instance::Instance;
pub use model::{Class, Direction, NodeModel, Port};
pub use recorded::RecordedTick;
pub use replay::{DrawnTick, Replay};
pub(crate) use show::Line;
pub use statuses::Statuses;
pub use value::ValueType;
