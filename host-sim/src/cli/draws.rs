//! What the verbs that draw missions share: which are drawn, and where they go.

use super::{Failure, about, print, seed};
use clap::Args;
use host_sim::MAX_TICKS;
use iibt_core::team::MAX_TEAM;
use std::fs;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::str::FromStr;

#[derive(Args, Debug)]
pub(super) struct Draws {
    /// The ticks after which the missions count as not accomplished
    #[arg(long, value_name = "TICKS", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_TICKS)))]
    pub limit: u32,
    /// The seed of the first mission; the next one takes the next seed
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 0)]
    seed: u64,
    /// How many missions, into a folder
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000), requires = "out")]
    count: u32,
    /// A new or empty folder for the files, named by their seeds; else the mission is printed
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
}

impl Draws {
    /// Prints the mission that `draw` makes of the seed, or writes those of all seeds.
    pub(super) fn write<E: Into<Failure>>(
        &self,
        draw: impl Fn(u64) -> Result<String, E>,
    ) -> Result<(), Failure> {
        let draw = |seed| draw(seed).map_err(Into::into);
        let Some(folder) = &self.out else { return Ok(print(&draw(self.seed)?)?) };
        let named = |reason: &dyn std::fmt::Display| format!("{}: {reason}", folder.display());
        fs::create_dir_all(folder).map_err(|error| named(&error))?;
        if fs::read_dir(folder).map_err(|error| named(&error))?.next().is_some() {
            return Err(named(&"not empty: missions are written into a new or an empty folder").into());
        }
        let last =
            self.seed.checked_add(u64::from(self.count - 1)).ok_or("the last seed is over 2^64 - 1")?;
        let digits = last.to_string().len();
        for seed in self.seed..=last {
            let file = folder.join(format!("{seed:0digits$}.toml"));
            fs::write(&file, draw(seed)?).map_err(about(file.display()))?;
        }
        Ok(print(&format!("{} missions in {}\n", self.count, folder.display()))?)
    }
}

/// A number, or two with `..` between them.
pub(super) fn range<T: FromStr + Copy + PartialOrd>(text: &str) -> Option<RangeInclusive<T>> {
    let (least, most) = text.split_once("..").unwrap_or((text, text));
    let (least, most) = (least.parse().ok()?, most.parse().ok()?);
    (least <= most).then_some(least..=most)
}

/// A number of robots, or a range.
pub(super) fn robots(text: &str) -> Result<RangeInclusive<usize>, String> {
    let is_team = |range: &RangeInclusive<usize>| *range.start() >= 1 && *range.end() <= MAX_TEAM;
    let reason = || format!("a number of robots is 1 to {MAX_TEAM}, or LEAST..MOST");
    range(text).filter(is_team).ok_or_else(reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_teams_are_read_and_what_is_wrong_is_refused() {
        assert_eq!((range("3"), range("0.1..2")), (Some(3..=3), Some(0.1..=2.0)));
        assert_eq!(robots("2..8"), Ok(2..=8));
        assert!(["0", "9", "4..2", "", "2..9"].iter().all(|wrong| robots(wrong).is_err()));
    }
}
