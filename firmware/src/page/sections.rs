//! Reading the header and the sections of a page.

use super::source::Source;
use super::tree::ReadTree;
use super::{Fault, HEADER, Page, PageError, Section, Size};
use crate::Thresholds;
use crate::adapters::Chassis;
use core::num::NonZero;
use heapless::Vec;
use iibt_core::grid::{Cell, Map, Move, Path};
use iibt_core::inference::learning::Rates;
use iibt_core::navigation::MAX_GOALS;
use iibt_core::team::{Keys, MAX_TEAM, RobotId};

/// The number that stands for no cell.
const NO_CELL: u16 = u16::MAX;

impl<const S: usize, const W: usize, const P: usize> Page<S, W, P> {
    /// Reads a copy whose checksum is right; `length` is that without the checksum. With room for a
    /// tree it is the page of a robot with a table task.
    pub(super) fn read<R: ReadTree>(
        &mut self,
        source: &mut Source<'_>,
        length: u32,
        tree: &mut R,
    ) -> Result<(), PageError> {
        self.clear();
        read_sizes(source, [MAX_TEAM, S.min(32 * W), P, MAX_GOALS, R::ROOM]);
        source.read_from(HEADER, length);
        let (mut last, mut seen) = (0, 0_u8);
        while !source.is_at_end() {
            let kind = source.u8();
            source.require("a kind of section", kind > 0);
            if kind <= last {
                source.refuse(source.at(), Fault::Order(kind));
            }
            (last, seen) = (kind, seen | 1_u8.checked_shl(kind.into()).unwrap_or(0));
            self.read_section(source, kind, length, tree);
        }
        let task = if R::ROOM > 0 { Section::TREE } else { Section::MISSION };
        for kind in [Section::ROBOT, Section::KEYS, task] {
            if seen & (1 << kind) == 0 {
                source.refuse(source.at(), Fault::Missing(kind));
            }
        }
        source.outcome()?;
        if R::ROOM > 0 { Ok(()) } else { self.check(source.at()) }
    }

    fn read_section<R: ReadTree>(&mut self, source: &mut Source<'_>, kind: u8, end: u32, tree: &mut R) {
        let spare = source.u8();
        source.require("a spare byte", spare == 0);
        let length = source.u16();
        let begin = source.at();
        let stop = begin.saturating_add(length.into());
        if stop > end {
            source.refuse(begin, Fault::Short);
        }
        source.read_from(begin, stop);
        match kind {
            Section::ROBOT => self.read_robot(source),
            Section::KEYS => self.read_keys(source),
            Section::MISSION if R::ROOM == 0 => self.read_mission(source),
            Section::PATHS if R::ROOM == 0 => self.read_paths(source),
            Section::CHASSIS => self.chassis = Some(read_chassis(source)),
            Section::TREE if R::ROOM > 0 => tree.read(source, self.robot, self.team),
            Section::OPTIONAL.. => source.read_from(stop, stop),
            unknown => source.refuse(begin, Fault::Unknown(unknown)),
        }
        if !source.is_at_end() {
            source.refuse(source.at(), Fault::Long);
        }
        source.read_from(stop, end);
    }

    fn read_robot(&mut self, source: &mut Source<'_>) {
        self.robot = RobotId(source.u8());
        self.team = source.u8();
        let is_team = usize::from(self.team) <= MAX_TEAM && self.robot.0 < self.team;
        source.require("the robot or its team", is_team);
        self.tick = NonZero::new(source.u16());
        source.require("the tick", self.tick.is_some());
        self.channel = source.u32();
        self.epoch = source.u32();
        self.budget = NonZero::new(source.u32());
        let low = source.u8();
        source.require("a battery threshold", low <= 100);
        let charged = source.u8();
        source.require("a battery threshold", charged >= low && charged <= 100);
        self.thresholds = Thresholds { low, charged };
    }

    fn read_keys(&mut self, source: &mut Source<'_>) {
        let sets = source.u8();
        source.require("the number of keys", sets == 1 || sets == 2);
        self.rotation = source.u32();
        self.keys = read_senders(source, self.team);
        self.accepts = (sets == 2).then(|| source.u32());
        if self.accepts.is_some() {
            self.keys = self.keys.clone().accepting(&read_senders(source, self.team));
        }
    }

    fn read_mission(&mut self, source: &mut Source<'_>) {
        self.map = read_map(source, S);
        read_list(source, &mut self.starts, Size::Robots, read_cell);
        if self.starts.len() != usize::from(self.team) {
            source.refuse(source.at(), Fault::Value("the number of starts"));
        }
        read_list(source, &mut self.goals, Size::Goals, read_cell);
        read_list(source, &mut self.own_goals, Size::Robots, read_place);
        read_list(source, &mut self.chargers, Size::Robots, read_place);
        read_list(source, &mut self.paces, Size::Robots, Source::u8);
        read_list(source, &mut self.sensors, Size::Robots, Source::f32);
        self.need = Some(source.u8()).filter(|&need| need < u8::MAX);
        let waits = source.u8();
        source.require("a flag", waits <= 1);
        self.waits_for_charging = waits == 1;
        self.policies = source.u8();
        self.precision = source.f32();
        self.sensor = source.f32();
        let is_rate = |rate: f32| rate.is_finite() && rate >= 0.0;
        let learning = source.f32();
        source.require("a learning rate", is_rate(learning));
        let forgetting = source.f32();
        source.require("a rate of forgetting", is_rate(forgetting));
        self.learning = Rates::new(learning, forgetting);
        self.forgets = source.u16();
    }

