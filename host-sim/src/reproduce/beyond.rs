//! Beyond the paper: heterogeneous teams, and preferences learned online, both named there as
//! future work.

use super::figure::{DataSeries, Estimate, Figure, IntervalRow, Intervals, Lines, Panel};
use super::report::{Item, Section, number};
use super::{Effort, Reproduction};
use crate::beyond::{LearnedPreferences, Mixed, Unlike};
use crate::campaign::Score;
use crate::library::built_in;
use crate::statistics::Difference;

/// The number of missions and of series.
const SEEDS: u64 = 300;

const SERVED: &str = "part of the robots that was served";

/// Computes the section.
pub(super) fn measure(run: &Reproduction<'_>) -> Section {
    let mut section = Section::new("beyond", "Beyond the paper: unlike robots, learned preferences");
    section.say(
        "Robots that differ in pace and in sensors: the scenario `mixed` with starts and goals drawn for each seed. In the teams that \
         know their paces a slow robot scores each joint policy by how late it makes it, so it gets a near goal; the others take every robot \
         for a fast one and wait for it where it comes to that. A robot that knows that its localiser errs reads twice before it moves on, \
         which costs a tick and keeps it from a wrong belief. Both fly the same missions.",
    );
    section.say(
        "Preferences learned online: the scenario `deliveries`, thirty missions in a row. A robot learns from its own \
         experience alone where it was served, by Dirichlet counts, and prefers a goal by the logarithm of that probability.",
    );
    let seeds = run.seeds(SEEDS) as u32;
    let steps = Unlike::ALL.len() + 1;
    let mut mixed = Vec::new();
    for unlike in Unlike::ALL {
        (run.progress)(mixed.len(), steps);
        mixed.push(Mixed::fly(&built_in("mixed"), unlike, seeds));
    }
    (run.progress)(mixed.len(), steps);
    let learned = LearnedPreferences::fly(&built_in("deliveries"), seeds);
    let judged = run.effort == Effort::Full;
    section.items = mixed.iter().flat_map(|mixed| mixed_items(mixed, judged)).collect();
    section.items.extend(learned_items(&learned, judged));
    section.figures = vec![ticks(&mixed), curve(&learned)];
    section
}

/// A gain: claimed where enough flights are flown to tell, and measured otherwise.
fn gain(what: String, difference: &Difference, unit: &str, claimed: bool) -> Item {
    let [low, high] = difference.interval.map(number);
    let ours = format!("{}{unit} ({low} to {high})", number(difference.mean));
    if claimed {
        Item::claim(what, "> 0 with 95 %", ours, difference.interval[0] > 0.0)
    } else {
        Item::measured(what, ours)
    }
}

fn mixed_items(mixed: &Mixed, judged: bool) -> [Item; 3] {
    let what = match mixed.unlike {
        Unlike::Both => "paces and sensors",
        Unlike::Paces => "paces alone",
        Unlike::Sensors => "sensors alone",
    };
    let collided = |scores: &[Score]| scores.iter().filter(|score| score.has_collided()).count();
    let collided = collided(&mixed.known) + collided(&mixed.alike);
    let done = [&mixed.known, &mixed.alike].map(|scores| Mixed::accomplished(scores));
    // Knowing the sensors costs time, so only what the paces save is claimed; with both, the one is
    // taken from the other.
    let claimed = judged && mixed.unlike == Unlike::Paces;
    [
        gain(format!("unlike {what}: ticks that knowing it saves"), &mixed.saved(), " ticks", claimed),
        Item::claim(
            format!("unlike {what}: flights with a collision, of both teams"),
            "0",
            collided.to_string(),
            collided == 0,
        ),
        Item::measured(
            format!("unlike {what}: missions accomplished, known and taken for equal"),
            format!("{} and {} of {}", done[0].count, done[1].count, done[0].of),
        ),
    ]
}

fn learned_items(learned: &LearnedPreferences, judged: bool) -> [Item; 4] {
    let [learning, not] = [&learned.learning, &learned.not];
    let shares = [learning, not].map(|series| number(LearnedPreferences::last_third(series).mean));
    let ticks = [learning, not].map(|series| number(LearnedPreferences::ticks(series).mean));
    let collided: usize = learning.iter().chain(not).map(|series| series.collided).sum();
    [
        gain(
            "learned preferences: more robots served in the last third of the missions".to_owned(),
            &learned.gain(),
            "",
            judged,
        ),
        Item::measured("the part that was served there, with and without learning", shares.join(" and ")),
        Item::measured("the ticks of such a mission, with and without learning", ticks.join(" and ")),
        Item::claim(
            "learned preferences: missions with a collision, of both teams",
            "0",
            collided.to_string(),
            collided == 0,
        ),
    ]
}

fn ticks(mixed: &[Mixed]) -> Figure {
    let row = |mixed: &Mixed| IntervalRow {
        label: match mixed.unlike {
            Unlike::Both => "paces and sensors".to_owned(),
            Unlike::Paces => "paces".to_owned(),
            Unlike::Sensors => "sensors".to_owned(),
        },
        values: [("known", &mixed.known), ("taken for equal", &mixed.alike)]
            .map(|(name, scores)| (name.to_owned(), Estimate::of_mean(&Mixed::ticks(scores))))
            .into(),
    };
    let rows: Vec<_> = mixed.iter().map(row).collect();
    Figure::new(
        "Unlike robots: the ticks of a mission, means and 95 % intervals.",
        [Panel::Intervals(Intervals::new("Until all stand at their goals", "ticks", rows))],
    )
}

fn curve(learned: &LearnedPreferences) -> Figure {
    let series = [("learning", &learned.learning), ("not learning", &learned.not)];
    let lines = Lines {
        title: "Robots served".to_owned(),
        x: "mission".to_owned(),
        y: SERVED.to_owned(),
        at: (1..=LearnedPreferences::curve(&learned.learning).len()).map(|mission| mission as f64).collect(),
        series: series.map(|(name, series)| DataSeries::new(name, LearnedPreferences::curve(series))).into(),
    };
    let row = IntervalRow {
        label: "deliveries".to_owned(),
        values: series
            .map(|(name, series)| {
                (name.to_owned(), Estimate::of_mean(&LearnedPreferences::last_third(series)))
            })
            .into(),
    };
    Figure::new(
        "Preferences learned online: who was served, mission after mission, the mean over all series.",
        [
            Panel::Lines(lines),
            Panel::Intervals(Intervals::shares("In the last third of the missions", SERVED, [row])),
        ],
    )
}
