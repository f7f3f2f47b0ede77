//! Why a page is refused: what is wrong, and where.

use super::Which;
use crate::TaskLeaf;
use iibt_core::navigation::MissionError;
use iibt_core::tree::TreeRule;
use thiserror::Error;

/// A fault of one copy of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("byte {at}: {fault}")]
pub struct PageError {
    /// The byte within the copy at which the fault was found.
    pub at: u32,
    /// What is wrong.
    pub fault: Fault,
}

/// What is wrong with a copy of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// The flash refused to be read.
    #[error("the flash cannot be read")]
    Unreadable,
    /// Nothing was written here since the flash was erased.
    #[error("nothing is written here")]
    Blank,
    /// The first bytes are not those of a page.
    #[error("no page: the first bytes are others")]
    Magic,
    /// Another version of the format, which is given.
    #[error("format version {0} instead of {version}", version = super::VERSION)]
    Version(u8),
    /// The length is shorter than a header or longer than [`MAX_PAGE`](super::MAX_PAGE).
    #[error("a page of {0} bytes: from 24 to {most} are possible", most = super::MAX_PAGE)]
    Length(u32),
    /// The checksum is not that of the bytes: damaged, or a write was cut off.
    #[error("wrong checksum: damaged, or a write was cut off")]
    Checksum,
    /// The page needs more than the image has room for.
    #[error("the page needs {needed} {size}, the image has room for {room}")]
    TooLarge {
        /// What there is too much of.
        size: Size,
        /// How many the page has.
        needed: u16,
        /// How many the image has room for.
        room: u16,
    },
    /// A section of this kind is unknown, and the robot cannot do without.
    #[error("a section of kind {0} is needed, and this image does not know it")]
    Unknown(u8),
    /// A section of this kind comes twice or after one of a higher kind.
    #[error("the section of kind {0} is out of order")]
    Order(u8),
    /// The section of this kind is missing.
    #[error("the section of kind {0} is missing")]
    Missing(u8),
    /// A section is shorter than its content.
    #[error("the section is shorter than its content")]
    Short,
    /// A section is longer than its content.
    #[error("the section is longer than its content")]
    Long,
    /// The value with this name is out of its range.
    #[error("{0} is out of its range")]
    Value(&'static str),
    /// The mission cannot be flown.
    #[error("{0}")]
    Mission(MissionError),
    /// The tree is for other tables than the image has, or for another team.
    #[error("the tree is for the tables of another task")]
    OtherTask,
    /// No node is written so.
    #[error("no node of a tree is written {0:02x?}")]
    Node([u8; 4]),
    /// The robot has no such leaf.
    #[error("the robot has no {0}")]
    Leaf(TaskLeaf<u8>),
    /// The nodes are no tree: the one at this byte breaks a rule.
    #[error("{0}")]
    Tree(TreeRule),
}

/// A size of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Size {
    /// The cells of the map.
    Cells,
    /// The robots of the team.
    Robots,
    /// The goals.
    Goals,
    /// The paths given by hand, of all robots together.
    Paths,
    /// The nodes of the tree.
    Nodes,
    /// The nodes of the tree that one tick may visit.
    Visits,
}

impl core::fmt::Display for Size {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Cells => "cells",
            Self::Robots => "robots",
            Self::Goals => "goals",
            Self::Paths => "paths",
            Self::Nodes => "nodes of a tree",
            Self::Visits => "visits of nodes in a tick",
        })
    }
}

/// Why the robot has no page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// Neither copy is whole.
    #[error("first copy: {first}; second copy: {second}")]
    Both {
        /// What is wrong with the first copy.
        first: PageError,
        /// What is wrong with the second copy.
        second: PageError,
    },
    /// The copy that counts is whole, but is not for this image. The other one is older, and not
    /// what was wanted.
    #[error("{which} copy: {error}")]
    Content {
        /// The copy.
        which: Which,
        /// What is wrong with it.
        error: PageError,
    },
    /// The copies differ, and neither is newer.
    #[error("two different pages of generation {0}")]
    Ambiguous(u32),
}

/// Why a page was not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError {
    /// These bytes are no whole page.
    #[error("{0}")]
    Page(PageError),
    /// The page in the flash is as new or newer; its generation is given.
    #[error("the flash has a page of generation {0}")]
    NotNewer(u32),
    /// The flash refused to be erased or written.
    #[error("the flash cannot be written")]
    Unwritable,
    /// What was written reads otherwise.
    #[error("written, but then: {0}")]
    Unverified(PageError),
}

#[cfg(feature = "defmt")]
impl defmt::Format for PageError {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "byte {=u32}: {}", self.at, self.fault);
    }
}
