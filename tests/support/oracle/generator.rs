//! Random models, observations and decisions.

use super::chance::Chance;
use super::decision::{Decision, Habit, Meeting};
use super::description::{Description, Hidden, Motion, Observed, Sense, Sensor};
use iibt_core::actions::Action;
use iibt_core::inference::{Gain, PreferenceTiming, Scoring};

/// The most states of a factor.
pub const STATES: usize = 6;

/// The most factors, and so the most groups.
pub const FACTORS: usize = 4;

/// A model of 1 to 4 factors of 1 to 6 states and 1 to 4 modalities; most have no more than some
/// sixty joint states.
pub fn description(chance: &mut Chance) -> Description {
    let most = if chance.once_in(60) { usize::MAX } else { chance.pick(&[6, 12, 24, 64]) };
    let states = loop {
        let count = chance.within(1, FACTORS);
        let states: Vec<usize> = (0..count).map(|_| chance.within(1, STATES)).collect();
        if states.iter().product::<usize>() <= most {
            break states;
        }
    };
    let modalities = chance.within(1, 4);
    Description {
        factors: (0..states.len()).map(|factor| hidden(chance, &states, factor)).collect(),
        modalities: (0..modalities).map(|_| sense(chance, &states)).collect(),
    }
}

fn hidden(chance: &mut Chance, states: &[usize], number: usize) -> Hidden {
    let mut others = chance.order(states.len());
    others.retain(|&other| other != number);
    others.truncate(if chance.once_in(4) { chance.within(1, 2) } else { 0 });
    let actions = chance.within(1, 3);
    let counts: Vec<usize> = [number].iter().chain(&others).map(|&factor| states[factor]).collect();
    Hidden {
        prior: chance.distribution(states[number]),
        motion: motion(chance, &counts, actions),
        coupled_to: others,
        control: match chance.below(5) {
            0 => None,
            1 => Some(chance.below(states.len())),
            _ => Some(number),
        },
        actions,
    }
}

fn motion(chance: &mut Chance, counts: &[usize], actions: usize) -> Motion {
    let values = counts[0];
    match (chance.below(4), counts) {
        (0, _) => Motion::Dense(table(chance, actions, values, counts)),
        (1, _) => Motion::Own(table(chance, actions, values, counts)),
        (2, &[states]) => {
            let next = (0..actions * states).map(|_| chance.below(states) as u16).collect();
            Motion::NextState(next, if chance.once_in(2) { 0.0 } else { chance.unit() })
        }
        _ => {
            let weights = chance.distribution(counts.len());
            let block = |(condition, weight): (usize, f32)| (weight, condition);
            let blocks: Vec<(f32, usize)> = weights.into_iter().enumerate().map(block).collect();
            let form = |(weight, condition): (f32, usize)| {
                let from = &counts[condition..=condition];
                let part = if from[0] == values { square(chance, from, actions) } else { None };
                (weight, part.unwrap_or_else(|| Motion::Own(table(chance, actions, values, from))))
            };
            Motion::Blocks(blocks.into_iter().map(form).collect())
        }
    }
}

/// A block between factors of the same size.
fn square(chance: &mut Chance, counts: &[usize], actions: usize) -> Option<Motion> {
    (!chance.once_in(3)).then(|| match motion(chance, counts, actions) {
        Motion::Blocks(_) => Motion::Dense(table(chance, actions, counts[0], counts)),
        other => other,
    })
}

/// Tables, one after the other: a row per value and a column per combination of states.
fn table(chance: &mut Chance, tables: usize, values: usize, counts: &[usize]) -> Vec<f32> {
    let columns: usize = counts.iter().product();
    let mut all = vec![0.0; tables * values * columns];
    for table in all.chunks_exact_mut(values * columns) {
        for column in 0..columns {
            for (value, p) in chance.distribution(values).into_iter().enumerate() {
                table[value * columns + column] = p;
            }
        }
    }
    all
}

fn sense(chance: &mut Chance, states: &[usize]) -> Sense {
    let mut factors = chance.order(states.len());
    factors.truncate(chance.pick(&[1, 1, 2, 2, 3, 4]));
    let counts: Vec<usize> = factors.iter().map(|&factor| states[factor]).collect();
    let outcomes = chance.within(1, 5);
    let (outcomes, sensor) = match (chance.below(4), counts.as_slice()) {
        (0, &[states]) if states > 1 => {
            (states, Sensor::IdentityNoise(chance.pick(&[0.0, 1.0, 0.5, 0.9, 0.99])))
        }
        (0 | 1, _) => (outcomes, outcome_table(chance, &counts, outcomes)),
        (2, _) => (outcomes, Sensor::Own(table(chance, 1, outcomes, &counts))),
        _ => (outcomes, Sensor::Dense(table(chance, 1, outcomes, &counts))),
    };
    Sense { outcomes, factors, sensor, preference: preference(chance, outcomes) }
}

