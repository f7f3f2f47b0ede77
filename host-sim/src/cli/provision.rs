//! `provision`: pages of configuration for robots that are flashed.

use super::frames::key;
use super::{Failure, about, print, read, scenario, task};
use bumpalo::Bump;
use clap::Args;
use firmware::adapters::Chassis;
use firmware::missions::reduced;
use firmware::page::{Fault, MAX_PAGE, Origin, Page, PageError, Refused, Size, Slots};
use firmware::{TaskLeaf, Thresholds};
use host_sim::{ANY_SKILL, AnyPage, AnyPageTree, KEY, Provision};
use iibt_core::grid::Cell;
use iibt_core::team::{Key, RobotId};
use iibt_core::tree::{Full, Node, TreeRef};
use std::fmt::Display;
use std::fs;
use std::num::NonZero;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim provision factory --robot 1 --team-key team.key -o robot-1.bin
  host-sim provision my-warehouse.toml --robot R2 --team-key team.key --board stm32f405 -o robot-2.bin
  host-sim provision factory --robot 1 --team-key team.key --rotation 1 --accept 0 --generation 2 -o robot-1.bin
  host-sim provision bottle-and-plate --robot R2 --team-key team.key --task-tree trees.xml -o robot-2.bin
  host-sim provision --show robot-1.bin

A team's key is 32 hexadecimal digits, for example of `openssl rand -hex 16`. The page has the keys of all senders
of the team, derived from it, and not the team's key itself: keep pages as secret as keys. docs/page.md has the
format, how a page comes into the flash, and how keys are exchanged.

Exit status:
  0  the page was written or printed
  2  it could not be, or wrong usage or input";

#[derive(Args, Debug)]
pub(super) struct WritePage {
    /// What the team does: a built-in scenario or task, or a file with one
    #[arg(value_name = "NAME|FILE.toml", required_unless_present = "show")]
    mission: Option<String>,
    /// The robot, by its number from 1, or by its name
    #[arg(long, value_name = "N|NAME", required_unless_present = "show")]
    robot: Option<String>,
    /// The tree of the robot of a task: the one with its name in this file, else the main tree; its
    /// aims one after the other if left out
    #[arg(long, value_name = "FILE.xml")]
    task_tree: Option<String>,
    /// The file to write
    #[arg(long, short, value_name = "FILE", required_unless_present = "show")]
    output: Option<PathBuf>,
    /// Print what a page holds, but for its keys
    #[arg(long, value_name = "FILE", conflicts_with_all = ["mission", "robot", "output"])]
    show: Option<String>,
    /// The team's key: 32 hexadecimal digits, or a file with them
    #[arg(long, value_name = "HEX|FILE")]
    team_key: Option<String>,
    /// The number of the keys under which robots send
    #[arg(long, value_name = "N", default_value_t = 0)]
    rotation: u32,
    /// The number of other keys that are accepted too, while keys are exchanged
    #[arg(long, value_name = "N")]
    accept: Option<u32>,
    /// A number that tells teams with one key apart
    #[arg(long, value_name = "N", default_value_t = 0)]
    channel: u32,
    /// The milliseconds between two ticks of the controller
    #[arg(long, value_name = "MS", default_value = "100")]
    tick: NonZero<u16>,
    /// The least epoch of the next start; on a board that cannot count its starts, the epoch
    #[arg(long, value_name = "N", default_value_t = 0)]
    epoch: u32,
    /// The most work units of the planner in a tick, in place of the scenario's or the image's own
    #[arg(long, value_name = "UNITS")]
    budget: Option<NonZero<u32>>,
    /// The measures of the robot: the side of a cell and the track in metres, the speed in metres
    /// per second, and the duty cycle in percent for it; in place of the image's own
    #[arg(long, value_name = "CELL,TRACK,SPEED,DUTY", value_parser = chassis)]
    chassis: Option<Chassis>,
    /// The number of this page: of two copies the one with the higher number counts
    #[arg(long, value_name = "N", default_value_t = 1)]
    generation: u32,
    /// Say how the page comes into the flash of this board
    #[arg(long, value_name = "BOARD", value_parser = board)]
    board: Option<Board>,
}

