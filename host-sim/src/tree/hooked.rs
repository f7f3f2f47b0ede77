//! A tree as a table whose leaves the caller provides.

use super::diagnostic::{Diagnostic, Place};
use super::instance::Instance;
use super::lower::{Rules, Task};
use iibt_core::tree::Node;

/// A tree lowered to the engine's table.
#[derive(Clone, Debug)]
pub struct Hooked {
    /// The table in preorder; a leaf is named by its place in `leaves`.
    pub rows: Vec<Node<u16>>,
    /// What the caller provides.
    pub leaves: Vec<Leaf>,
}

/// A leaf of the caller's own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// Its kind: its ID in the file.
    pub kind: String,
    /// Its name in the file, else its kind.
    pub name: String,
    /// The values of its ports, by name, in alphabetical order.
    pub ports: Vec<(String, String)>,
    /// Where it stands in the file.
    pub place: Place,
}

impl Leaf {
    /// The value of a port.
    #[must_use]
    pub fn port(&self, name: &str) -> Option<&str> {
        self.ports.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

impl Instance {
    /// The engine's table of a tree in which only leaves are left to the caller: no scripts, no switches.
    ///
    /// # Errors
    /// The first node that the engine does not have, or that is no leaf and needs a program.
    pub fn hooked(&self) -> Result<Hooked, Diagnostic> {
        let lowered = self.lower(Rules::Ours)?;
        let leaves = lowered.hooks.iter().filter_map(|hook| {
            let node = self.nodes.get(hook.node)?;
            Some(match hook.task {
                Task::Leaf => Ok(Leaf {
                    kind: node.id().to_owned(),
                    name: node.name.clone(),
                    ports: node
                        .ports
                        .iter()
                        .map(|(name, value)| (name.clone(), value.text.clone()))
                        .collect(),
                    place: node.place.clone(),
                }),
                _ => Err(Diagnostic::error(&node.place, format!("'{}' is more than a leaf", node.name))),
            })
        });
        let leaves = leaves.collect::<Result<_, _>>()?;
        Ok(Hooked { rows: lowered.rows, leaves })
    }
}
