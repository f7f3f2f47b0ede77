//! Reading the header and the sections of a page.

use super::source::Source;
use super::{Fault, HEADER, Page, PageError, Section, Size};
use crate::Thresholds;
use crate::adapters::Chassis;
use core::num::NonZero;
use embedded_storage::nor_flash::ReadNorFlash;
use heapless::Vec;
use iibt_core::grid::{Cell, Map, Move, Path};
use iibt_core::inference::learning::Rates;
use iibt_core::navigation::MAX_GOALS;
use iibt_core::team::{Keys, MAX_TEAM, RobotId};

/// The number that stands for no cell.
const NO_CELL: u16 = u16::MAX;

impl<const S: usize, const W: usize, const P: usize> Page<S, W, P> {
    /// Reads a copy whose checksum is right; `length` is that without the checksum.
    pub(super) fn read<F: ReadNorFlash>(
        &mut self,
        source: &mut Source<'_, F>,
        length: u32,
    ) -> Result<(), PageError> {
        self.clear();
        self.read_sizes(source)?;
        source.read_from(HEADER, length);
        let (mut last, mut seen) = (0, 0_u8);
        while !source.is_at_end() {
            let kind = source.valid("a kind of section", Source::u8, |kind| kind > 0)?;
            if kind <= last {
                return Err(source.error(Fault::Order(kind)));
            }
            (last, seen) = (kind, seen | 1_u8.checked_shl(kind.into()).unwrap_or(0));
            self.read_section(source, kind, length)?;
        }
        for kind in [Section::ROBOT, Section::KEYS, Section::MISSION] {
            if seen & (1 << kind) == 0 {
                return Err(source.error(Fault::Missing(kind)));
            }
        }
        self.check(source.at())
    }

    /// The sizes in the header, so that a page for a larger image is refused by the name of the
    /// size.
    fn read_sizes<F: ReadNorFlash>(&self, source: &mut Source<'_, F>) -> Result<(), PageError> {
        source.read_from(5, HEADER);
        let robots = u16::from(source.u8()?);
        let (cells, paths) = (source.u16()?, source.u16()?);
        let goals = u16::from(source.u8()?);
        source.valid("a spare byte", Source::u8, |spare| spare == 0)?;
        let most_cells = S.min(32 * W);
        let sizes = [
            (Size::Robots, robots, MAX_TEAM),
            (Size::Cells, cells, most_cells),
            (Size::Paths, paths, P),
            (Size::Goals, goals, MAX_GOALS),
        ];
        for (size, needed, room) in sizes {
            fits(size, needed.into(), room).map_err(|fault| PageError { at: 5, fault })?;
        }
        Ok(())
    }

    fn read_section<F: ReadNorFlash>(
        &mut self,
        source: &mut Source<'_, F>,
        kind: u8,
        end: u32,
    ) -> Result<(), PageError> {
        source.valid("a spare byte", Source::u8, |spare| spare == 0)?;
        let length = source.u16()?;
        let begin = source.at();
        let stop = begin.saturating_add(length.into());
        if stop > end {
            return Err(source.error(Fault::Short));
        }
        source.read_from(begin, stop);
        match kind {
            Section::ROBOT => self.read_robot(source)?,
            Section::KEYS => self.read_keys(source)?,
            Section::MISSION => self.read_mission(source)?,
            Section::PATHS => self.read_paths(source)?,
            Section::CHASSIS => self.chassis = Some(read_chassis(source)?),
            Section::OPTIONAL.. => source.read_from(stop, stop),
            unknown => return Err(source.error(Fault::Unknown(unknown))),
        }
        if source.is_at_end() {
            source.read_from(stop, end);
            Ok(())
        } else {
            Err(source.error(Fault::Long))
        }
    }

    fn read_robot<F: ReadNorFlash>(&mut self, source: &mut Source<'_, F>) -> Result<(), PageError> {
        self.robot = RobotId(source.u8()?);
        let robot = self.robot.0;
        let is_team = |team: u8| usize::from(team) <= MAX_TEAM && robot < team;
        self.team = source.valid("the robot or its team", Source::u8, is_team)?;
        let tick = source.valid("the tick", Source::u16, |tick| tick > 0)?;
        self.tick = NonZero::new(tick);
        self.channel = source.u32()?;
        self.epoch = source.u32()?;
        self.budget = NonZero::new(source.u32()?);
        let low = source.valid("a battery threshold", Source::u8, |low| low <= 100)?;
        let charged = source.valid("a battery threshold", Source::u8, |at| at >= low && at <= 100)?;
        self.thresholds = Thresholds { low, charged };
        Ok(())
    }

    fn read_keys<F: ReadNorFlash>(&mut self, source: &mut Source<'_, F>) -> Result<(), PageError> {
        let sets = source.valid("the number of keys", Source::u8, |sets| sets == 1 || sets == 2)?;
        let keys;
        (self.rotation, keys) = (source.u32()?, read_senders(source, self.team)?);
        (self.accepts, self.keys) = if sets == 2 {
            (Some(source.u32()?), keys.accepting(&read_senders(source, self.team)?))
        } else {
            (None, keys)
        };
        Ok(())
    }