/// The boards: the name, the chip, where the flash begins in memory, and where the copies lie in
/// it.
const BOARDS: [Board; 5] = [
    ("stm32f405", "STM32F405RG", 0x0800_0000, Slots::STM32F405),
    (REDUCED, "nRF51822_xxAC", 0, Slots::NRF51822),
    ("nrf52840", "nRF52840_xxAA", 0, Slots::NRF52840),
    ("rp2040", "RP2040", 0x1000_0000, Slots::RP2040),
    ("esp32c3", "esp32c3", 0, Slots::ESP32C3),
];

type Board = (&'static str, &'static str, u32, Slots);

/// The board whose image is the reduced one.
const REDUCED: &str = "nrf51822";

impl WritePage {
    pub(super) fn run(&self) -> Result<(), Failure> {
        if let Some(file) = &self.show {
            return show(file);
        }
        let (Some(mission), Some(robot), Some(output)) = (&self.mission, &self.robot, &self.output) else {
            return Err("a mission or a task, --robot and --output are needed".into());
        };
        let page = match task::text_of(mission)? {
            Some(text) => self.page_of_task(mission, &text, robot)?,
            None => self.page_of_mission(mission, robot)?,
        };
        if let Some((name @ REDUCED, _, _, slots)) = self.board {
            fits_reduced(&page, slots).map_err(about(format_args!("{mission}, board {name}")))?;
        }
        fs::write(output, &page).map_err(about(output.display()))?;
        let mut text = format!("{} bytes in {}\n", page.len(), output.display());
        if let Some((_, chip, begin, slots)) = self.board {
            for at in [slots.first, slots.second].map(|slot| begin + slot) {
                text += &format!(
                    "probe-rs download --chip {chip} --binary-format bin --base-address {at:#010x} {}\n",
                    output.display()
                );
            }
        }
        Ok(print(&text)?)
    }

    fn page_of_mission(&self, mission: &str, robot: &str) -> Result<Vec<u8>, Failure> {
        let scenario = scenario(mission)?;
        if self.task_tree.is_some() {
            return Err(format!("{mission}: --task-tree is for tasks, and this is a scenario").into());
        }
        let names: Vec<_> = scenario.robots.iter().map(|robot| robot.name.as_str()).collect();
        let provision = self.provision(robot_of(robot, &scenario.name, &names)?)?;
        Ok(provision.page(&scenario).map_err(about(&scenario.name))?)
    }

    fn page_of_task(&self, name: &str, text: &str, robot: &str) -> Result<Vec<u8>, Failure> {
        let arena = Bump::new();
        let task = task::mission(&arena, name, text, self.task_tree.as_deref())?;
        let names: Vec<_> = task.tables.roles().iter().map(|role| role.name).collect();
        let provision = self.provision(robot_of(robot, name, &names)?)?;
        Ok(provision.page_of_task(&task).map_err(about(name))?)
    }

    fn provision(&self, robot: RobotId) -> Result<Provision, Failure> {
        Ok(Provision {
            rotation: self.rotation,
            accepts: self.accept,
            channel: self.channel,
            tick: self.tick,
            epoch: self.epoch,
            budget: self.budget,
            chassis: self.chassis,
            generation: self.generation,
            ..Provision::new(robot, self.key()?)
        })
    }

    fn key(&self) -> Result<Key, Failure> {
        let Some(given) = &self.team_key else {
            eprintln!("warning: without --team-key, the keys are the simulator's, which everybody knows");
            return Ok(KEY);
        };
        let digits = match key(given) {
            Ok(bytes) => return Ok(Key::new(bytes)),
            Err(_) => String::from_utf8(read(given, 1 << 10)?).map_err(about(given))?,
        };
        Ok(Key::new(key(digits.trim()).map_err(about(given))?))
    }
}

