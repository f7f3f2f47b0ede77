//! Section 6.2: a bottle and a plate.

use super::Reproduction;
use super::figure::{Bars, DataSeries, Estimate, Figure, IntervalRow, Intervals, Lines, Panel, Scale};
use super::report::{Item, Section, Tolerance, with_interval};
use crate::manipulation::Preset;
use crate::manipulation::{
    self, CampaignRuns, Compared, Detail, Disturbances, LEVELS, Run as Mission, RunTerms, Thought,
    run as carry_out,
};
use crate::text::counted;

/// The policies whose probabilities the paper prints, with these probabilities.
const REPORTED: [(usize, f64); 4] = [(3, 0.255), (7, 0.205), (12, 0.255), (13, 0.205)];

/// The policies that inference nodes act on, in order: R1 moves and picks, R2 moves and picks, R1
/// places. Between the last two both move to goal C, by plain actions of figure 14's trees.
const SEQUENCE: &str = "3 7 12 13 11";

/// The seeds of the mission with one failed grasp and one wrong reading in ten.
const SEEDS: u64 = 1000;

/// The seeds of each contender at each level.
const SEEDS_COMPARED: u64 = 500;

/// Computes section 6.2.
pub(super) fn manipulate(run: &Reproduction<'_>) -> Section {
    let mut section = Section::new("6.2", "Two robots bring a bottle and a plate together");
    section.say(
        "Robot 1 fetches the bottle at goal A, robot 2 the plate at goal B, and at goal C the bottle is placed on the plate. \
         Each robot ticks its own tree of figure 14, weighs sixteen joint policies on its own noisy readings and its teammate's \
         frames, and raises and takes back preferences by table 5.",
    );
    section.say(
        "No precision, sensor and scale of C give both reported numbers (.255 and .205) with certain actions. The default changes \
         nothing and tunes nothing; the calibrated preset, actions taken to succeed in 86.3 % and a precision of 1.381, is one \
         of several that give both.",
    );
    let quiet = |preset| RunTerms { preset, disturbances: Disturbances::NONE, ..RunTerms::new(0) };
    let [ours, calibrated] = [Preset::DEFAULT, Preset::CALIBRATED].map(|preset| flown(&quiet(preset)));
    section.items = probabilities("default", &ours, Tolerance::Absolute(0.005));
    section.items.extend(probabilities("calibrated", &calibrated, Tolerance::Absolute(0.001)));
    section.items.extend(mission(&ours));
    section.items.extend(campaign(run));
    let compared = compared(run);
    section.items.extend(contenders(&compared));
    section.figures = vec![reported(&ours, &calibrated), beliefs(), levels(&compared)];
    section
}

fn flown(terms: &RunTerms) -> Mission {
    carry_out(terms, Detail::History).expect("the built-in trees run")
}

/// The probability with which a policy was first acted on.
fn acted_on(mission: &Mission, policy: usize) -> Option<f64> {
    let decided = mission.decisions.iter().find(|decided| decided.policy == policy)?;
    Some(f64::from(decided.probability))
}

fn probabilities(preset: &str, mission: &Mission, tolerance: Tolerance) -> Vec<Item> {
    let item = |(policy, paper): (usize, f64)| {
        let ours = acted_on(mission, policy).unwrap_or(f64::NAN);
        Item::published(format!("P(π{policy}), {preset}"), &format!("{paper}"), paper, ours, tolerance)
    };
    REPORTED.into_iter().map(item).collect()
}

/// The claims about a mission without disturbances.
fn mission(mission: &Mission) -> [Item; 4] {
    let sequence = mission.sequence().iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let robots = mission.history.iter().flat_map(|tick| &tick.robots).filter(|robot| robot.begins.is_some());
    let acting: Vec<_> = robots.filter_map(|robot| robot.thought.as_ref()).collect();
    let is_raised = |thought: &&&Thought| thought.raised.is_some_and(|raised| raised != thought.preferences);
    let raised = acting.iter().filter(is_raised).count();
    // C after an action has begun is the task's own, entry by entry zero or one: nothing of a raise
    // is left.
    let is_base =
        |rows: &[[f32; 4]; 2]| rows.as_flattened().iter().all(|&entry| entry == 0.0 || entry == 1.0);
    let exact = acting.iter().all(|thought| is_base(&thought.preferences));
    let raises = format!("{}, {}", counted(raised, "raise"), if exact { "no trace" } else { "traces left" });
    [
        Item::same("the policies acted on, in order", SEQUENCE, sequence),
        Item::claim(
            "sixteen joint policies",
            "16",
            joint_policies(mission).to_string(),
            joint_policies(mission) == 16,
        ),
        Item::claim(
            "C raised by table 5 for an action, and taken back when it begins",
            "to the last bit",
            raises,
            raised > 0 && exact,
        ),
        Item::claim(
            "from idle to the bottle on the plate",
            "in truth",
            format!(
                "{} after {}",
                if mission.success { "yes" } else { "no" },
                counted(mission.ticks, "tick")
            ),
            mission.success,
        ),
    ]
}