fn outcome_table(chance: &mut Chance, counts: &[usize], outcomes: usize) -> Sensor {
    let labels: Vec<Vec<u8>> = counts
        .iter()
        .map(|&states| {
            let most = chance.within(1, 3);
            (0..states).map(|_| chance.below(most) as u8).collect()
        })
        .collect();
    let carried = |of: &Vec<u8>| usize::from(of.iter().copied().max().unwrap_or(0)) + 1;
    let combinations: usize = labels.iter().map(carried).product();
    let kinds = chance.within(1, 4);
    Sensor::OutcomeTable(
        labels,
        (0..combinations).map(|_| chance.below(kinds) as u8).collect(),
        (0..kinds).flat_map(|_| chance.distribution(outcomes)).collect(),
    )
}

/// C of some outcomes.
pub fn preference(chance: &mut Chance, outcomes: usize) -> Vec<f32> {
    (0..outcomes).map(|_| if chance.once_in(3) { 0.0 } else { chance.between(-4.0, 4.0) }).collect()
}

/// Something observed: every modality or fewer, with readings that may be soft or missing.
pub fn observation(chance: &mut Chance, description: &Description) -> Vec<Observed> {
    let mut seen: Vec<Observed> = description
        .modalities
        .iter()
        .map(|sense| match chance.below(12) {
            0 | 1 => Observed::Missing,
            2 | 3 => {
                let weight = |_| if chance.once_in(3) { 0.0 } else { chance.unit() };
                Observed::Soft((0..sense.outcomes).map(weight).collect())
            }
            _ => Observed::Outcome(chance.below(sense.outcomes)),
        })
        .collect();
    if chance.once_in(10) {
        seen.truncate(chance.below(seen.len() + 1));
    }
    seen
}

/// A decision about a model, of no more than some thirty joint policies.
pub fn decision(chance: &mut Chance, description: &Description) -> Decision {
    let horizon = chance.pick(&[1, 1, 2, 2, 3, 3, 4, 6]);
    let mut room = 32;
    let mut sequences: Vec<Vec<Vec<Action>>> = vec![];
    for control in 0..description.controls() {
        let actions = description.actions(control);
        let choices = chance.within(0, 4).min(room);
        room /= choices.max(1);
        // Some are longer than the horizon; a control that moves nothing has nothing to do.
        let mut sequence = || {
            let steps = if actions == 0 { 0 } else { chance.within(0, horizon + 1) };
            (0..steps).map(|_| chance.below(actions) as u8).collect()
        };
        sequences.push((0..choices).map(|_| sequence()).collect());
    }
    let count: usize = sequences.iter().map(|list| list.len().max(1)).product();
    let listed = (chance.once_in(3) && !sequences.is_empty()).then(|| {
        let row = |_| sequences.iter().map(|list| chance.below(list.len().max(1)) as u8).collect();
        (0..count.min(8)).map(row).collect::<Vec<Vec<u8>>>()
    });
    let count = listed.as_ref().map_or(count, Vec::len);
    let habits = match chance.below(3) {
        0 => Habit::Joint((0..count).map(|_| chance.between(-3.0, 3.0)).collect()),
        1 => Habit::PerSequence(
            sequences
                .iter()
                .map(|list| (0..list.len().max(1)).map(|_| chance.between(-2.0, 2.0)).collect())
                .collect(),
        ),
        _ => Habit::Flat,
    };
    let mut wishes = |once: usize| {
        let mut list: Vec<Vec<f32>> =
            description.modalities.iter().map(|sense| preference(chance, sense.outcomes)).collect();
        list.truncate(if chance.once_in(once) { chance.below(list.len() + 1) } else { 0 });
        list
    };
    let (preferences, negative_preferences) = (wishes(3), wishes(2));
    Decision {
        sequences,
        listed,
        habits,
        scoring: scoring(chance),
        horizon,
        preferences,
        negative_preferences,
        meetings: (0..chance.pick(&[0, 0, 0, 1, 2])).map(|_| meeting(chance, description)).collect(),
        scope: description.all_groups() & if chance.once_in(8) { chance.below(16) as u16 } else { u16::MAX },
    }
}

fn meeting(chance: &mut Chance, description: &Description) -> Meeting {
    let factors = description.factors.len();
    Meeting { pair: [chance.below(factors), chance.below(factors)], seed: chance.bits().into() }
}

/// A way to score.
pub fn scoring(chance: &mut Chance) -> Scoring {
    Scoring {
        precision: chance.pick(&[0.1, 0.5, 1.0, 4.0, 16.0, 32.0]),
        gain: chance.pick(&[Gain::PerModality, Gain::Joint]),
        timing: chance.pick(&[PreferenceTiming::OnArrival, PreferenceTiming::EveryStep]),
        window: chance.pick(&[f32::INFINITY, f32::INFINITY, 3.0, 0.5]),
    }
}
