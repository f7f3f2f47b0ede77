//! A tree from a file that runs in a program: its leaves bound by name to the program's own.

use super::diagnostic::Diagnostic;
use super::hooked::Leaf;
use super::instance::Instance;
use iibt_core::time::Instant;
use iibt_core::tree::{NodeMemory, Full, Halt, Leaves, Node as Kind, Row, Status, TreeRef};

/// A tree whose leaves are the program's `L`, with its memory.
#[derive(Clone, Debug)]
pub struct Bound<L> {
    rows: Vec<Row<u16>>,
    memory: Vec<NodeMemory<Full>>,
    /// For each hook of the table, the leaf it stands for.
    leaves: Vec<L>,
}

impl Instance {
    /// Binds the leaves of this tree: `find` says which of the program's leaves each stands for, or why none does.
    ///
    /// # Errors
    /// The place of the first leaf for which there is none, of the first script, or of the first node that the engine does not
    /// have.
    pub fn bind<L>(&self, find: impl Fn(&Leaf) -> Result<L, String>) -> Result<Bound<L>, Diagnostic> {
        let hooked = self.hooked()?;
        let one = |leaf: &Leaf| find(leaf).map_err(|reason| Diagnostic::error(&leaf.place, reason));
        Ok(Bound {
            memory: hooked.rows.iter().map(|_| NodeMemory::NEW).collect(),
            rows: hooked.rows.into_iter().map(Row::new).collect(),
            leaves: hooked.leaves.iter().map(one).collect::<Result<_, _>>()?,
        })
    }
}

impl<L> Bound<L> {
    /// Ticks the tree once.
    pub fn tick<V: Leaves<L> + ?Sized>(&mut self, leaves: &mut V, now: Instant) -> Status {
        let mut through = Through { names: &self.leaves, leaves };
        match TreeRef::<u16, Full>::try_new(&mut self.rows) {
            Ok(tree) => tree.tick(&mut self.memory, &mut through, now).status,
            // It was linked when it was bound.
            Err(_) => Status::Failure,
        }
    }

    /// The leaf that is running; the first of several.
    #[must_use]
    pub fn running(&self) -> Option<&L> {
        let rows = self.rows.iter().zip(&self.memory).filter(|(_, cell)| cell.is_running());
        let mut hooks = rows.filter_map(|(row, _)| match row.node() {
            Kind::Action(hook) | Kind::Inference(hook) => Some(*hook),
            _ => None,
        });
        self.leaves.get(usize::from(hooks.next()?))
    }
}

/// Calls the program's leaves by their places in the table.
struct Through<'t, L, V: ?Sized> {
    names: &'t [L],
    leaves: &'t mut V,
}

impl<L, V: Leaves<L> + ?Sized> Leaves<u16> for Through<'_, L, V> {
    fn condition(&mut self, hook: &u16, now: Instant) -> bool {
        self.names.get(usize::from(*hook)).is_some_and(|leaf| self.leaves.condition(leaf, now))
    }

    fn on_start(&mut self, hook: &u16, now: Instant) -> Status {
        let leaf = self.names.get(usize::from(*hook));
        leaf.map_or(Status::Failure, |leaf| self.leaves.on_start(leaf, now))
    }

    fn on_running(&mut self, hook: &u16, now: Instant) -> Status {
        let leaf = self.names.get(usize::from(*hook));
        leaf.map_or(Status::Failure, |leaf| self.leaves.on_running(leaf, now))
    }

    fn on_halted(&mut self, hook: &u16, now: Instant) -> Halt {
        self.names.get(usize::from(*hook)).map_or(Halt::Done, |leaf| self.leaves.on_halted(leaf, now))
    }
}
