//! An arena of joint states in which none is twice.

use super::super::Cell;
use super::assignment::State;
use super::pibt::scramble;

/// The number of no state.
pub(super) const NONE: u16 = u16::MAX;

/// A joint state that a search has come to; 30 bytes for eight robots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<const N: usize> {
    pub(super) cells: State<N>,
    /// How many steps each robot has not been on its target, 255 for more.
    pub(super) patience: [u8; N],
    /// How many of its successors have been tried.
    pub(super) tried: u16,
    /// During the search the state it was made from, afterwards the next state of the plan.
    pub(super) link: u16,
    /// The next state with the same hash.
    chain: u16,
}

/// At most `M` joint states, numbered in the order in which they came, and a hash table over them.
#[derive(Clone, Debug)]
pub(super) struct States<const N: usize, const M: usize> {
    nodes: [Node<N>; M],
    heads: [u16; M],
    used: u16,
}

impl<const N: usize> Node<N> {
    const EMPTY: Self = Self { cells: [Cell(0); N], patience: [0; N], tried: 0, link: 0, chain: 0 };
}

impl<const N: usize, const M: usize> States<N, M> {
    /// Memory that is to be [cleared](Self::clear) before its first use.
    pub(super) const fn new() -> Self {
        const { assert!(M > 0 && M < NONE as usize, "states have numbers of 16 bits") }
        Self { nodes: [Node::EMPTY; M], heads: [0; M], used: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.heads.fill(NONE);
        self.used = 0;
    }

    pub(super) fn node(&self, state: u16) -> Option<&Node<N>> {
        self.nodes.get(usize::from(state))
    }

    pub(super) fn node_mut(&mut self, state: u16) -> Option<&mut Node<N>> {
        self.nodes.get_mut(usize::from(state))
    }

    /// All places for states, by their numbers.
    pub(super) fn nodes_mut(&mut self) -> &mut [Node<N>] {
        &mut self.nodes
    }

    pub(super) fn contains(&self, cells: &State<N>) -> bool {
        let first = self.heads.get(Self::slot(cells)).and_then(|&head| self.node(head));
        core::iter::successors(first, |node| self.node(node.chain)).any(|node| node.cells == *cells)
    }

    /// Adds a state made from another one and returns its number; `None` when the arena is full.
    pub(super) fn add(&mut self, cells: State<N>, patience: [u8; N], from: u16) -> Option<u16> {
        let number = self.used;
        let head = self.heads.get_mut(Self::slot(&cells))?;
        let node = self.nodes.get_mut(usize::from(number))?;
        *node = Node { cells, patience, tried: 0, link: from, chain: *head };
        *head = number;
        self.used += 1;
        Some(number)
    }

    /// Turns the links around, from a state back to where it all began, and returns that one.
    pub(super) fn turn_back(&mut self, last: u16) -> u16 {
        let (mut at, mut next) = (last, NONE);
        while let Some(node) = self.node_mut(at) {
            let from = core::mem::replace(&mut node.link, next);
            (at, next) = (from, at);
        }
        next
    }

    fn slot(cells: &State<N>) -> usize {
        let hash = cells.iter().fold(0, |hash, cell| scramble(hash ^ u32::from(cell.0)).wrapping_add(hash));
        ((u64::from(hash) * M as u64) >> 32) as usize
    }
}
