//! The configuration of a robot in its flash: one image for all robots, another page for each.
//!
//! A page says which robot this is, under which keys it sends, and its mission. `host-sim
//! provision` writes it; `docs/page.md` has every byte of it. Two copies lie in the flash, so that
//! a write that is cut off loses nothing. A page that is damaged or does not fit the image is
//! refused with the reason, and the robot should stand.
//!
//! ```
//! use firmware::page::{Page, Refused, Slots};
//! # use embedded_storage::nor_flash::{ErrorType, ReadNorFlash};
//! # struct Blank;
//! # impl ErrorType for Blank { type Error = core::convert::Infallible; }
//! # impl ReadNorFlash for Blank {
//! #     const READ_SIZE: usize = 1;
//! #     fn read(&mut self, _: u32, bytes: &mut [u8]) -> Result<(), Self::Error> { bytes.fill(0xff); Ok(()) }
//! #     fn capacity(&self) -> usize { 1 << 20 }
//! # }
//! const SLOTS: Slots = Slots { first: 0x8_0000, second: 0xa_0000 };
//!
//! // Maps of up to 64 cells in 2 words, and up to 8 paths of all robots together.
//! let mut page = Page::<64, 2, 8>::EMPTY;
//! # let mut flash = Blank;
//! match page.load(&mut flash, SLOTS) {
//!     Ok(_) => {
//!         let (lists, epoch) = (page.path_lists(), page.epoch());
//!         let mission = page.mission(&lists);
//!         let settings = page.settings(epoch);
//!         // ... as in `Navigator` and `Controller`
//!     }
//!     Err(refused) => assert!(matches!(refused, Refused::Both { .. })), // nothing was written
//! }
//! ```

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

mod content;
mod fault;
mod node;
mod sections;
mod slots;
mod source;
mod tree;

pub use content::Page;
pub use fault::{Fault, PageError, Refused, Size, StoreError};
pub use node::node_bytes;
pub use slots::{Origin, Slots, Which, erase, store};
pub use tree::{MAX_VISITS, PageTree, TreeMemory, TreeReader};

/// The longest page in bytes. Each of the two [`Slots`] has room for one.
pub const MAX_PAGE: u32 = 8192;

/// The first bytes of a page.
pub const MAGIC: [u8; 4] = *b"IIBT";

/// The version of the format.
pub const VERSION: u8 = 1;

/// The length of the header in bytes.
pub const HEADER: u32 = 20;

/// The length of the head of a section in bytes.
pub const SECTION_HEAD: u32 = 4;

/// The checksum that ends a page: CRC-32 as in Ethernet, gzip and zip.
pub const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The kinds of sections. Kinds below [`Section::OPTIONAL`] that a reader does not know are
/// refused, others are passed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Section;

impl Section {
    /// Which robot this is, its rhythm, its epoch, its battery.
    pub const ROBOT: u8 = 1;
    /// The keys of all senders.
    pub const KEYS: u8 = 2;
    /// The map, starts, goals and the model.
    pub const MISSION: u8 = 3;
    /// Paths given by hand.
    pub const PATHS: u8 = 4;
    /// The measures of the robot and of the grid.
    pub const CHASSIS: u8 = 5;
    /// The behavior tree of a robot with a table task.
    pub const TREE: u8 = 6;
    /// The tables of a task; no reader knows them yet.
    pub const TABLES: u8 = 7;
    /// The first kind that a reader may pass over.
    pub const OPTIONAL: u8 = 128;
}
