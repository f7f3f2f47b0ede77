//! `family`: random missions with something unknown, as scenario files.

use super::draws::{Draws, range, robots};
use super::{Failure, about, print, probability};
use clap::{Args, ValueEnum};
use host_sim::families::{Family, FamilyMissions};
use std::ops::RangeInclusive;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim family                                      the families, one a line
  host-sim family sign                                 a mission with a sign, printed
  host-sim family sign --right 0.9 --count 500 --out signs
  host-sim campaign signs --tree inference --disturbance none
  host-sim family gates --robots 2..5 --seed 7

A range LEAST..MOST is drawn from for each mission. A mission can be accomplished whatever the
values of its unknowns. Files leave these open: the seed of a flight draws them from the prior.

Exit status:
  0  all missions were drawn, or the families were listed
  2  one could not be, or wrong usage or input";

#[derive(Args, Debug)]
pub(super) struct DrawFamily {
    /// The family; all are listed unless one is named
    #[arg(value_name = "NAME", value_enum)]
    family: Option<Family>,
    /// The number of robots, or a range, as in 2..4; the family's own unless set
    #[arg(long, value_name = "N", value_parser = robots)]
    robots: Option<RangeInclusive<usize>>,
    /// The number of goals that must be held at the end, or a range; the family's own unless set
    #[arg(long, value_name = "N", value_parser = need)]
    need: Option<RangeInclusive<usize>>,
    /// The probability that a reading is right, over 0.5 and up to 1
    #[arg(long, value_name = "P", default_value_t = 1.0, value_parser = probability)]
    right: f64,
    #[command(flatten)]
    draws: Draws,
}

impl DrawFamily {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let Some(family) = self.family else { return self.list() };
        let usual = FamilyMissions::of(family);
        let missions = FamilyMissions {
            family,
            robots: self.robots.clone().unwrap_or(usual.robots),
            need: self.need.clone().or(usual.need),
            right: self.right,
            limit: self.draws.limit,
        };
        let (name, _) = described(family);
        self.draws.write(|seed| missions.draw(seed).map_err(about(&name)))
    }

    /// Prints the families, one a line.
    fn list(&self) -> Result<(), Failure> {
        let families: Vec<_> = Family::value_variants().iter().map(|&family| described(family)).collect();
        if self.draws.out.is_some() {
            let names: Vec<_> = families.iter().map(|(name, _)| name.as_str()).collect();
            return Err(
                format!("--out is for the missions of a family: name one of {}", names.join(", ")).into()
            );
        }
        let longest = families.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        let line = |(name, about): &(String, String)| format!("{name:<longest$}  {about}\n");
        Ok(print(&families.iter().map(line).collect::<String>())?)
    }
}

/// The name of a family on the command line, and what it is.
fn described(family: Family) -> (String, String) {
    let value = family.to_possible_value();
    let about = value.as_ref().and_then(|value| value.get_help()).map(ToString::to_string);
    (value.map(|value| value.get_name().to_owned()).unwrap_or_default(), about.unwrap_or_default())
}

/// A number of goals, or a range.
fn need(text: &str) -> Result<RangeInclusive<usize>, String> {
    let reason = "a number of goals is 1 or more, or LEAST..MOST";
    range(text).filter(|range| *range.start() >= 1).ok_or_else(|| reason.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_goals_are_read_and_what_is_wrong_is_refused() {
        assert_eq!((need("2"), need("1..2")), (Ok(2..=2), Ok(1..=2)));
        assert!(["0", "", "2..1", "-1", "1.5", "0..2"].iter().all(|wrong| need(wrong).is_err()));
    }

    #[test]
    fn families_have_names_and_descriptions() {
        let all: Vec<_> = Family::value_variants().iter().map(|&family| described(family)).collect();
        let names: Vec<_> = all.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["sign", "rooms", "gates", "search", "floor", "far-sign"]);
        assert!(all.iter().all(|(_, about)| about.len() > 20 && !about.contains('\n')), "{all:?}");
    }
}