    fn read_mission<F: ReadNorFlash>(&mut self, source: &mut Source<'_, F>) -> Result<(), PageError> {
        self.map = Some(read_map(source, S)?);
        read_list(source, &mut self.starts, Size::Robots, read_cell)?;
        if self.starts.len() != usize::from(self.team) {
            return Err(source.error(Fault::Value("the number of starts")));
        }
        read_list(source, &mut self.goals, Size::Goals, read_cell)?;
        read_list(source, &mut self.own_goals, Size::Robots, read_place)?;
        read_list(source, &mut self.chargers, Size::Robots, read_place)?;
        read_list(source, &mut self.paces, Size::Robots, Source::u8)?;
        read_list(source, &mut self.sensors, Size::Robots, Source::f32)?;
        self.need = Some(source.u8()?).filter(|&need| need < u8::MAX);
        self.waits_for_charging = source.valid("a flag", Source::u8, |flag| flag <= 1)? == 1;
        self.policies = source.u8()?;
        self.precision = source.f32()?;
        self.sensor = source.f32()?;
        let is_rate = |rate: f32| rate.is_finite() && rate >= 0.0;
        let learning = source.valid("a learning rate", Source::f32, is_rate)?;
        self.learning = Rates::new(learning, source.valid("a rate of forgetting", Source::f32, is_rate)?);
        self.forgets = source.u16()?;
        Ok(())
    }

    fn read_paths<F: ReadNorFlash>(&mut self, source: &mut Source<'_, F>) -> Result<(), PageError> {
        for _ in 0..self.team {
            let count = source.u8()?;
            for _ in 0..count {
                let path = read_path(source)?;
                let room = self.paths.push(path);
                room.map_err(|_| source.error(too_large(Size::Paths, P + 1, P)))?;
            }
            let room = self.counts.push(count);
            room.map_err(|_| source.error(too_large(Size::Robots, MAX_TEAM + 1, MAX_TEAM)))?;
        }
        Ok(())
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

const fn too_large(size: Size, needed: usize, room: usize) -> Fault {
    Fault::TooLarge { size, needed: needed as u16, room: room as u16 }
}

const fn fits(size: Size, needed: usize, room: usize) -> Result<(), Fault> {
    if needed > room { Err(too_large(size, needed, room)) } else { Ok(()) }
}

/// A count and as many values.
fn read_list<'f, F: ReadNorFlash, T, const N: usize>(
    source: &mut Source<'f, F>,
    list: &mut Vec<T, N>,
    size: Size,
    read: impl Fn(&mut Source<'f, F>) -> Result<T, PageError>,
) -> Result<(), PageError> {
    let at = source.at();
    let count = source.u8()?;
    fits(size, count.into(), N).map_err(|fault| PageError { at, fault })?;
    for _ in 0..count {
        // There is room for as many.
        let _ = list.push(read(source)?);
    }
    Ok(())
}

fn read_cell<F: ReadNorFlash>(source: &mut Source<'_, F>) -> Result<Cell, PageError> {
    source.u16().map(Cell)
}

/// A cell or none.
fn read_place<F: ReadNorFlash>(source: &mut Source<'_, F>) -> Result<Option<Cell>, PageError> {
    Ok(Some(source.u16()?).filter(|&cell| cell != NO_CELL).map(Cell))
}

fn read_senders<F: ReadNorFlash>(source: &mut Source<'_, F>, team: u8) -> Result<Keys, PageError> {
    let mut senders = [[0; 16]; MAX_TEAM];
    for sender in senders.iter_mut().take(team.into()) {
        *sender = source.bytes()?;
    }
    Ok(Keys::new(senders))
}

/// Columns, rows, and a bit for each cell that is set where it is blocked.
fn read_map<F: ReadNorFlash, const W: usize>(
    source: &mut Source<'_, F>,
    most: usize,
) -> Result<Map<W>, PageError> {
    let at = source.at();
    let (width, height) = (source.u16()?, source.u16()?);
    let cells = usize::from(width).saturating_mul(height.into());
    fits(Size::Cells, cells, most.min(32 * W)).map_err(|fault| PageError { at, fault })?;
    let error = PageError { at, fault: Fault::Value("the size of the map") };
    let mut map = Map::new(width, height).map_err(|_| error)?;
    let mut byte = 0;
    for cell in 0..cells as u16 {
        if cell.is_multiple_of(8) {
            byte = source.u8()?;
        }
        if byte & 1 == 1 {
            map.block(Cell(cell));
        }
        byte >>= 1;
    }
    if byte == 0 { Ok(map) } else { Err(source.error(Fault::Value("a cell beyond the map"))) }
}

/// The start, the number of moves, and half a byte for each.
fn read_path<F: ReadNorFlash>(source: &mut Source<'_, F>) -> Result<Path, PageError> {
    let (mut path, moves) = (Path::at(Cell(source.u16()?)), source.u8()?);
    let mut byte = 0;
    for number in 0..moves {
        byte = if number % 2 == 0 { source.u8()? } else { byte >> 4 };
        let step = Move::from_code(byte & 0xf);
        let pushed = step.is_some_and(|step| path.push(step).is_ok());
        if !pushed {
            return Err(source.error(Fault::Value("a move of a path")));
        }
    }
    if moves % 2 == 1 && byte >> 4 != 0 {
        return Err(source.error(Fault::Value("a move of a path")));
    }
    Ok(path)
}

fn read_chassis<F: ReadNorFlash>(source: &mut Source<'_, F>) -> Result<Chassis, PageError> {
    let is_measure = |length: f32| length.is_finite() && length > 0.0;
    let mut measure = |name| source.valid(name, Source::f32, is_measure);
    let (cell, track, speed) = (measure("the side of a cell")?, measure("the track")?, measure("the speed")?);
    let duty = source.valid("the duty cycle", Source::u8, |duty| duty <= 100)?;
    Ok(Chassis { cell, track, speed, duty })
}
