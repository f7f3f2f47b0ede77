//! What a page holds, as the robot uses it.

use super::tree::{NoTree, ReadTree};
use super::{Fault, Origin, PageError, Refused, Slots};
use super::{TreeReader, slots::Bytes, source::Source};
use crate::adapters::Chassis;
use crate::{Navigator, Settings, Thresholds};
use core::num::NonZero;
use embedded_storage::nor_flash::ReadNorFlash;
use heapless::Vec;
use iibt_core::grid::{Cell, Map, Path};
use iibt_core::inference::learning::Rates;
use iibt_core::navigation::{MAX_GOALS, Mission};
use iibt_core::team::{Keys, MAX_TEAM, Member, MemberError, RobotId};

/// Where the copies of a page in memory lie: nothing is in the place of the second.
const IN_MEMORY: Slots = Slots { first: 0, second: super::MAX_PAGE };

/// The page of a robot: for maps of up to `S` cells in `W` words, and up to `P` paths given by hand
/// of all robots together.
///
/// Keep it in a `static`, where [`load`](Self::load) fills it: it takes 36 bytes a path and some
/// 600 more. The [module](super) has an example.
#[derive(Clone, Debug)]
pub struct Page<const S: usize, const W: usize, const P: usize> {
    pub(super) robot: RobotId,
    pub(super) team: u8,
    pub(super) channel: u32,
    pub(super) tick: Option<NonZero<u16>>,
    pub(super) epoch: u32,
    pub(super) budget: Option<NonZero<u32>>,
    pub(super) thresholds: Thresholds,
    pub(super) keys: Keys,
    pub(super) rotation: u32,
    pub(super) accepts: Option<u32>,
    pub(super) chassis: Option<Chassis>,
    pub(super) map: Option<Map<W>>,
    pub(super) starts: Vec<Cell, MAX_TEAM>,
    pub(super) goals: Vec<Cell, MAX_GOALS>,
    pub(super) own_goals: Vec<Option<Cell>, MAX_TEAM>,
    pub(super) chargers: Vec<Option<Cell>, MAX_TEAM>,
    pub(super) paces: Vec<u8, MAX_TEAM>,
    pub(super) sensors: Vec<f32, MAX_TEAM>,
    pub(super) need: Option<u8>,
    pub(super) waits_for_charging: bool,
    pub(super) policies: u8,
    pub(super) precision: f32,
    pub(super) sensor: f32,
    pub(super) learning: Rates,
    pub(super) forgets: u16,
    pub(super) paths: Vec<Path, P>,
    /// The number of paths of each robot; empty when no paths are given.
    pub(super) counts: Vec<u8, MAX_TEAM>,
}

impl<const S: usize, const W: usize, const P: usize> Page<S, W, P> {
    /// The page that nothing was read into: all zeros, so that a `static` takes no flash for it.
    pub const EMPTY: Self = Self {
        robot: RobotId(0),
        team: 0,
        channel: 0,
        tick: None,
        epoch: 0,
        budget: None,
        thresholds: Thresholds { low: 0, charged: 0 },
        keys: Keys::new([[0; 16]; MAX_TEAM]),
        rotation: 0,
        accepts: None,
        chassis: None,
        map: None,
        starts: Vec::new(),
        goals: Vec::new(),
        own_goals: Vec::new(),
        chargers: Vec::new(),
        paces: Vec::new(),
        sensors: Vec::new(),
        need: None,
        waits_for_charging: false,
        policies: 0,
        precision: 0.0,
        sensor: 0.0,
        learning: Rates::new(0.0, 0.0),
        forgets: 0,
        paths: Vec::new(),
        counts: Vec::new(),
    };

    /// The map of a page that was not read.
    const NO_MAP: Map<W> = match Map::new(1, 1) {
        Ok(map) => map,
        Err(_) => panic!("a map has at least a word"),
    };

    /// Reads the page of a flash into this one: the newer copy of those that are whole.
    ///
    /// Every byte of a copy is read twice, in pieces of 64.
    ///
    /// # Errors
    /// [`Refused`]; this page is then of no use.
    pub fn load(&mut self, flash: &mut impl ReadNorFlash, slots: Slots) -> Result<Origin, Refused> {
        self.load_as(flash, slots, &mut NoTree)
    }

    /// Reads the page of a robot with a table task: a tree in place of a mission.
    ///
    /// # Errors
    /// [`Refused`]; this page and the tree are then of no use.
    pub fn load_task<L: Copy, const T: usize>(
        &mut self,
        flash: &mut impl ReadNorFlash,
        slots: Slots,
        tree: &mut TreeReader<'_, L, T>,
    ) -> Result<Origin, Refused> {
        self.load_as(flash, slots, tree)
    }

    fn load_as(
        &mut self,
        flash: &mut impl ReadNorFlash,
        slots: Slots,
        tree: &mut impl ReadTree,
    ) -> Result<Origin, Refused> {
        let (origin, start, whole) = slots.choose(flash)?;
        let read = self.read(&mut Source::new(flash, start), whole.length, tree);
        read.map_err(|error| Refused::Content { which: origin.which, error }).map(|()| origin)
    }

