//! Section 6.1 as one flight in the default mode.

use crate::campaign::{Disturbance, Trace};
use crate::library::built_in;
use crate::reproduce::Reproduction;
use crate::reproduce::decision::map;
use crate::reproduce::figure::{DataSeries, Figure, Grid, Lines, Panel, Track};
use crate::reproduce::report::Item;
use crate::reproduce::safety::{self, Flights};
use crate::text::cause_words;
use crate::{Chosen, Conditions, FlightEvent, Outcome, Phase, Record, Scenario, fly};
use iibt_core::grid::{Cell, Path, first_conflict};
use iibt_core::navigation::Cause;

/// The seeds that it is flown with, by a perfect radio and by one that loses three frames in ten.
const SEEDS: u64 = 200;

/// The way-points of the paper, and the robots that charge.
const WAY_POINTS: [(usize, Cell); 2] = [(0, Cell(4)), (2, Cell(39))];
const CHARGING: [usize; 2] = [0, 2];

/// The flight: claims and pictures.
pub(super) fn flown(run: &Reproduction<'_>) -> (Vec<Item>, Vec<Figure>) {
    let scenario = built_in("shift");
    let record = fly(&scenario, Conditions::default(), &mut ()).expect("its mission fits");
    let mut items = phases(&scenario, &record);
    items.extend(seeds(&scenario, run));
    (items, vec![rounds(&scenario, &record), certainty(&scenario)])
}

/// The five phases of one flight, and its end.
fn phases(scenario: &Scenario, record: &Record) -> Vec<Item> {
    let first = record.phases.first().is_some_and(|phase| phase.cause.is_none() && phase.agreed.is_some());
    let mut items = vec![claim("phase 1: the first choice", "all agree", first)];
    items.extend([2, 3].into_iter().enumerate().map(|(index, phase)| passed(record, phase, index)));
    items.extend(WAY_POINTS.map(|(robot, cell)| {
        let what = format!("phase 4: R{} visits way-point p{}", robot + 1, cell.0);
        claim(what, "on its way", record.robots[robot].visited.contains(&cell))
    }));
    items.extend(CHARGING.map(|robot| {
        let what = format!("phase 5: R{} leaves to charge, and comes back", robot + 1);
        claim(what, "once", record.robots[robot].charged == 1)
    }));
    items.push(claim("phase 5: the others wait while a robot charges", "nobody else moves", waiting(record)));
    items.push(claim(
        "every plan: all choose the same joint policy, without a conflict",
        "within three ticks of the call for it",
        in_common(record),
    ));
    items.extend(end(scenario, record));
    items
}

/// The phase in which the obstacle with this index, from zero, is passed.
fn passed(record: &Record, phase: u8, index: usize) -> Item {
    let obstacle = record.obstacles().nth(index);
    let around = obstacle.is_some_and(|(tick, cell)| avoided(record, tick, cell));
    let ours = obstacle.map_or_else(
        || "no obstacle appeared".to_owned(),
        |(_, cell)| format!("{} p{}", if around { "around" } else { "through" }, cell.0),
    );
    Item::claim(
        format!("phase {phase}: an obstacle on the way of a robot, and another plan around it"),
        "agreed, and no path meets it",
        ours,
        around,
    )
}

fn end(scenario: &Scenario, record: &Record) -> [Item; 2] {
    let faults = Trace::of(scenario, record).validate().total();
    [
        Item::claim(
            "the end: all three at different goals, at most one tick apart",
            "Together",
            format!("{:?} at tick {}", record.outcome, record.last_arrival()),
            record.outcome == Outcome::Together,
        ),
        Item::claim("the validator", "no collision, no swap", format!("{faults} found"), faults == 0),
    ]
}

fn claim(what: impl Into<String>, wanted: &str, holds: bool) -> Item {
    Item::claim(what, wanted, if holds { "yes" } else { "no" }, holds)
}

/// Whether the team agreed on paths past a cell after an obstacle had appeared there.
fn avoided(record: &Record, appeared: u32, cell: Cell) -> bool {
    let later = |phase: &&Phase| phase.agreed.is_some_and(|agreed| agreed > appeared);
    let clear = |phase: &Phase| phase.choices.iter().flatten().all(|chosen| !chosen.path.contains(&cell));
    let caused = record.phases.iter().any(|phase| phase.cause == Some(Cause::Obstacle));
    caused && record.phases.iter().find(later).is_some_and(clear)
}

