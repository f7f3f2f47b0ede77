//! `campaign`: a mission flown many times, or many missions, by the inference node and by a
//! conventional tree.

use super::{Failure, about, exit_status, note_conventional, report, scenario, task};
use clap::{Args, ValueEnum};
use host_sim::campaign::{Ablation, Campaign, Disturbance};
use host_sim::{Pilot, Scenario};
use std::fs;
use std::io::{self, IsTerminal, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  host-sim campaign factory                            both trees, every disturbance, 500 seeds
  host-sim campaign warehouse --disturbance loss --seeds 2000
  host-sim missions --robots 4 --count 500 --out random-4 && host-sim campaign random-4 --disturbance bursts
  host-sim campaign factory --tree inference --json | jq '.rows[].summaries[0].accomplished'
  host-sim campaign sign.toml --ablate                 what inference is worth there, by parts and against rules
  host-sim campaign sign.toml --ablate no-branching,likeliest --disturbance loss

Disturbances, drawn from the seed and the same for both trees:
  none       the scenario as it is
  noise      localisers are wrong in 10 % of all readings
  slips      moves fail with 10 %
  loss       the radio loses 30 % of all frames
  bursts     the same in bursts, ten frames on average
  obstacles  three obstacles appear where ways around them are left
  battery    the battery of one robot falls to 15 %
  pause      one robot stops for 20 to 39 ticks
  stop       one robot stops for good
  all        all of them but bursts and stop, in one flight of up to three times the limit
and, which `every` leaves out because the robot that is struck does not arrive:
  frozen     the localiser of one robot freezes for good
  stalled    the drive of one robot stalls for good

With --ablate the same seeds are flown with a part of the decision taken out, or with a rule in its
place; `all` are the `parts`,
{parts}
and the `rules`:
{rules}

In a folder, the first seed flies the first file by name, and after the last file the first again.

A task file is flown at levels of 0, 10, 20 and 30 % of wrong readings and of failed actions,
without --tree, --disturbance and --ablate. Its exit status is 0 at any share of success.

Exit status:
  0  no flight of the inference node had a collision
  1  one had
  2  wrong usage or input";

/// The examples, with a line for each decider.
pub(super) fn examples() -> String {
    let line = |ablation: &Ablation| format!("  {:<17}  {}\n", ablation.name, ablation.what());
    let lines = |of: &[Ablation]| of.iter().map(line).collect::<String>();
    let (parts, rules) = (lines(Ablation::PARTS), lines(Ablation::RULES));
    EXAMPLES.replace("{parts}", parts.trim_end()).replace("{rules}", rules.trim_end())
}

/// The seeds of a campaign, unless told otherwise.
const SEEDS: u32 = 500;

#[derive(Args, Debug)]
pub(super) struct FlyMany {
    /// A built-in scenario or task, a file with one, or a folder of scenario files
    #[arg(value_name = "NAME|FILE.toml|FOLDER")]
    scenario: String,
    /// How many seeds, from zero on; 500 unless set, and of a folder as many as it has files
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    seeds: Option<u32>,
    /// The tree that flies the robots
    #[arg(long, value_name = "TREE", value_enum, default_value_t = CampaignTrees::Both)]
    tree: CampaignTrees,
    /// Also fly with other deciders where something is unknown, and tell how much more they take:
    /// `all` of them, `parts`, `rules`, or names with commas between them
    #[arg(long, value_name = "NAMES", num_args = 0..=1, default_missing_value = "all", value_parser = ablations, conflicts_with = "tree")]
    ablate: Option<AblationList>,
    /// The disturbance; `every` takes them one after the other, as without --ablate
    #[arg(long, value_name = "NAME", value_parser = disturbances)]
    disturbance: Option<DisturbanceList>,
    /// The work units of the planner in a tick, in place of the scenario's
    #[arg(long, value_name = "UNITS", value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    budget: Option<u32>,
    /// How many threads fly; the figures do not depend on it
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Print one JSON object with all figures, and nothing else
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CampaignTrees {
    /// The inference node and the conventional tree of figure 8
    Both,
    /// The firmware's tree, with one inference node
    Inference,
    /// The same with the sizes of plans that images have; maps of at most 64 cells
    Image,
    /// The same with frames of at most 64 bytes
    Compact,
    /// The conventional tree of figure 8
    Conventional,
    /// The conventional tree of figure 5(a), for two goals
    #[value(name = "figure-5")]
    Figure5,
}

impl CampaignTrees {
    fn pilots(self) -> Vec<Pilot> {
        match self {
            Self::Both => vec![Pilot::Inference, Pilot::Conventional],
            Self::Inference => vec![Pilot::Inference],
            Self::Image => vec![Pilot::Image],
            Self::Compact => vec![Pilot::Compact],
            Self::Conventional => vec![Pilot::Conventional],
            Self::Figure5 => vec![Pilot::Figure5],
        }
    }
}

#[derive(Clone, Debug)]
struct DisturbanceList(Vec<Disturbance>);

fn disturbances(name: &str) -> Result<DisturbanceList, String> {
    if name == "every" {
        return Ok(DisturbanceList(Disturbance::USUAL.to_vec()));
    }
    disturbance(name).map(|one| DisturbanceList(vec![one])).map_err(|reason| reason + ", every")
}

#[derive(Clone, Debug)]
struct AblationList(Vec<&'static Ablation>);

fn ablations(names: &str) -> Result<AblationList, String> {
    let mut all = Vec::new();
    for name in names.split(',') {
        match name {
            "all" => all.extend(Ablation::all()),
            "parts" => all.extend(Ablation::PARTS),
            "rules" => all.extend(Ablation::RULES),
            name => all.push(ablation(name).map_err(|error| format!("{error}, or all, parts, rules"))?),
        }
    }
    let mut once = Vec::new();
    for ablation in all {
        if !once.contains(&ablation) {
            once.push(ablation);
        }
    }
    Ok(AblationList(once))
}

/// The ablation with a name.
pub(super) fn ablation(name: &str) -> Result<&'static Ablation, String> {
    Ablation::find(name).ok_or_else(|| {
        let names: Vec<_> = Ablation::all().map(|ablation| ablation.name).collect();
        format!("there is no '{name}': there are {}", names.join(", "))
    })
}

/// The scenarios that an argument names: one, or those of a folder in the order of their names.
fn scenarios(name: &str) -> Result<Vec<Scenario>, Failure> {
    let folder = Path::new(name);
    if host_sim::library::find(name).is_some() || !folder.is_dir() {
        return Ok(vec![scenario(name)?]);
    }
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let mut files: Vec<PathBuf> = entries.map_err(about(name))?.iter().map(fs::DirEntry::path).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    if files.is_empty() {
        return Err(format!("{name}: no file in this folder ends in .toml").into());
    }
    files.iter().map(|file| scenario(&file.to_string_lossy())).collect()
}

/// The disturbance with a name.
pub(super) fn disturbance(name: &str) -> Result<Disturbance, String> {
    let names = || Disturbance::all().map(Disturbance::name).collect::<Vec<_>>().join(", ");
    Disturbance::find(name).ok_or_else(|| format!("there are {}", names()))
}

impl FlyMany {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        if let Some(text) = task::text_of(&self.scenario)? {
            return self.fly_task(&text);
        }
        let mut scenarios = scenarios(&self.scenario)?;
        for scenario in &mut scenarios {
            scenario.inference.budget = self.budget.or(scenario.inference.budget);
        }
        if self.ablate.is_some() && scenarios.iter().all(|scenario| scenario.unknowns.is_empty()) {
            return Err(format!("{}: --ablate is for missions with an [[unknown]]", self.scenario).into());
        }
        let pilots = self.pilots();
        note_conventional(&pilots, &scenarios);
        let most = pilots.iter().map(|pilot| pilot.most_cells()).min().unwrap_or(0);
        if let Some(large) = scenarios.iter().find(|scenario| scenario.map.len() > most) {
            let (name, cells) = (&large.name, large.map.len());
            return Err(format!("{name}: {cells} cells, but this tree flies on at most {most}").into());
        }
        let usual = if scenarios.len() > 1 { scenarios.len() as u32 } else { SEEDS };
        let campaign = Campaign {
            scenarios: &scenarios,
            disturbances: &self.disturbances(),
            pilots: &pilots,
            seeds: self.seeds.unwrap_or(usual),
        };
        let flown = campaign.fly(self.threads, &|done, flights| tell(done, flights));
        let mut flown = flown.map_err(about(&self.scenario))?;
        flown.scenario.clone_from(&self.scenario);
        report(self.json, &flown, || {
            if self.ablate.is_some() { flown.ablation_table() } else { flown.table() }
        })?;
        let safe = [Pilot::Inference, Pilot::Image, Pilot::Compact];
        Ok(exit_status(safe.into_iter().all(|pilot| flown.collided(pilot) == 0)))
    }

    fn pilots(&self) -> Vec<Pilot> {
        match &self.ablate {
            None => self.tree.pilots(),
            Some(AblationList(ablations)) => {
                let others = ablations.iter().map(|ablation| Pilot::Ablated(ablation));
                [Pilot::Inference].into_iter().chain(others).collect()
            }
        }
    }

    fn disturbances(&self) -> Vec<Disturbance> {
        match &self.disturbance {
            Some(DisturbanceList(given)) => given.clone(),
            None if self.ablate.is_some() => vec![Disturbance::None],
            None => Disturbance::USUAL.to_vec(),
        }
    }

    /// A task file at several levels of wrong readings and failed actions.
    fn fly_task(&self, text: &str) -> Result<ExitCode, Failure> {
        if self.tree != CampaignTrees::Both || self.disturbance.is_some() || self.ablate.is_some() {
            let name = &self.scenario;
            return Err(format!(
                "{name}: a task is flown at several levels of noise, without --tree, --disturbance and --ablate"
            )
            .into());
        }
        let seeds = self.seeds.unwrap_or(SEEDS);
        task::campaign(&self.scenario, text, seeds, self.threads, self.budget, self.json)
    }
}

/// Reports the progress: a line that is overwritten on a terminal, else one for every tenth of the
/// flights.
fn tell(done: usize, flights: usize) {
    let mut stderr = io::stderr();
    let step = (flights / 10).max(1);
    // A closed terminal does not stop a campaign.
    let _ = if stderr.is_terminal() {
        if !done.is_multiple_of(10) && done < flights {
            return;
        }
        write!(stderr, "\r{done} of {flights} flights{}", if done == flights { "\n" } else { "" })
    } else if done.is_multiple_of(step) {
        writeln!(stderr, "{done} of {flights} flights")
    } else {
        Ok(())
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_twice_is_flown_once() {
        let names = |list: &str| {
            let AblationList(all) = ablations(list).expect("there are such");
            all.iter().map(|ablation| ablation.name).collect::<Vec<_>>()
        };
        assert_eq!(names("likeliest,first,likeliest"), ["likeliest", "first"]);
        assert_eq!(names("parts,parts"), names("parts"));
        assert_eq!(names("first,all,rules").len(), names("all").len());
        assert!(ablations("firs").is_err());
    }
}
