//! `missions`: random missions, as scenario files.

use super::draws::{Draws, range, robots};
use super::{Failure, scenario};
use clap::Args;
use host_sim::MAX_CELLS;
use host_sim::missions::{Ground, RandomMissions};
use iibt_core::navigation::MAX_GOALS;
use std::ops::RangeInclusive;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim missions --robots 4                         a mission on 8x8 cells with 15 % walls
  host-sim missions --robots 4 --count 500 --out random-4
  host-sim campaign random-4 --tree inference --disturbance none
  host-sim missions --map factory --robots 2..5 --count 100 --out floor
  host-sim missions --size 2x2..4x4 --walls 0..0.3 --robots 2..4 --owned --solvable --seed 7

A range LEAST..MOST is drawn from for each mission. Starts and goals are in the largest part of the
map between which ways lead. Not all robots stand on goals at the start.

Exit status:
  0  all missions were drawn
  2  one could not be, or wrong usage or input";

#[derive(Args, Debug)]
pub(super) struct Missions {
    /// The columns and rows of the map, or a range, as in 2x2..4x4
    #[arg(long, value_name = "WxH", default_value = "8x8", value_parser = size, conflicts_with = "map")]
    size: Size,
    /// The share of cells that are blocked, or a range, as in 0..0.3
    #[arg(long, value_name = "SHARE", default_value = "0.15", value_parser = walls, conflicts_with = "map")]
    walls: RangeInclusive<f64>,
    /// Draw robots and goals on the map of this scenario, in place of its own
    #[arg(long, value_name = "NAME|FILE.toml")]
    map: Option<String>,
    /// The number of robots, or a range, as in 2..4
    #[arg(long, value_name = "N", default_value = "3", value_parser = robots)]
    robots: RangeInclusive<usize>,
    /// The number of goals; one for each robot unless set
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=MAX_GOALS as i64), conflicts_with = "owned")]
    goals: Option<u8>,
    /// Each robot owns one of the goals
    #[arg(long)]
    owned: bool,
    /// Only missions that a search over all joint states solves without a robot that enters a cell
    /// which another leaves
    #[arg(long)]
    solvable: bool,
    #[command(flatten)]
    draws: Draws,
}

#[derive(Clone, Debug)]
struct Size {
    width: RangeInclusive<u16>,
    height: RangeInclusive<u16>,
}

impl Missions {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let kind = self.kind()?;
        self.draws.write(|seed| kind.draw(seed))
    }

    fn kind(&self) -> Result<RandomMissions, Failure> {
        let ground = match &self.map {
            Some(name) => Ground::Given(Box::new(scenario(name)?.map)),
            None => Ground::Drawn {
                width: self.size.width.clone(),
                height: self.size.height.clone(),
                walls: self.walls.clone(),
            },
        };
        Ok(RandomMissions {
            ground,
            robots: self.robots.clone(),
            goals: self.goals.map(usize::from),
            is_owned: self.owned,
            is_solvable: self.solvable,
            limit: self.draws.limit,
        })
    }
}

fn size(text: &str) -> Result<Size, String> {
    let (least, most) = text.split_once("..").unwrap_or((text, text));
    let sides =
        |text: &str| text.split_once('x').map(|(width, height)| (width.to_owned(), height.to_owned()));
    let read = sides(least).zip(sides(most)).and_then(|(least, most)| {
        let width = range(&format!("{}..{}", least.0, most.0))?;
        Some(Size { width, height: range(&format!("{}..{}", least.1, most.1))? })
    });
    let cells = |width: u16, height: u16| usize::from(width) * usize::from(height);
    let fits = |size: &Size| {
        cells(*size.width.start(), *size.height.start()) >= 2
            && cells(*size.width.end(), *size.height.end()) <= MAX_CELLS
    };
    let reason = || format!("a size is WxH or WxH..WxH, with 2 to {MAX_CELLS} cells");
    read.filter(fits).ok_or_else(reason)
}

fn walls(text: &str) -> Result<RangeInclusive<f64>, String> {
    let is_share = |range: &RangeInclusive<f64>| *range.start() >= 0.0 && *range.end() < 1.0;
    let reason = "a share of walls is a number from 0 to below 1, or LEAST..MOST";
    range(text).filter(is_share).ok_or_else(|| reason.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_shares_are_read_and_what_is_wrong_is_refused() {
        let both = size("2x3..4x5").expect("a range");
        assert_eq!((both.width, both.height), (2..=4, 3..=5));
        assert!(size("32x32").is_ok() && size("1024x1").is_ok());
        for wrong in ["", "8", "8x", "1x1", "33x32", "4x4..3x5", "2x2..", "8x8x8", "-1x8", "0x9"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(walls("0..0.3"), Ok(0.0..=0.3));
        assert!(["1", "-0.1", "NaN", "0.3..0.2", "x"].iter().all(|wrong| walls(wrong).is_err()));
    }
}