/// Returns whether only the robot that was away moved, in every tick in which one was.
fn waiting(record: &Record) -> bool {
    let mut away: Vec<usize> = Vec::new();
    let mut events = record.events.iter().peekable();
    for (tick, cells) in record.history.windows(2).enumerate() {
        let stayed = |robot: usize| cells[0][robot] == cells[1][robot];
        if !away.is_empty() && (0..cells[0].len()).any(|robot| !away.contains(&robot) && !stayed(robot)) {
            return false;
        }
        while let Some(timed) = events.next_if(|timed| timed.tick as usize <= tick) {
            match timed.event {
                FlightEvent::Left { robot, .. } => away.push(robot),
                FlightEvent::Returned { robot, .. } => away.retain(|&other| other != robot),
                _ => {}
            }
        }
    }
    true
}

/// The ticks from the call for a plan to the last choice: the facts of all, their scores, and the
/// choice.
const TICKS: u32 = 3;

/// Whether in every plan that was agreed on all robots chose the same joint policy in time, and no
/// two of its paths have a conflict.
fn in_common(record: &Record) -> bool {
    let agreed = || record.phases.iter().filter(|phase| phase.agreed.is_some());
    agreed().count() >= 6 && agreed().all(is_common)
}

fn is_common(phase: &Phase) -> bool {
    let Some(choices) = phase.choices.iter().cloned().collect::<Option<Vec<Chosen>>>() else { return false };
    let in_time = choices.iter().all(|chosen| chosen.tick <= phase.opened + TICKS);
    let alike = choices.windows(2).all(|pair| pair[0].probability == pair[1].probability);
    let paths: Option<Vec<Path>> = choices.iter().map(|chosen| Path::through(&map(), &chosen.path)).collect();
    let clear = paths.is_some_and(|paths| {
        let pairs = paths.iter().enumerate().flat_map(|(one, a)| paths[..one].iter().map(move |b| (a, b)));
        pairs.into_iter().all(|(a, b)| first_conflict(&map(), a, b).is_none())
    });
    in_time && alike && clear
}

/// The mission with many seeds.
fn seeds(scenario: &Scenario, run: &Reproduction<'_>) -> Vec<Item> {
    let claim = |flights: Flights| {
        let what = format!("{}: accomplished, and without a collision", flights.what());
        Item::claim(what, "all, none", flights.found(), flights.are_safe() && flights.are_accomplished())
    };
    safety::flown(scenario, run, SEEDS).into_iter().map(claim).collect()
}

/// The choices of all robots, in each round that the team agreed on.
fn rounds(scenario: &Scenario, record: &Record) -> Figure {
    let mut asked: Vec<(u32, Cell)> = Vec::new();
    for timed in &record.events {
        if let FlightEvent::Asked { cell, .. } = timed.event {
            asked.push((timed.tick, cell));
        }
    }
    let picture = |phase: &Phase| {
        let track = |(robot, chosen): (usize, &Option<Chosen>)| Track {
            name: record.robots[robot].name.clone(),
            cells: chosen.as_ref().map_or_else(Vec::new, |chosen| chosen.path.clone()),
        };
        let cause = phase.cause.map_or("the first choice".to_owned(), |cause| {
            format!("{}: {}", record.robots[phase.opener].name, cause_words(cause))
        });
        let at = phase.agreed.unwrap_or(phase.opened);
        Panel::Grid(Grid {
            title: format!("Tick {at}, {cause}"),
            width: record.width,
            height: record.height,
            goals: record.goals.clone(),
            blocked: phase.obstacles.clone(),
            chargers: scenario.robots.iter().filter_map(|robot| robot.charger).collect(),
            way_points: asked.iter().filter(|(tick, _)| *tick <= at).map(|&(_, cell)| cell).collect(),
            paths: phase.choices.iter().enumerate().map(track).collect(),
            ..Grid::default()
        })
    };
    Figure::new(
        "The plans of the flight, with the robot that called for each and why. Goals green, chargers yellow, way-points violet, \
         obstacles dark; a ring on a path is a wait, and the number how many.",
        record.phases.iter().filter(|phase| phase.agreed.is_some()).map(picture),
    )
}

/// The robots' certainty of their positions, when one reading in ten is wrong.
fn certainty(scenario: &Scenario) -> Figure {
    let noisy = Disturbance::Noise.applied(scenario, 0);
    let record = fly(&noisy, Conditions::default(), &mut ()).expect("its mission fits");
    let series = (0..record.robots.len()).map(|robot| {
        let values = record.certainty.iter().map(|tick| f64::from(tick[robot]));
        DataSeries::new(record.robots[robot].name.clone(), values)
    });
    let lines = Lines {
        title: "q(s) of the cell that a robot stands in".to_owned(),
        x: "tick".to_owned(),
        y: "probability".to_owned(),
        at: (0..record.certainty.len()).map(|tick| tick as f64).collect(),
        series: series.collect(),
    };
    Figure::new(
        "Beliefs over time, with one reading in ten wrong. A robot that is not sure looks again before it moves.",
        [Panel::Lines(lines)],
    )
}
