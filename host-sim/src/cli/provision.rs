//! `provision`: pages of configuration for robots that are flashed.

use super::frames::key;
use super::{Failure, about, print, read, scenario};
use clap::Args;
use firmware::adapters::Chassis;
use firmware::page::{MAX_PAGE, Slots};
use host_sim::{AnyPage, KEY, Provision, Scenario};
use iibt_core::team::{Key, RobotId};
use std::fs;
use std::num::NonZero;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim provision factory --robot 1 --team-key team.key -o robot-1.bin
  host-sim provision my-warehouse.toml --robot R2 --team-key team.key --board stm32f405 -o robot-2.bin
  host-sim provision factory --robot 1 --team-key team.key --rotation 1 --accept 0 --generation 2 -o robot-1.bin
  host-sim provision --show robot-1.bin

A team's key is 32 hexadecimal digits, for example of `openssl rand -hex 16`. The page has the keys of all senders
of the team, derived from it, and not the team's key itself: keep pages as secret as keys. docs/page.md has the
format, how a page comes into the flash, and how keys are exchanged.

Exit status:
  0  the page was written or printed
  2  it could not be, or wrong usage or input";

#[derive(Args, Debug)]
pub(super) struct WritePage {
    /// The mission that the team flies: a built-in scenario, or a scenario file
    #[arg(value_name = "NAME|FILE.toml", required_unless_present = "show")]
    mission: Option<String>,
    /// The robot, by its number on the map, from 1, or by its name
    #[arg(long, value_name = "N|NAME", required_unless_present = "show")]
    robot: Option<String>,
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
const BOARDS: [Board; 4] = [
    ("stm32f405", "STM32F405RG", 0x0800_0000, Slots::STM32F405),
    ("nrf52840", "nRF52840_xxAA", 0, Slots::NRF52840),
    ("rp2040", "RP2040", 0x1000_0000, Slots::RP2040),
    ("esp32c3", "esp32c3", 0, Slots::ESP32C3),
];

type Board = (&'static str, &'static str, u32, Slots);

impl WritePage {
    pub(super) fn run(&self) -> Result<(), Failure> {
        if let Some(file) = &self.show {
            return show(file);
        }
        let (Some(mission), Some(robot), Some(output)) = (&self.mission, &self.robot, &self.output) else {
            return Err("a mission, --robot and --output are needed".into());
        };
        let scenario = scenario(mission)?;
        let page = self.provision(robot, &scenario)?.page(&scenario).map_err(about(&scenario.name))?;
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

    fn provision(&self, robot: &str, scenario: &Scenario) -> Result<Provision, Failure> {
        Ok(Provision {
            rotation: self.rotation,
            accepts: self.accept,
            channel: self.channel,
            tick: self.tick,
            epoch: self.epoch,
            budget: self.budget,
            chassis: self.chassis,
            generation: self.generation,
            ..Provision::new(robot_of(robot, scenario)?, self.key()?)
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

/// A robot by its name, or by its number on the map.
fn robot_of(text: &str, scenario: &Scenario) -> Result<RobotId, String> {
    let by_name = scenario.robots.iter().position(|robot| robot.name == text);
    let by_number = || text.parse::<usize>().ok()?.checked_sub(1).filter(|&at| at < scenario.robots.len());
    let robot = by_name.or_else(by_number).ok_or_else(|| {
        let names: Vec<_> = scenario.robots.iter().map(|robot| robot.name.as_str()).collect();
        format!("{}: no robot {text}: there are {}, or 1 to {}", scenario.name, names.join(", "), names.len())
    })?;
    Ok(RobotId(robot as u8))
}

fn show(file: &str) -> Result<(), Failure> {
    let bytes = read(file, MAX_PAGE.into())?;
    let mut page = AnyPage::EMPTY;
    let origin = page.load_bytes(&bytes).map_err(about(file))?;
    let lists = page.path_lists();
    let mission = page.mission(&lists);
    let (rotation, accepts) = page.rotations();
    let cells = |cells: &[Option<iibt_core::grid::Cell>]| {
        let cells = cells.iter().map(|cell| cell.map_or("-".to_owned(), |cell| cell.0.to_string()));
        cells.collect::<Vec<_>>().join(" ")
    };
    let some = |list: &[iibt_core::grid::Cell]| cells(&list.iter().copied().map(Some).collect::<Vec<_>>());
    let mut text = format!("generation   {}\n", origin.generation);
    let mut row = |name: &str, value: String| text += &format!("{name:<12} {value}\n");
    row("robot", format!("{} of {}", page.robot().0 + 1, mission.team()));
    row("mission", format!("{:016x}", mission.id()));
    row(
        "map",
        format!(
            "{} x {} cells, {} free",
            mission.map.width(),
            mission.map.height(),
            mission.map.free_cells().len()
        ),
    );
    row("starts", some(mission.starts));
    row("goals", some(mission.goals));
    row("own goals", cells(mission.own_goals));
    row("chargers", cells(mission.chargers));
    row("need", mission.need.map_or("as many as there are".to_owned(), |need| need.to_string()));
    row("paces", format!("{:?}", mission.paces));
    row("sensors", format!("{} {:?}", mission.sensor, mission.sensors));
    row("policies", format!("{}, precision {}", mission.policies, mission.precision));
    row("paths", format!("{:?}", lists.iter().map(|own| own.len()).collect::<Vec<_>>()));
    row(
        "keys",
        format!(
            "rotation {rotation}{}, hidden",
            accepts.map_or_else(String::new, |also| format!(" and {also}"))
        ),
    );
    row("channel", page.channel().to_string());
    row("tick", format!("{} ms", page.tick()));
    row(
        "epoch",
        if page.epoch() == 0 {
            "counted by the board".to_owned()
        } else {
            format!("at least {}", page.epoch())
        },
    );
    row("budget", page.budget().map_or("the image's own".to_owned(), |units| format!("{units} units")));
    row(
        "battery",
        format!("leaves below {} %, back at {} %", page.thresholds().low, page.thresholds().charged),
    );
    row("chassis", page.chassis().map_or("the board's own".to_owned(), |own| format!("{own:?}")));
    Ok(print(&text)?)
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
