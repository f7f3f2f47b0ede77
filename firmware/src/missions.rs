//! Missions that images carry in flash.

use iibt_core::grid::{Cell, Map, Path, words};
use iibt_core::navigation::Mission;

/// The cells of the paper's grid, seven rows of seven.
pub const CELLS: usize = 49;

/// The words of a map of [`CELLS`].
pub const WORDS: usize = words(7, 7);

/// The steps of a plan in images, its start included.
pub const LAYERS: usize = 33;

/// The nodes of a search in images.
pub const NODES: usize = 64;

/// The joint policies that are weighed in images.
pub const POLICIES: usize = 16;

/// The paths that a page may give all robots together in images.
pub const ALL_PATHS: usize = 8;

/// The nodes of a tree that a page may give a robot with a table task in images.
pub const TREE_NODES: usize = 32;

/// A configuration for links whose packets have 64 bytes, as those of CAN-FD: eight joint policies,
/// two unknown cells.
///
/// Frames of a whole team fit whatever happens, and those of a team that goes on without one robot:
/// it then weighs as many policies as its claim leaves room for, at least two. Without two robots,
/// frames fit while no robot has started 2^14 times, sent 2^21 frames since, or seen 2^14 rounds.
/// Without three or four of them, a frame may be up to 19 bytes too long, and the link refuses it:
/// teams of up to five robots never come to that.
///
/// ```
/// use firmware::missions::compact;
/// use firmware::Settings;
/// use iibt_core::grid::{Cell, Map};
/// use iibt_core::navigation::Mission;
/// use iibt_core::team::{Key, Member, RobotId};
/// use core::num::NonZero;
///
/// let map = Map::<{ compact::WORDS }>::drawn("....\n....\n....")?;
/// let (starts, goals) = ([Cell(0), Cell(8)], [Cell(3), Cell(11)]);
/// let mission = Mission { policies: 8, ..Mission::new(map, &starts, &goals) };
/// let member = Member::new(RobotId(0), 2)?;
/// let settings = Settings::new(member, Key::new(*b"sixteen bytes..."), 1, NonZero::<u16>::MIN);
/// let robot = compact::Robot::new(&mission, &settings)?;
/// # let _ = robot;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub mod compact {
    use crate::Navigator;
    use iibt_core::grid::words;
    use iibt_core::navigation::{SMALL_FRAME_POLICIES, longest_packet};

    pub use super::{LAYERS, NODES};

    /// The most cells of a map, such as eight rows of eight.
    pub const CELLS: usize = 64;

    /// The words of such a map.
    pub const WORDS: usize = words(8, 8);

    /// The joint policies that are weighed.
    pub const POLICIES: usize = SMALL_FRAME_POLICIES;

    /// The longest frame in bytes, without delimiters.
    pub const LONGEST_PACKET: usize = 64;

    const _: () = assert!(
        longest_packet::<WORDS, POLICIES>(0) <= LONGEST_PACKET
            && longest_packet::<WORDS, POLICIES>(1) <= LONGEST_PACKET,
        "the frames of a team of which one robot at most is left out fit a packet"
    );

    /// A robot of a team with such frames.
    pub type Robot<'m> = Navigator<'m, CELLS, WORDS, LAYERS, NODES, POLICIES>;
}

/// The reduced configuration, for chips with 64 KiB of flash and 20 KiB of RAM: teams without a
/// planner, which choose among paths given by hand.
///
/// A robot goes by one of its paths, or by what is left of one from where it stands, so a team also
/// decides anew when an obstacle is on its way or a robot is lost. Where no combination of such
/// paths is free of conflicts and obstacles, all stand. There are no chargers, way-points and
/// unknown cells: a robot whose battery is low stands, and its team with it.
///
/// ```
/// use firmware::Settings;
/// use firmware::missions::{SECTION_5_1, reduced};
/// use iibt_core::navigation::{Mission, MissionError};
/// use iibt_core::team::{Key, Member, RobotId};
/// use core::num::NonZero;
///
/// let member = Member::new(RobotId(0), 2)?;
/// let settings = Settings::new(member, Key::new(*b"sixteen bytes..."), 1, NonZero::<u16>::MIN);
/// assert!(reduced::Robot::new(&SECTION_5_1, &settings).is_ok());
/// let without_paths = Mission { paths: None, ..SECTION_5_1 };
/// assert_eq!(reduced::Robot::new(&without_paths, &settings).err(), Some(MissionError::NoPlanner));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub mod reduced {
    use crate::Navigator;
    use iibt_core::grid::words;

    /// The most cells of a map, such as eight rows of eight.
    pub const CELLS: usize = 64;

    /// The words of such a map.
    pub const WORDS: usize = words(8, 8);

    /// There are no plans.
    pub const LAYERS: usize = 0;

    /// There are no searches; an arena has one node at least.
    pub const NODES: usize = 1;

    /// The joint policies that are weighed.
    pub const POLICIES: usize = 8;

    /// The paths that a page may give all robots together.
    pub const ALL_PATHS: usize = 16;

    /// A robot of such a team.
    pub type Robot<'m> = Navigator<'m, CELLS, WORDS, LAYERS, NODES, POLICIES>;
}

/// The paths of each robot in [`SECTION_5_1`].
const PATHS: usize = 4;

/// The paper's section 5.1: two robots, goals 24 and 26, and four candidate paths each.
///
/// Robot 1 (index 0) starts on 28 with paths A to D, robot 2 on 2 with paths b, a, c, d: the short
/// one first, which is the order of the paper's numbers, not of its text.
pub static SECTION_5_1: Mission<'static, WORDS> = Mission {
    paths: Some(&[&FIRST, &SECOND]),
    ..Mission::new(MAP, &[Cell(28), Cell(2)], &[Cell(24), Cell(26)])
};

const MAP: Map<WORDS> = match Map::new(7, 7) {
    Ok(map) => map,
    Err(_) => panic!("the map has a word for every 32 cells"),
};

static FIRST: [Path; PATHS] = [
    through(&[28, 29, 30, 31, 24]),
    through(&[28, 35, 36, 37, 38, 31, 24]),
    through(&[28, 29, 30, 31, 32, 33, 26]),
    through(&[28, 35, 36, 37, 38, 39, 40, 41, 34, 27, 26]),
];

static SECOND: [Path; PATHS] = [
    through(&[2, 3, 10, 17, 24]),
    through(&[2, 1, 8, 15, 22, 23, 24]),
    through(&[2, 3, 4, 11, 18, 25, 26]),
    through(&[2, 3, 4, 5, 12, 19, 26]),
];

const fn through<const N: usize>(numbers: &[u16; N]) -> Path {
    let mut cells = [Cell(0); N];
    let mut index = 0;
    while index < N {
        cells[index] = Cell(numbers[index]);
        index += 1;
    }
    match Path::through(&MAP, &cells) {
        Some(path) => path,
        None => panic!("the cells of a path are neighbours"),
    }
}
