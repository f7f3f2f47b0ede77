//! A comparison that the paper lacks: inference trees and conventional ones on the same missions.

use super::Reproduction;
use super::figure::{Estimate, Figure, IntervalRow, Intervals, Panel};
use super::report::{Item, Section, number, with_interval};
use crate::Pilot;
use crate::campaign::{Campaign, CampaignReport, CampaignRow, Comparison, Disturbance, Summary, cost};
use crate::library::built_in;
use crate::statistics::{Difference, Share};
use std::env;

/// The seeds of each mission, disturbance and pilot.
const SEEDS: u64 = 500;

const PILOTS: [Pilot; 2] = [Pilot::Inference, Pilot::Conventional];

const MISSIONS: [&str; 2] = ["two-goals", "factory"];

/// Computes the section.
pub(super) fn compare(run: &Reproduction<'_>) -> Section {
    let mut section = Section::new("comparison", "Inference and conventional trees on the same missions");
    section.say(
        "The conventional tree is figure 8's, with leaves as an engineer would write them by hand for the same sensors, radio and \
         maps: table 3's counts, no probabilities, no rounds. Both fly the same seeds with the same trouble. A mission is \
         accomplished when all robots stand at different goals without a single collision, which an independent validator judges \
         from the cells they were in; together means that the last arrived at most one tick after the first, of those that moved. Intervals are 95 %.",
    );
    for mission in MISSIONS {
        let report = fly(mission, run);
        section.items.extend(report.rows.iter().flat_map(|row| items(mission, row)));
        section.figures.push(figure(mission, &report));
    }
    section
        .items
        .extend(MISSIONS.into_iter().flat_map(|mission| PILOTS.map(|pilot| instructions(mission, pilot))));
    section
}

fn fly(mission: &str, run: &Reproduction<'_>) -> CampaignReport {
    let scenarios = [built_in(mission)];
    let seeds = run.seeds(SEEDS) as u32;
    let campaign =
        Campaign { scenarios: &scenarios, disturbances: &Disturbance::USUAL, pilots: &PILOTS, seeds };
    campaign.fly(None, run.progress).expect("both accept the mission")
}

/// One mission under one disturbance.
fn items(mission: &str, row: &CampaignRow) -> Vec<Item> {
    let name = row.disturbance.name();
    let seeds = row.summaries.first().map_or(0, |summary| summary.accomplished.of);
    let side_by_side =
        |text: fn(&Summary) -> String| row.summaries.iter().map(text).collect::<Vec<_>>().join(" against ");
    let inference = &row.summaries[0];
    let mut items = vec![
        Item::measured(
            format!("{mission}, {name}: accomplished, of {seeds}"),
            side_by_side(|summary| share(&summary.accomplished)),
        ),
        Item::claim(
            format!("{mission}, {name}: flights with a collision"),
            "inference: none in which robots meet",
            side_by_side(|summary| summary.collided.count.to_string()),
            inference.faults.total() == 0,
        ),
        Item::measured(
            format!("{mission}, {name}: arrived together, of the accomplished"),
            side_by_side(|summary| share(&summary.together)),
        ),
        Item::measured(format!("{mission}, {name}: ticks"), side_by_side(ticks)),
        Item::measured(
            format!("{mission}, {name}: frames sent"),
            side_by_side(|summary| number(summary.messages.mean)),
        ),
        Item::measured(
            format!("{mission}, {name}: robots at a goal at the end"),
            side_by_side(|summary| number(summary.in_place.mean)),
        ),
    ];
    if let Some(comparison) = row.comparisons.first() {
        let what = format!("{mission}, {name}: who wins");
        items.push(Item::measured(what, winner(comparison)));
    }
    items
}

fn share(share: &Share) -> String {
    let [low, high] = share.interval;
    format!("{} ({low:.3} to {high:.3})", share.count)
}

fn ticks(summary: &Summary) -> String {
    let ticks = &summary.ticks;
    if ticks.count == 0 {
        return "none".to_owned();
    }
    with_interval(ticks.mean, ticks.interval)
}

/// The pilot that is significantly better, by the differences between inference and conventional
/// tree on the same seeds.
fn winner(comparison: &Comparison) -> String {
    let success = who(&comparison.accomplished, true);
    if comparison.ticks.pairs == 0 {
        return format!("in success {success}");
    }
    format!(
        "in success {success}, in arriving together {}, in ticks {} (by {})",
        who(&comparison.together, true),
        who(&comparison.ticks, false),
        number(comparison.ticks.mean.abs())
    )
}

fn who(difference: &Difference, more_is_better: bool) -> &'static str {
    match difference.is_significant() {
        false => "nobody",
        true if (difference.mean > 0.0) == more_is_better => "inference",
        true => "the conventional tree",
    }
}

/// The cost of a tick, counted by valgrind where it is installed.
fn instructions(mission: &str, pilot: Pilot) -> Item {
    let what = format!("{mission}, {}: instructions a tick, ordinary; mean; at most", pilot.name());
    let program = env::current_exe().map_err(|error| error.to_string());
    let cost =
        program.and_then(|program| cost(&program, mission, pilot, 0).map_err(|error| error.to_string()));
    match cost {
        Ok(cost) => Item::measured(what, format!("{}; {:.0}; {}", cost.median, cost.mean, cost.most)),
        Err(reason) => Item::unknown(what, "-", reason),
    }
}

fn figure(mission: &str, report: &CampaignReport) -> Figure {
    let rows = |estimate: fn(&Summary) -> Option<Estimate>| {
        let row = |row: &CampaignRow| IntervalRow {
            label: row.disturbance.name().to_owned(),
            values: row
                .summaries
                .iter()
                .map(|summary| (summary.pilot.name().to_owned(), estimate(summary)))
                .collect(),
        };
        report.rows.iter().map(row).collect::<Vec<_>>()
    };
    let share = |title: &str, of: &str, share: fn(&Summary) -> Option<Estimate>| {
        Panel::Intervals(Intervals::shares(title, of, rows(share)))
    };
    let all = "share of all flights";
    Figure::new(
        format!("{mission}: {} seeds for each disturbance and tree.", report.seeds),
        [
            share("Accomplished", all, |summary| Some(Estimate::of_share(&summary.accomplished))),
            share("Flights with a collision", all, |summary| Some(Estimate::of_share(&summary.collided))),
            share("All arrived together", "share of accomplished flights", |summary| {
                (summary.together.of > 0).then(|| Estimate::of_share(&summary.together))
            }),
            Panel::Intervals(Intervals::new(
                "Time",
                "ticks of accomplished flights",
                rows(|summary| Estimate::of_mean(&summary.ticks)),
            )),
        ],
    )
}
