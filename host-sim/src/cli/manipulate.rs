//! `manipulate`: two robots bring a bottle and a plate together.

use super::{Failure, exit_status, probability, report, seed};
use clap::{Args, ValueEnum};
use host_sim::manipulation::{
    CampaignRuns, Compared, Detail, Disturbances, Findings, RunTerms, Trees, Trust, compare, narrate, run,
};
use host_sim::manipulation::{Order, Preset};
use host_sim::statistics::{Distribution, Share};
use serde::Serialize;
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim manipulate                       watch the paper's section 6.2
  host-sim manipulate --tree conventional   the same with conventional trees
  host-sim manipulate --grasps 0.3 --readings 0.3 --loss 0.3 --seed 7
  host-sim manipulate --json | jq '.decisions[].policy'
  host-sim manipulate --seeds 1000          rates and means with their intervals
  host-sim manipulate --compare             inference and conventional trees side by side
From a checkout, `host-sim manipulate ...` is `cargo run --release -- manipulate ...`.

Exit status:
  0  the bottle is on the plate; with --seeds, in every run; always with --compare
  1  it is not
  2  wrong usage or input";

#[derive(Args, Debug)]
pub(super) struct Manipulate {
    /// The seed of all random numbers; the same seed gives the same run
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 0)]
    seed: u64,
    /// The trees of the robots
    #[arg(long, value_name = "KIND", value_enum, default_value_t)]
    tree: Trees,
    /// The probability that a pick fails
    #[arg(long, value_name = "P", default_value_t = 0.1, value_parser = probability)]
    grasps: f64,
    /// The probability that a reading is wrong
    #[arg(long, value_name = "P", default_value_t = 0.1, value_parser = probability)]
    readings: f64,
    /// The probability that a move fails
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    moves: f64,
    /// The probability that placing fails
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    placings: f64,
    /// The probability that a frame does not reach the teammate
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    loss: f64,
    /// The parameters of the inference nodes
    #[arg(long, value_name = "PRESET", default_value = "default")]
    preset: Judgement,
    /// The modelled probability that a reading is right, in place of equation 8's 0.923
    #[arg(long, value_name = "P", value_parser = probability)]
    sensor: Option<f64>,
    /// Let the inference nodes of both robots fetch at once, and not in turn as published
    #[arg(long)]
    together: bool,
    /// How many equal readings in a row conventional trees trust
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=100))]
    equal: u8,
    /// Let conventional trees trust the inference nodes' belief instead
    #[arg(long)]
    belief: bool,
    /// Run this many seeds from --seed on, and print rates and means only
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    seeds: Option<u32>,
    /// Run inference and conventional trees with the same --seeds seeds, 1000 unless given, at
    /// several levels of disturbance
    #[arg(long, conflicts_with_all = ["tree", "grasps", "readings", "moves", "placings", "loss", "preset", "sensor",
        "together", "equal", "belief"])]
    compare: bool,
    /// Print one JSON object with everything, and nothing else
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Judgement {
    /// Nothing tuned
    Default,
    /// The paper's probabilities to a thousandth
    Calibrated,
}

/// A campaign as it is printed.
#[derive(Serialize)]
struct Campaigned {
    trees: Trees,
    disturbances: Disturbances,
    seeds: u32,
    #[serde(flatten)]
    findings: Findings,
}

impl Manipulate {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        let accomplished = match self.seeds {
            _ if self.compare => self.comparison()?,
            Some(seeds) => self.campaign(seeds)?,
            None => self.once()?,
        };
        Ok(exit_status(accomplished))
    }

    fn once(&self) -> Result<bool, Failure> {
        let run = run(&self.terms(), Detail::History)?;
        report(self.json, &run, || narrate(&run))?;
        Ok(run.success)
    }

    fn campaign(&self, seeds: u32) -> Result<bool, Failure> {
        let terms = self.terms();
        let findings = CampaignRuns { terms, seeds }.run(None)?;
        let (trees, disturbances) = (terms.trees, terms.disturbances);
        report(self.json, &Campaigned { trees, disturbances, seeds, findings }, || table(&findings))?;
        Ok(findings.success.count == seeds)
    }

    fn comparison(&self) -> Result<bool, Failure> {
        let compared = compare(self.seed, self.seeds.unwrap_or(1000))?;
        report(self.json, &compared, || side_by_side(&compared))?;
        Ok(true)
    }

    fn terms(&self) -> RunTerms {
        let disturbances = Disturbances {
            wrong_readings: self.readings,
            failed_grasps: self.grasps,
            failed_moves: self.moves,
            failed_placings: self.placings,
            loss: self.loss,
        };
        let preset = match self.preset {
            Judgement::Default => Preset::DEFAULT,
            Judgement::Calibrated => Preset::CALIBRATED,
        };
        RunTerms {
            trees: self.tree,
            disturbances,
            preset: Preset { sensor: self.sensor.map_or(preset.sensor, |p| p as f32), ..preset },
            order: if self.together { Order::Together } else { Order::InTurn },
            trust: if self.belief { Trust::Belief } else { Trust::Equal(self.equal) },
            ..RunTerms::new(self.seed)
        }
    }
}

fn side_by_side(compared: &[Compared]) -> String {
    let header = "level  contender                       success %            mistaken %  ticks                   retries\n";
    let line = |of: &Compared| {
        let Findings { success, mistaken, ticks, retries, .. } = of.findings;
        let range =
            |[low, high]: [f64; 2], scale: f64| format!("({:.2} to {:.2})", scale * low, scale * high);
        format!(
            "{:<5}  {:<30}  {:<19}  {:<10.2}  {:<22}  {:.2}\n",
            of.level,
            of.contender,
            format!("{:.1} {}", 100.0 * success.ratio, range(success.interval, 100.0)),
            100.0 * mistaken.ratio,
            format!("{:.2} {}", ticks.mean, range(ticks.interval, 1.0)),
            retries.mean
        )
    };
    let lines: String = compared.iter().map(line).collect();
    header.to_owned()
        + &lines
        + "In brackets: 95 % intervals. The level is the share of grasps that fail and of readings that are wrong.\n"
}

fn table(findings: &Findings) -> String {
    let rate = |Share { count, of, ratio, interval: [low, high] }: Share| {
        format!("{count} of {of}, {:.2} % ({:.2} to {:.2})", 100.0 * ratio, 100.0 * low, 100.0 * high)
    };
    let mean = |Distribution { mean, interval: [low, high], .. }: Distribution| {
        format!("{mean:.2} ({low:.2} to {high:.2})")
    };
    let rows = [
        ("success", rate(findings.success)),
        ("mistaken", rate(findings.mistaken)),
        ("ticks", mean(findings.ticks)),
        ("retries", mean(findings.retries)),
        ("actions", mean(findings.actions)),
    ];
    let lines = rows.iter().map(|(name, value)| format!("{name:<9} {value}\n"));
    lines.collect::<String>()
        + "In brackets: 95 % intervals. Ticks, retries and actions are of the runs that succeeded.\n"
}