    fn read_paths(&mut self, source: &mut Source<'_>) {
        for _ in 0..self.team {
            let count = source.u8();
            for _ in 0..count {
                if self.paths.push(read_path(source)).is_err() {
                    source.refuse(source.at(), too_large(Size::Paths, P + 1, P));
                }
            }
            if self.counts.push(count).is_err() {
                source.refuse(source.at(), too_large(Size::Robots, MAX_TEAM + 1, MAX_TEAM));
            }
        }
    }

    /// Empties the lists; every other value is read, or has been read when the page is of use.
    fn clear(&mut self) {
        self.starts.clear();
        self.goals.clear();
        self.own_goals.clear();
        self.chargers.clear();
        self.paces.clear();
        self.sensors.clear();
        self.paths.clear();
        self.counts.clear();
        self.chassis = None;
    }
}

/// The sizes in the header, so that a page for a larger image is refused by the name of the size.
/// `room` has those of the image: robots, cells, paths, goals and nodes of a tree.
fn read_sizes(source: &mut Source<'_>, room: [usize; 5]) {
    source.read_from(5, HEADER);
    let robots = u16::from(source.u8());
    let (cells, paths) = (source.u16(), source.u16());
    let (goals, nodes) = (u16::from(source.u8()), u16::from(source.u8()));
    let sizes = [
        (Size::Robots, robots),
        (Size::Cells, cells),
        (Size::Paths, paths),
        (Size::Goals, goals),
        (Size::Nodes, nodes),
    ];
    for ((size, needed), room) in sizes.into_iter().zip(room) {
        fits(source, 5, size, needed.into(), room);
    }
}

const fn too_large(size: Size, needed: usize, room: usize) -> Fault {
    Fault::TooLarge { size, needed: needed as u16, room: room as u16 }
}

/// Whether there is room; where there is none, that is a fault at this byte.
pub(super) fn fits(source: &mut Source<'_>, at: u32, size: Size, needed: usize, room: usize) -> bool {
    if needed > room {
        source.refuse(at, too_large(size, needed, room));
    }
    needed <= room
}

/// A count and as many values.
fn read_list<'f, T, const N: usize>(
    source: &mut Source<'f>,
    list: &mut Vec<T, N>,
    size: Size,
    read: impl Fn(&mut Source<'f>) -> T,
) {
    let at = source.at();
    let count = source.u8();
    fits(source, at, size, count.into(), N);
    for _ in 0..count {
        // There is room for as many, or the page is refused.
        let _ = list.push(read(source));
    }
}

fn read_cell(source: &mut Source<'_>) -> Cell {
    Cell(source.u16())
}

/// A cell or none.
fn read_place(source: &mut Source<'_>) -> Option<Cell> {
    Some(read_cell(source)).filter(|cell| cell.0 != NO_CELL)
}

#[inline(never)]
fn read_senders(source: &mut Source<'_>, team: u8) -> Keys {
    let mut senders = [[0; 16]; MAX_TEAM];
    for byte in senders.iter_mut().take(team.into()).flatten() {
        *byte = source.u8();
    }
    Keys::new(senders)
}

/// Columns, rows, and a bit for each cell that is set where it is blocked.
fn read_map<const W: usize>(source: &mut Source<'_>, most: usize) -> Option<Map<W>> {
    let at = source.at();
    let (width, height) = (source.u16(), source.u16());
    let cells = usize::from(width).saturating_mul(height.into());
    if !fits(source, at, Size::Cells, cells, most.min(32 * W)) {
        return None;
    }
    let Ok(mut map) = Map::new(width, height) else {
        source.refuse(at, Fault::Value("the size of the map"));
        return None;
    };
    let mut byte = 0;
    for cell in 0..cells as u16 {
        if cell.is_multiple_of(8) {
            byte = source.u8();
        }
        if byte & 1 == 1 {
            map.block(Cell(cell));
        }
        byte >>= 1;
    }
    if byte != 0 {
        source.refuse(source.at(), Fault::Value("a cell beyond the map"));
    }
    Some(map)
}

/// The start, the number of moves, and half a byte for each.
#[inline(never)]
fn read_path(source: &mut Source<'_>) -> Path {
    let (mut path, moves) = (Path::at(read_cell(source)), source.u8());
    let mut byte = 0;
    let refuse = |source: &mut Source<'_>| source.refuse(source.at(), Fault::Value("a move of a path"));
    for number in 0..moves {
        byte = if number % 2 == 0 { source.u8() } else { byte >> 4 };
        let step = Move::from_code(byte & 0xf);
        if step.is_none_or(|step| path.push(step).is_err()) {
            refuse(source);
        }
    }
    if moves % 2 == 1 && byte >> 4 != 0 {
        refuse(source);
    }
    path
}

fn read_chassis(source: &mut Source<'_>) -> Chassis {
    let mut measure = |name| {
        let length = source.f32();
        source.require(name, length.is_finite() && length > 0.0);
        length
    };
    let (cell, track, speed) = (measure("the side of a cell"), measure("the track"), measure("the speed"));
    let duty = source.u8();
    source.require("the duty cycle", duty <= 100);
    Chassis { cell, track, speed, duty }
}
