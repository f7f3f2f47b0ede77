//! The comparison that the paper does not have: inference trees and conventional ones on the same missions.

use super::Run;
use super::figure::{Estimate, Figure, IntervalRow, Intervals, Panel};
use super::report::{Item, Section, number};
use crate::campaign::{Campaign, Disturbance, Report, Row, Summary, cost};
use crate::statistics::Difference;
use crate::{Pilot, library};
use std::env;

/// The seeds of each mission, disturbance and pilot.
const SEEDS: u64 = 500;

const PILOTS: [Pilot; 2] = [Pilot::Inference, Pilot::Conventional];

const MISSIONS: [&str; 2] = ["two-goals", "factory"];

/// What the comparison comes to.
pub(super) fn compare(run: &Run<'_>) -> Section {
    let mut section = Section::new("comparison", "Inference and conventional trees on the same missions");
    section.say(
        "The conventional tree is figure 8's, with leaves as an engineer would write them by hand for the same sensors, radio and \
         maps: table 3's counts, no probabilities, no rounds. Both fly the same seeds with the same trouble. A mission is \
         accomplished when all robots stand at different goals without a single collision, which an independent validator judges \
         from the cells they were in. Intervals are 95 %.",
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

fn fly(mission: &str, run: &Run<'_>) -> Report {
    let scenario = library::find(mission).expect("it is built in").expect("it is sound");
    let seeds = run.seeds(SEEDS) as u32;
    let campaign = Campaign { scenario: &scenario, disturbances: &Disturbance::ALL, pilots: &PILOTS, seeds };
    campaign.fly(None, run.progress).expect("both accept the mission")
}

/// One mission under one disturbance.
fn items(mission: &str, row: &Row) -> Vec<Item> {
    let name = row.disturbance.name();
    let seeds = row.summaries.first().map_or(0, |summary| summary.accomplished.of);
    let side_by_side =
        |text: fn(&Summary) -> String| row.summaries.iter().map(text).collect::<Vec<_>>().join(" against ");
    let inference = &row.summaries[0];
    let mut items = vec![
        Item::measured(
            format!("{mission}, {name}: accomplished, of {seeds}"),
            side_by_side(|summary| {
                let share = summary.accomplished;
                format!("{} ({:.3} to {:.3})", share.count, share.interval[0], share.interval[1])
            }),
        ),
        Item::claim(
            format!("{mission}, {name}: flights with a collision"),
            "inference: none",
            side_by_side(|summary| summary.collided.count.to_string()),
            inference.collided.count == 0,
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
    if let Some(comparison) = &row.comparison {
        let what = format!("{mission}, {name}: who wins");
        items.push(Item::measured(what, winner(&comparison.accomplished, &comparison.ticks)));
    }
    items
}

fn ticks(summary: &Summary) -> String {
    let ticks = &summary.ticks;
    if ticks.count == 0 {
        return "none".to_owned();
    }
    format!("{} ({} to {})", number(ticks.mean), number(ticks.interval[0]), number(ticks.interval[1]))
}

/// Who is better beyond chance in what, by the differences of inference and conventional tree on the same seeds.
fn winner(accomplished: &Difference, ticks: &Difference) -> String {
    let side = |difference: &Difference, more_is_better: bool| {
        let [low, high] = difference.interval;
        match (low > 0.0, high < 0.0) {
            (true, _) => Some(more_is_better),
            (_, true) => Some(!more_is_better),
            _ => None,
        }
    };
    let name = |inference: Option<bool>| match inference {
        Some(true) => "inference",
        Some(false) => "the conventional tree",
        None => "nobody",
    };
    let success = name(side(accomplished, true));
    if ticks.pairs == 0 {
        return format!("in success {success}");
    }
    format!("in success {success}, in ticks {} (by {})", name(side(ticks, false)), number(ticks.mean.abs()))
}

/// What a tick costs, counted by valgrind where there is one.
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

fn figure(mission: &str, report: &Report) -> Figure {
    let panel = |title: &str, unit: &str, estimate: &dyn Fn(&Summary) -> Option<Estimate>| {
        let row = |row: &Row| IntervalRow {
            label: row.disturbance.name().to_owned(),
            values: row
                .summaries
                .iter()
                .map(|summary| (summary.pilot.name().to_owned(), estimate(summary)))
                .collect(),
        };
        Panel::Intervals(Intervals {
            title: title.to_owned(),
            unit: unit.to_owned(),
            rows: report.rows.iter().map(row).collect(),
        })
    };
    let share = |share: &crate::statistics::Share| {
        Some(Estimate { value: share.ratio, low: share.interval[0], high: share.interval[1] })
    };
    Figure::new(
        format!("{mission}: {} seeds for each disturbance and tree.", report.seeds),
        [
            panel("Accomplished", "share of all flights", &|summary| share(&summary.accomplished)),
            panel("Time", "ticks of accomplished flights", &|summary| {
                let ticks = &summary.ticks;
                let [low, high] = ticks.interval;
                (ticks.count > 0).then_some(Estimate { value: ticks.mean, low, high })
            }),
            panel("Flights with a collision", "share of all flights", &|summary| share(&summary.collided)),
        ],
    )
}