fn joint_policies(mission: &Mission) -> usize {
    let thoughts =
        mission.history.iter().flat_map(|tick| &tick.robots).filter_map(|robot| robot.thought.as_ref());
    thoughts.filter_map(|thought| thought.posterior.as_ref()).map(Vec::len).max().unwrap_or(0)
}

/// The mission with one failed grasp and one wrong reading in ten.
fn campaign(run: &Reproduction<'_>) -> [Item; 4] {
    let seeds = run.seeds(SEEDS) as u32;
    let terms = RunTerms { disturbances: Disturbances::TENTH, ..RunTerms::new(0) };
    let findings = CampaignRuns { terms, seeds }.run(None).expect("the built-in trees run");
    let under = format!("{}, 10 % failed grasps, 10 % wrong readings", counted(seeds, "seed"));
    let success = findings.success;
    [
        Item::measured(format!("{under}: success"), share(success.ratio, success.interval)),
        Item::measured(
            format!("{under}: said to be done, and was not"),
            share(findings.mistaken.ratio, findings.mistaken.interval),
        ),
        Item::measured(
            format!("{under}: ticks"),
            with_interval(findings.ticks.mean, findings.ticks.interval),
        ),
        Item::measured(
            format!("{under}: retries"),
            with_interval(findings.retries.mean, findings.retries.interval),
        ),
    ]
}

fn share(ratio: f64, [low, high]: [f64; 2]) -> String {
    format!("{:.1} % ({:.1} to {:.1})", 100.0 * ratio, 100.0 * low, 100.0 * high)
}

fn compared(run: &Reproduction<'_>) -> Vec<Compared> {
    manipulation::compare(0, run.seeds(SEEDS_COMPARED) as u32).expect("the built-in trees run")
}

fn contenders(compared: &[Compared]) -> Vec<Item> {
    let item = |part: &Compared| {
        let what = format!(
            "{:.0} % of grasps and readings wrong, {}: success; ticks",
            100.0 * part.level,
            part.contender
        );
        let (success, ticks) = (part.findings.success, part.findings.ticks);
        Item::measured(
            what,
            format!(
                "{}; {}",
                share(success.ratio, success.interval),
                with_interval(ticks.mean, ticks.interval)
            ),
        )
    };
    compared.iter().map(item).collect()
}

fn reported(ours: &Mission, calibrated: &Mission) -> Figure {
    let values = |mission| REPORTED.map(|(policy, _)| acted_on(mission, policy));
    let series = |name: &str, mission| DataSeries { name: name.to_owned(), values: values(mission).into() };
    let bars = Bars {
        title: "The probability of the chosen policy".to_owned(),
        labels: REPORTED.map(|(policy, _)| format!("π{policy}")).into(),
        series: vec![
            DataSeries::new("paper", REPORTED.map(|(_, paper)| paper)),
            series("default", ours),
            series("calibrated", calibrated),
        ],
        scale: Scale::Linear,
    };
    Figure::new(
        "π3: R1 goes to the bottle. π7: it picks it up. π12, π13: the same of R2 and the plate.",
        [Panel::Bars(bars)],
    )
}

/// The robots' beliefs in a mission with wrong readings.
fn beliefs() -> Figure {
    let mission = flown(&RunTerms::new(1));
    let panel = |robot: usize| {
        let thought = |state: usize| {
            mission.history.iter().map(move |tick| {
                tick.robots[robot].thought.as_ref().map(|thought| f64::from(thought.states[state]))
            })
        };
        let names = ["loc", "hold", "place", "free"];
        let series = names
            .iter()
            .enumerate()
            .map(|(state, name)| DataSeries { name: (*name).to_owned(), values: thought(state).collect() });
        Panel::Lines(Lines {
            title: format!("Robot {}: q(s)", robot + 1),
            x: "tick".to_owned(),
            y: "probability".to_owned(),
            at: mission.history.iter().map(|tick| f64::from(tick.tick)).collect(),
            series: series.collect(),
        })
    };
    Figure::new(
        "Beliefs over time, with one failed grasp and one wrong reading in ten.",
        [panel(0), panel(1)],
    )
}

/// Success and time of all contenders.
fn levels(compared: &[Compared]) -> Figure {
    let rows = |estimate: &dyn Fn(&Compared) -> Option<Estimate>| {
        LEVELS.map(|level| IntervalRow {
            label: format!("{:.0} %", 100.0 * level),
            values: compared
                .iter()
                .filter(|part| part.level == level)
                .map(|part| (part.contender.to_owned(), estimate(part)))
                .collect(),
        })
    };
    let success = rows(&|part| Some(Estimate::of_share(&part.findings.success)));
    let ticks = rows(&|part| Estimate::of_mean(&part.findings.ticks));
    Figure::new(
        "Inference trees and conventional ones, by the share of failed grasps and wrong readings, with 95 % intervals.",
        [
            Panel::Intervals(Intervals::shares("Success", "share of all missions", success)),
            Panel::Intervals(Intervals::new("Time", "ticks of successful missions", ticks)),
        ],
    )
}
