//! Safety: every built-in mission in the default mode, judged by the validator.

use super::Reproduction;
use super::figure::{Estimate, Figure, IntervalRow, Intervals, Panel};
use super::report::{Item, Section, number};
use crate::campaign::{Campaign, Disturbance, Summary};
use crate::text::counted;
use crate::{Pilot, Scenario, library};

/// The seeds of each mission, with each radio.
const SEEDS: u64 = 100;

/// The radios and their names.
const RADIOS: [Disturbance; 2] = [Disturbance::None, Disturbance::Loss];
const NAMES: [&str; 2] = ["a perfect radio", "three frames in ten lost"];

/// Computes the section of all flights.
pub(super) fn validate(run: &Reproduction<'_>) -> Section {
    let mut section = Section::new("safety", "Nobody collides, whatever the radio does");
    section.say(
        "Every mission that is built in, flown by the inference node in the default mode. The validator looks at nothing but the cells \
         that robots were in, and shares no code with the robots, their planner or the referee. Frames that are lost cost time: robots wait.",
    );
    let missions: Vec<_> = library::names().map(library::built_in).collect();
    let mut rows = Vec::new();
    for (done, mission) in missions.iter().enumerate() {
        (run.progress)(done, missions.len());
        let flights = flown(mission, &Reproduction { progress: &|_, _| (), ..*run }, SEEDS);
        section.items.extend(flights.iter().map(|flights| item(mission, flights)));
        let value = |flights: &Flights| (flights.radio.to_owned(), Estimate::of_mean(&flights.summary.ticks));
        rows.push(IntervalRow { label: mission.name.clone(), values: flights.iter().map(value).collect() });
    }
    let ticks = Intervals::new("Until all stand at their goals", "ticks of accomplished flights", rows);
    section.figures =
        vec![Figure::new("What lost frames cost: time, and nothing else.", [Panel::Intervals(ticks)])];
    section
}

fn item(mission: &Scenario, flights: &Flights) -> Item {
    let ours = format!("{}; {} ticks", flights.found(), number(flights.summary.ticks.mean));
    Item::claim(format!("{}, {}", mission.name, flights.what()), "no collision", ours, flights.are_safe())
}

/// Flights of one mission with one radio.
pub(super) struct Flights {
    seeds: u32,
    radio: &'static str,
    summary: Summary,
}

/// Flies a mission with each radio; the full report has `seeds` seeds.
pub(super) fn flown(scenario: &Scenario, run: &Reproduction<'_>, seeds: u64) -> Vec<Flights> {
    let seeds = run.seeds(seeds) as u32;
    let campaign = Campaign {
        scenarios: std::slice::from_ref(scenario),
        disturbances: &RADIOS,
        pilots: &[Pilot::Inference],
        seeds,
    };
    let report = campaign.fly(None, run.progress).expect("the mission fits");
    let summaries = report.rows.into_iter().flat_map(|row| row.summaries);
    summaries.zip(NAMES).map(|(summary, radio)| Flights { seeds, radio, summary }).collect()
}

impl Flights {
    pub(super) fn what(&self) -> String {
        format!("{}, {}", counted(self.seeds, "seed"), self.radio)
    }

    pub(super) fn found(&self) -> String {
        let Summary { accomplished, collided, .. } = &self.summary;
        format!("{} accomplished, {} with a collision", accomplished.count, collided.count)
    }

    pub(super) fn are_safe(&self) -> bool {
        self.summary.collided.count == 0
    }

    pub(super) fn are_accomplished(&self) -> bool {
        self.summary.accomplished.count == self.seeds
    }
}
