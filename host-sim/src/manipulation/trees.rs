//! The trees that the robots run: their files and sizes.

use super::tables::TEAM;
use super::terms::Trees;
use crate::tree::{BoundTree, Diagnostic, Instance, LeafNode, library};
use serde::Serialize;

/// The size of a robot's tree, as the paper's tables 6 and 7 count.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TreeSize {
    /// The name of the file, for `host-sim tree show`.
    pub name: &'static str,
    /// The robot that runs it, 1 or 2.
    pub robot: usize,
    /// Sequences, reactive ones included.
    pub sequences: usize,
    /// Fallbacks, reactive ones included.
    pub fallbacks: usize,
    /// Conditions.
    pub conditions: usize,
    /// Actions, inference nodes included.
    pub actions: usize,
    /// All nodes.
    pub nodes: usize,
    /// The levels, the root being the first.
    pub depth: usize,
}

impl Trees {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Inference, Self::Conventional, Self::Table6, Self::AsDrawn];

    /// The files of robot 1's and robot 2's tree.
    #[must_use]
    pub const fn files(self) -> [&'static str; TEAM] {
        match self {
            Self::Inference => ["figure-14-left", "figure-14-right"],
            Self::Conventional => ["bottle-conventional", "plate-conventional"],
            Self::Table6 => ["table-6-conventional", "plate-conventional"],
            Self::AsDrawn => ["figure-14-left-classical", "figure-14-right-classical"],
        }
    }

    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inference => "inference",
            Self::Conventional => "conventional",
            Self::Table6 => "table-6",
            Self::AsDrawn => "as-drawn",
        }
    }

    /// The sizes of the two trees.
    #[must_use]
    pub fn sizes(self) -> [TreeSize; TEAM] {
        [0, 1].map(|robot| size(self.files()[robot], robot))
    }

    /// The trees, bound to the leaves that the robots have by these names.
    pub(super) fn bind<L: Clone>(
        self,
        leaf: impl Fn(&LeafNode, usize) -> Result<L, String>,
    ) -> Result<[BoundTree<L>; TEAM], Diagnostic> {
        let [first, second] = self.files();
        Ok([instance(first)?.bind(|node| leaf(node, 0))?, instance(second)?.bind(|node| leaf(node, 1))?])
    }
}

/// The built-in tree of a file; a test holds that all are sound.
fn instance(name: &'static str) -> Result<Instance, Diagnostic> {
    library::instance(name).unwrap_or_else(|| unreachable!("{name} is built in"))
}

fn size(name: &'static str, robot: usize) -> TreeSize {
    let counts = instance(name).map(|instance| instance.counts()).unwrap_or_default();
    let kinds = |end: &str| counts.kinds.iter().filter(|(kind, _)| kind.ends_with(end)).map(|(_, n)| n).sum();
    let class = |class: &str| counts.classes.get(class).copied().unwrap_or(0);
    TreeSize {
        name,
        robot: robot + 1,
        sequences: kinds("Sequence"),
        fallbacks: kinds("Fallback"),
        conditions: class("Condition"),
        actions: class("Action"),
        nodes: counts.nodes(),
        depth: counts.depth(),
    }
}