/// Whether the reduced image flies what is in a page, which lies in a slot of its flash.
fn fits_reduced(bytes: &[u8], slots: Slots) -> Result<(), String> {
    let room = slots.second - slots.first;
    if bytes.len() > room as usize {
        return Err(format!("a page of {} bytes, and there is room for {room}", bytes.len()));
    }
    let mut page = Page::<{ reduced::CELLS }, { reduced::WORDS }, { reduced::ALL_PATHS }>::EMPTY;
    page.load_bytes(bytes).map_err(|refused| refused.to_string())?;
    let lists = page.path_lists();
    let mission = page.mission(&lists);
    let settings = page.settings(1).map_err(|error| error.to_string())?;
    let robot = reduced::Robot::new(&mission, &settings);
    robot.map(drop).map_err(|error| error.to_string())
}

/// A robot by its name, or by its number from 1.
fn robot_of(text: &str, team: &str, names: &[&str]) -> Result<RobotId, String> {
    let by_name = names.iter().position(|&name| name == text);
    let by_number = || text.parse::<usize>().ok()?.checked_sub(1).filter(|&at| at < names.len());
    let robot = by_name.or_else(by_number).ok_or_else(|| {
        format!("{team}: no robot {text}: there are {}, or 1 to {}", names.join(", "), names.len())
    })?;
    Ok(RobotId(robot as u8))
}

/// What a page holds, a row each.
#[derive(Default)]
struct Rows(String);

impl Rows {
    fn push(&mut self, name: &str, value: impl Display) {
        self.0 += &format!("{name:<12} {value}\n");
    }

    /// Which robot it is, and of how many.
    fn push_robot(&mut self, page: &AnyPage, origin: &Origin, team: u8) {
        self.push("generation", origin.generation);
        self.push("robot", format!("{} of {team}", page.robot().0 + 1));
    }

    fn push_mission(&mut self, page: &AnyPage) {
        let lists = page.path_lists();
        let mission = page.mission(&lists);
        let (map, need) = (&mission.map, mission.need);
        self.push("mission", format!("{:016x}", mission.id()));
        let free = map.free_cells().len();
        self.push("map", format!("{} x {} cells, {free} free", map.width(), map.height()));
        let some = |list: &[Cell]| cells(&list.iter().copied().map(Some).collect::<Vec<_>>());
        self.push("starts", some(mission.starts));
        self.push("goals", some(mission.goals));
        self.push("own goals", cells(mission.own_goals));
        self.push("chargers", cells(mission.chargers));
        self.push("need", need.map_or("as many as there are".to_owned(), |need| need.to_string()));
        self.push("paces", format!("{:?}", mission.paces));
        self.push("sensors", format!("{} {:?}", mission.sensor, mission.sensors));
        self.push("policies", format!("{}, precision {}", mission.policies, mission.precision));
        self.push("paths", format!("{:?}", lists.iter().map(|own| own.len()).collect::<Vec<_>>()));
    }

    /// The tree, a line for each node.
    fn push_tree(&mut self, task: u64, tree: TreeRef<'_, TaskLeaf<u8>, Full>) {
        self.push("task", format!("{task:016x}"));
        let visits = tree.visits(&mut vec![(0, 0); tree.nodes().len()]);
        self.push("tree", format!("{} nodes, at most {visits} visits in a tick", tree.nodes().len()));
        for (number, node) in (0..).zip(tree.nodes()) {
            let depth = std::iter::successors(tree.parent(number), |&parent| tree.parent(parent)).count();
            self.push("", "  ".repeat(depth) + &node_text(node));
        }
    }

