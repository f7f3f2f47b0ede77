//! Pages of configuration for robots that are flashed, as [`firmware::page`] reads them.

use crate::scenario::{MAX_CELLS, Scenario};
use crate::task::{TableMission, TaskError, TaskTree};
use crate::team::{TeamError, on_mission};
use firmware::Thresholds;
use firmware::adapters::Chassis;
use firmware::page::{CHECKSUM, HEADER, MAGIC, Page, PageTree, Refused, Section, VERSION, node_bytes};
use iibt_core::grid::{Cell, words};
use iibt_core::navigation::Mission;
use iibt_core::team::{Key, Member, RobotId};
use std::num::NonZero;
use thiserror::Error;

/// A page of any scenario.
pub type AnyPage = Page<MAX_CELLS, { words(MAX_CELLS, 1) }, 128>;

/// A tree of any page, with skills by their numbers in [`ANY_SKILL`].
pub type AnyPageTree = PageTree<u8, 255>;

/// All skills that a page can name.
pub const ANY_SKILL: [u8; 256] = {
    let mut skills = [0; 256];
    let mut number = 0;
    while number < skills.len() {
        skills[number] = number as u8;
        number += 1;
    }
    skills
};

/// What a robot's page says beside its mission or its tree.
///
/// ```
/// use firmware::page::Page;
/// use host_sim::{KEY, Provision, library};
/// use iibt_core::team::RobotId;
///
/// let scenario = library::find("two-goals").expect("it is built in")?;
/// let page = Provision::new(RobotId(1), KEY).page(&scenario)?;
/// let mut read = Page::<64, 2, 8>::EMPTY;
/// read.load_bytes(&page)?;
/// assert_eq!((read.robot(), read.mission(&[]).goals), (RobotId(1), &scenario.goals[..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Provision {
    /// The robot.
    pub robot: RobotId,
    /// The key of the team, from which those of all senders are derived.
    pub key: Key,
    /// The number of the keys under which robots send.
    pub rotation: u32,
    /// The number of the keys under which frames are accepted too.
    pub accepts: Option<u32>,
    /// Tells teams with one key apart.
    pub channel: u32,
    /// The period of the robot's ticks in ticks of its clock: milliseconds on a board.
    pub tick: NonZero<u16>,
    /// The least epoch of the next start; on a board that cannot count its starts, the epoch.
    pub epoch: u32,
    /// The most work units of a tick; `None` for the image's own.
    pub budget: Option<NonZero<u32>>,
    /// The battery thresholds.
    pub thresholds: Thresholds,
    /// The measures of the robot and of the grid; `None` for the board's own.
    pub chassis: Option<Chassis>,
    /// The newer of two copies is the one of the higher generation.
    pub generation: u32,
}

