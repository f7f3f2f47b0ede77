//! `campaign`: a mission flown many times, by the inference node and by a conventional tree.

use super::{Failure, about, exit_status, report, scenario, task};
use clap::{Args, ValueEnum};
use host_sim::Pilot;
use host_sim::campaign::{Campaign, Disturbance};
use std::io::{self, IsTerminal, Write};
use std::num::NonZeroUsize;
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim campaign factory                            both trees, every disturbance, 500 seeds
  host-sim campaign warehouse --disturbance loss --seeds 2000
  host-sim campaign factory --tree inference --json | jq '.rows[].summaries[0].accomplished'

Disturbances, drawn from the seed and the same for both trees:
  none       the scenario as it is
  noise      localisers are wrong in 10 % of all readings
  slips      moves fail with 10 %
  loss       the radio loses 30 % of all frames
  obstacles  three obstacles appear where ways around them are left
  battery    the battery of one robot falls to 15 %
  pause      one robot stops for 20 to 39 ticks
  stop       one robot stops for good
  all        all of them but stop, in one flight

Exit status:
  0  no flight of the inference node had a collision
  1  one had
  2  wrong usage or input";

#[derive(Args, Debug)]
pub(super) struct FlyMany {
    /// A built-in scenario, or a scenario file
    #[arg(value_name = "NAME|FILE.toml")]
    scenario: String,
    /// How many seeds, from zero on
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    seeds: u32,
    /// The tree that flies the robots
    #[arg(long, value_name = "TREE", value_enum, default_value_t = CampaignTrees::Both)]
    tree: CampaignTrees,
    /// The disturbance; `every` takes them one after the other
    #[arg(long, value_name = "NAME", default_value = "every", value_parser = disturbances)]
    disturbance: DisturbanceList,
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
            Self::Conventional => vec![Pilot::Conventional],
            Self::Figure5 => vec![Pilot::Figure5],
        }
    }
}

#[derive(Clone, Debug)]
struct DisturbanceList(Vec<Disturbance>);

fn disturbances(name: &str) -> Result<DisturbanceList, String> {
    if name == "every" {
        return Ok(DisturbanceList(Disturbance::ALL.to_vec()));
    }
    Disturbance::find(name).map(|one| DisturbanceList(vec![one])).ok_or_else(|| {
        let names = Disturbance::ALL.map(Disturbance::name).join(", ");
        format!("there are every, {names}")
    })
}

impl FlyMany {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        if let Some(text) = task::text_of(&self.scenario)? {
            return self.fly_task(&text);
        }
        let scenario = scenario(&self.scenario)?;
        let pilots = self.tree.pilots();
        let campaign = Campaign {
            scenario: &scenario,
            disturbances: &self.disturbance.0,
            pilots: &pilots,
            seeds: self.seeds,
        };
        let flown = campaign
            .fly(self.threads, &|done, flights| tell(done, flights))
            .map_err(about(&scenario.name))?;
        report(self.json, &flown, || flown.table())?;
        Ok(exit_status(flown.collided(Pilot::Inference) == 0))
    }

    /// A task file at several levels of wrong readings and failed actions.
    fn fly_task(&self, text: &str) -> Result<ExitCode, Failure> {
        if self.tree != CampaignTrees::Both || self.disturbance.0.len() != Disturbance::ALL.len() {
            let name = &self.scenario;
            return Err(format!(
                "{name}: a task is flown at several levels of noise, without --tree and --disturbance"
            )
            .into());
        }
        task::campaign(&self.scenario, text, self.seeds, self.threads, self.json)
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