    /// What every page has.
    fn push_settings(&mut self, page: &AnyPage) {
        let (rotation, accepts) = page.rotations();
        let also = accepts.map_or_else(String::new, |also| format!(" and {also}"));
        self.push("keys", format!("rotation {rotation}{also}, hidden"));
        self.push("channel", page.channel());
        self.push("tick", format!("{} ms", page.tick()));
        self.push(
            "epoch",
            match page.epoch() {
                0 => "counted by the board".to_owned(),
                epoch => format!("at least {epoch}"),
            },
        );
        self.push(
            "budget",
            page.budget().map_or("the image's own".to_owned(), |units| format!("{units} units")),
        );
        let Thresholds { low, charged } = page.thresholds();
        self.push("battery", format!("leaves below {low} %, back at {charged} %"));
        self.push("chassis", page.chassis().map_or("the board's own".to_owned(), |own| format!("{own:?}")));
    }
}

/// A node and what it holds.
fn node_text(node: &Node<TaskLeaf<u8>>) -> String {
    let debug = format!("{node:?}");
    let kind = debug.split(['(', ' ']).next().unwrap_or_default();
    match node {
        Node::Action(leaf) | Node::Inference(leaf) | Node::Condition(leaf) => format!("{kind} {leaf}"),
        Node::Switch(children, leaf) => format!("{kind}({children}) by {leaf}"),
        Node::Precondition { condition, otherwise } => format!("{kind} {condition}, else {otherwise:?}"),
        Node::RetryUntilSuccessful(times) | Node::Repeat(times) => format!("{kind}({})", times.get()),
        Node::Timeout(time) | Node::Delay(time) | Node::RateController(time) | Node::Sleep(time) => {
            format!("{kind}({} ms)", time.get())
        }
        _ => debug,
    }
}

fn cells(cells: &[Option<Cell>]) -> String {
    let cells = cells.iter().map(|cell| cell.map_or("-".to_owned(), |cell| cell.0.to_string()));
    cells.collect::<Vec<_>>().join(" ")
}

fn show(file: &str) -> Result<(), Failure> {
    let bytes = read(file, MAX_PAGE.into())?;
    let (mut page, mut tree, mut rows) = (AnyPage::EMPTY, AnyPageTree::EMPTY, Rows::default());
    match page.load_bytes(&bytes) {
        Ok(origin) => {
            rows.push_robot(&page, &origin, page.team());
            rows.push_mission(&page);
        }
        // A page with a tree is one of a robot with a table task.
        Err(Refused::Content {
            error: PageError { fault: Fault::TooLarge { size: Size::Nodes, .. }, .. },
            ..
        }) => {
            let mut reader = tree.of_any_task(&ANY_SKILL);
            let origin = page.load_task_bytes(&bytes, &mut reader).map_err(about(file))?;
            rows.push_robot(&page, &origin, page.team());
            if let Some((task, tree)) = tree.task().zip(tree.by_ref()) {
                rows.push_tree(task, tree);
            }
        }
        Err(refused) => return Err(format!("{file}: {refused}").into()),
    }
    rows.push_settings(&page);
    Ok(print(&rows.0)?)
}

fn chassis(text: &str) -> Result<Chassis, String> {
    let parsed = || {
        let mut parts = text.split(',');
        let mut measure =
            || parts.next()?.parse().ok().filter(|&length: &f32| length.is_finite() && length > 0.0);
        let (cell, track, speed) = (measure()?, measure()?, measure()?);
        let duty = parts.next()?.parse().ok().filter(|&duty| duty <= 100)?;
        parts.next().is_none().then_some(Chassis { cell, track, speed, duty })
    };
    parsed().ok_or_else(|| {
        "a chassis is three lengths over zero and a duty cycle up to 100: 0.5,0.1,0.25,60".to_owned()
    })
}

fn board(text: &str) -> Result<Board, String> {
    let names = BOARDS.map(|(name, ..)| name).join(", ");
    let known = BOARDS.into_iter().find(|(name, ..)| *name == text);
    known.ok_or_else(|| format!("no board is called '{text}': there are {names}"))
}