/// Why there is no page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ProvisionError {
    /// The robots cannot fly the mission.
    #[error(transparent)]
    Team(#[from] TeamError),
    /// Something is unknown in the mission.
    #[error("the mission has an [[unknown]], which a page does not carry yet")]
    Unknowns,
    /// The robots cannot work on the task.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// The tree has more nodes than a page can count.
    #[error("a tree of {0} nodes: a page has room for 255")]
    Nodes(usize),
    /// No robot could read the page.
    #[error(transparent)]
    Refused(#[from] Refused),
}

impl Provision {
    /// The page of a robot with ticks of 100 ms and the keys of rotation 0, in the first
    /// generation.
    #[must_use]
    pub const fn new(robot: RobotId, key: Key) -> Self {
        Self {
            robot,
            key,
            rotation: 0,
            accepts: None,
            channel: 0,
            tick: NonZero::new(100).expect("not zero"),
            epoch: 0,
            budget: None,
            thresholds: Thresholds::DEFAULT,
            chassis: None,
            generation: 1,
        }
    }

    /// Returns the page for a scenario's mission. The scenario's budget counts where there is no
    /// other.
    ///
    /// # Errors
    /// [`ProvisionError`], for a robot that is not in the team for example.
    pub fn page(&self, scenario: &Scenario) -> Result<Vec<u8>, ProvisionError> {
        let budget = self.budget.or_else(|| scenario.inference.budget.and_then(NonZero::new));
        let own = Self { budget, ..self.clone() };
        if !scenario.unknowns.is_empty() {
            return Err(ProvisionError::Unknowns);
        }
        let page = on_mission::<{ words(MAX_CELLS, 1) }, _>(scenario, |mission| Ok(own.bytes(mission)))?;
        checked(page)
    }

    /// Returns the page for a mission.
    ///
    /// # Errors
    /// [`ProvisionError`].
    pub fn page_of<const W: usize>(&self, mission: &Mission<'_, W>) -> Result<Vec<u8>, ProvisionError> {
        if !mission.unknowns.is_empty() {
            return Err(ProvisionError::Unknowns);
        }
        checked(self.bytes(mission))
    }

    /// Returns the page for a task, with the robot's tree. The task's budget counts where there is
    /// no other.
    ///
    /// # Errors
    /// [`ProvisionError`], for a robot that is not in the team for example.
    pub fn page_of_task(&self, task: &TableMission<'_>) -> Result<Vec<u8>, ProvisionError> {
        let member = Member::new(self.robot, task.tables.robots()).map_err(TaskError::from)?;
        let tree = task.tree(member.robot().index())?;
        let nodes = u8::try_from(tree.len()).map_err(|_| ProvisionError::Nodes(tree.len()))?;
        let budget = self.budget.or_else(|| task.budget.and_then(NonZero::new));
        let own = Self { budget, ..self.clone() };
        let mut page = own.begin(member.team() as u8, Sizes { nodes, ..Sizes::default() });
        page.section(Section::TREE, |page| write_tree(task.tables.mission(), &tree, page));
        own.write_chassis(&mut page);
        let (page, mut read, mut any_tree) = (page.finish(), AnyPage::EMPTY, AnyPageTree::EMPTY);
        read.load_task_bytes(&page, &mut any_tree.of(&task.tables, &ANY_SKILL))?;
        Ok(page)
    }

    fn bytes<const W: usize>(&self, mission: &Mission<'_, W>) -> Vec<u8> {
        let paths = mission.paths.unwrap_or(&[]);
        let sizes = Sizes {
            cells: mission.map.len() as u16,
            paths: paths.iter().map(|own| own.len()).sum::<usize>() as u16,
            goals: mission.goals.len() as u8,
            nodes: 0,
        };
        let mut page = self.begin(mission.team(), sizes);
        page.section(Section::MISSION, |page| write_mission(mission, page));
        if !paths.is_empty() {
            page.section(Section::PATHS, |page| write_paths(mission, page));
        }
        self.write_chassis(&mut page);
        page.finish()
    }

    /// The header, and the sections that every page has.
    fn begin(&self, team: u8, sizes: Sizes) -> Bytes {
        let mut page = Bytes(MAGIC.to_vec());
        page.u8(VERSION).u8(team).u16(sizes.cells).u16(sizes.paths).u8(sizes.goals).u8(sizes.nodes);
        page.u32(self.generation).u32(0);
        page.section(Section::ROBOT, |page| self.write_robot(team, page));
        page.section(Section::KEYS, |page| self.write_keys(team, page));
        page
    }

    fn write_chassis(&self, page: &mut Bytes) {
        if let Some(Chassis { cell, track, speed, duty }) = self.chassis {
            page.section(Section::CHASSIS, |page| {
                page.f32(cell).f32(track).f32(speed).u8(duty);
            });
        }
    }

    fn write_robot(&self, team: u8, page: &mut Bytes) {
        page.u8(self.robot.0).u8(team).u16(self.tick.get()).u32(self.channel).u32(self.epoch);
        page.u32(self.budget.map_or(0, NonZero::get));
        page.u8(self.thresholds.low).u8(self.thresholds.charged);
    }

    fn write_keys(&self, team: u8, page: &mut Bytes) {
        let rotations = [Some(self.rotation), self.accepts];
        page.u8(rotations.iter().flatten().count() as u8);
        for rotation in rotations.into_iter().flatten() {
            page.u32(rotation);
            for sender in (0..team).map(RobotId) {
                let key = self.key.of_sender(self.channel, rotation, sender);
                page.0.extend(key.to_bytes());
            }
        }
    }
}

/// What an image needs room for beside the team.
#[derive(Clone, Copy, Debug, Default)]
struct Sizes {
    cells: u16,
    paths: u16,
    goals: u8,
    nodes: u8,
}

/// A page that the firmware reads.
fn checked(page: Vec<u8>) -> Result<Vec<u8>, ProvisionError> {
    let mut read = AnyPage::EMPTY;
    read.load_bytes(&page)?;
    Ok(page)
}

fn write_mission<const W: usize>(mission: &Mission<'_, W>, page: &mut Bytes) {
    let map = &mission.map;
    page.u16(map.width()).u16(map.height());
    for begin in (0..map.len() as u16).step_by(8) {
        let is_blocked = |bit: &u16| map.contains(Cell(begin + bit)) && !map.is_free(Cell(begin + bit));
        page.u8((0..8).filter(is_blocked).map(|bit| 1 << bit).sum());
    }
    let place = |cell: &Option<Cell>| cell.map_or(u16::MAX, |cell| cell.0);
    page.list(mission.starts, |page, cell| page.u16(cell.0));
    page.list(mission.goals, |page, cell| page.u16(cell.0));
    page.list(mission.own_goals, |page, cell| page.u16(place(cell)));
    page.list(mission.chargers, |page, cell| page.u16(place(cell)));
    page.list(mission.paces, |page, pace| page.u8(*pace));
    page.list(mission.sensors, |page, sensor| page.f32(*sensor));
    page.u8(mission.need.unwrap_or(u8::MAX)).u8(mission.waits_for_charging.into());
    page.u8(mission.policies).f32(mission.precision).f32(mission.sensor);
    page.f32(mission.learning.learning()).f32(mission.learning.forgetting()).u16(mission.forgets);
}

fn write_paths<const W: usize>(mission: &Mission<'_, W>, page: &mut Bytes) {
    for own in mission.paths.unwrap_or(&[]) {
        page.list(own, |page, path| {
            page.u16(path.start.0).u8(path.len() as u8);
            let codes: Vec<u8> = path.actions.iter().collect();
            page.0.extend(codes.chunks(2).map(|pair| pair[0] | pair.get(1).map_or(0, |code| code << 4)));
            page
        });
    }
}

/// The tables for which the tree is, and its nodes.
fn write_tree(tables: u64, tree: &TaskTree, page: &mut Bytes) {
    page.0.extend(tables.to_le_bytes());
    let nodes: Vec<_> = tree.by_ref().nodes().copied().collect();
    page.list(&nodes, |page, node| {
        page.0.extend(node_bytes(node));
        page
    });
}

/// Bytes of a page, little-endian.
struct Bytes(Vec<u8>);

impl Bytes {
    fn u8(&mut self, value: u8) -> &mut Self {
        self.0.push(value);
        self
    }

    fn u16(&mut self, value: u16) -> &mut Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn u32(&mut self, value: u32) -> &mut Self {
        self.0.extend(value.to_le_bytes());
        self
    }

    fn f32(&mut self, value: f32) -> &mut Self {
        self.u32(value.to_bits())
    }

    /// The count, then the values.
    fn list<T>(&mut self, values: &[T], write: impl for<'p> Fn(&'p mut Self, &T) -> &'p mut Self) {
        self.u8(values.len() as u8);
        for value in values {
            write(self, value);
        }
    }

    fn section(&mut self, kind: u8, write: impl FnOnce(&mut Self)) {
        let mut content = Self(Vec::new());
        write(&mut content);
        self.u8(kind).u8(0).u16(content.0.len() as u16);
        self.0.extend(content.0);
    }

    /// Writes the length and the checksum.
    fn finish(mut self) -> Vec<u8> {
        let length = self.0.len() as u32 + 4;
        self.0[HEADER as usize - 4..HEADER as usize].copy_from_slice(&length.to_le_bytes());
        let checksum = CHECKSUM.checksum(&self.0);
        self.u32(checksum);
        self.0
    }
}

#[cfg(test)]
mod tests;