    /// Reads one copy of a page from memory.
    ///
    /// # Errors
    /// [`Refused`], where the second copy is missing.
    pub fn load_bytes(&mut self, page: &[u8]) -> Result<Origin, Refused> {
        self.load(&mut Bytes(page), IN_MEMORY)
    }

    /// Reads one copy of a page of a robot with a table task from memory.
    ///
    /// # Errors
    /// [`Refused`], where the second copy is missing.
    pub fn load_task_bytes<L: Copy, const T: usize>(
        &mut self,
        page: &[u8],
        tree: &mut TreeReader<'_, L, T>,
    ) -> Result<Origin, Refused> {
        self.load_task(&mut Bytes(page), IN_MEMORY, tree)
    }

    /// Returns the settings of the robot in an epoch.
    ///
    /// # Errors
    /// [`MemberError`] for a page that was not read.
    pub fn settings(&self, epoch: u32) -> Result<Settings, MemberError> {
        let member = Member::new(self.robot, self.team.into())?;
        Ok(Settings::with_keys(member, self.keys.clone(), epoch, self.tick()).on_channel(self.channel))
    }

    /// Returns the robot.
    #[must_use]
    pub const fn robot(&self) -> RobotId {
        self.robot
    }

    /// Returns the number of robots of its team.
    #[must_use]
    pub const fn team(&self) -> u8 {
        self.team
    }

    /// Returns the least epoch of a start; on a board that cannot count its starts, the epoch. Zero
    /// where nothing was said of it.
    #[must_use]
    pub const fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Returns whether the start of this epoch is the first with this page, to which the robot was
    /// put on its mission's start: its epoch is the least that the page allows, or 1 where the page
    /// says nothing of it. At every other start the robot is wherever it was.
    #[must_use]
    pub const fn is_first_start(&self, epoch: u32) -> bool {
        epoch == if self.epoch == 0 { 1 } else { self.epoch }
    }

    /// Returns the most work units of a tick, if the page says so; see
    /// [`Navigator::with_budget`](crate::Navigator::with_budget).
    #[must_use]
    pub const fn budget(&self) -> Option<NonZero<u32>> {
        self.budget
    }

    /// Returns the period of the robot's ticks, in ticks of its clock.
    #[must_use]
    pub fn tick(&self) -> NonZero<u16> {
        self.tick.unwrap_or(NonZero::<u16>::MIN)
    }

    /// Returns the channel of its team.
    #[must_use]
    pub const fn channel(&self) -> u32 {
        self.channel
    }

    /// Returns the rotation of the keys under which it sends, and of those that it accepts too.
    #[must_use]
    pub const fn rotations(&self) -> (u32, Option<u32>) {
        (self.rotation, self.accepts)
    }

    /// Returns the battery thresholds.
    #[must_use]
    pub const fn thresholds(&self) -> Thresholds {
        self.thresholds
    }

    /// Sets the battery thresholds of a robot, and the work units of its ticks if the page says so.
    pub fn tune<const L: usize, const M: usize, const K: usize>(
        &self,
        navigator: &mut Navigator<'_, S, W, L, M, K>,
    ) {
        navigator.set_thresholds(self.thresholds);
        if let Some(units) = self.budget {
            navigator.navigation_mut().set_budget(units.get());
        }
    }

    /// Returns the measures of the robot and of the grid, if the page has them.
    #[must_use]
    pub const fn chassis(&self) -> Option<Chassis> {
        self.chassis
    }

    /// Returns the paths given by hand for each robot, for [`mission`](Self::mission).
    #[must_use]
    pub fn path_lists(&self) -> Vec<&[Path], MAX_TEAM> {
        let (mut rest, mut lists) = (self.paths.as_slice(), Vec::new());
        for &count in &self.counts {
            let (own, others) = rest.split_at_checked(count.into()).unwrap_or((rest, &[]));
            // There is room for a list of every robot.
            let _ = lists.push(own);
            rest = others;
        }
        lists
    }

    /// Returns the mission. `paths` is what [`path_lists`](Self::path_lists) gives, kept where it
    /// lives as long as the mission.
    #[must_use]
    pub fn mission<'m>(&'m self, paths: &'m [&'m [Path]]) -> Mission<'m, W> {
        Mission {
            own_goals: &self.own_goals,
            need: self.need,
            chargers: &self.chargers,
            waits_for_charging: self.waits_for_charging,
            paths: (!paths.is_empty()).then_some(paths),
            policies: self.policies,
            precision: self.precision,
            sensor: self.sensor,
            sensors: &self.sensors,
            paces: &self.paces,
            learning: self.learning,
            forgets: self.forgets,
            ..Mission::new(self.map.unwrap_or(Self::NO_MAP), &self.starts, &self.goals)
        }
    }

    /// Whether robots of this team can fly the mission: what the controller asks for, and that
    /// paths lead over free cells.
    pub(super) fn check(&self, at: u32) -> Result<(), PageError> {
        let error = |fault| PageError { at, fault };
        let mission = self.mission(&[]);
        mission.check::<S>().map_err(|reason| error(Fault::Mission(reason)))?;
        if self.paths.iter().all(|path| path.is_open(&mission.map)) {
            Ok(())
        } else {
            Err(error(Fault::Value("a path")))
        }
    }
}
