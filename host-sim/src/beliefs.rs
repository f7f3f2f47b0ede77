//! What robots believe about what is not known, for displays and records.

use crate::flight_event::FlightEvent;
use crate::scenario::UnknownSpec;
use iibt_core::inference::Worlds;
use iibt_core::navigation::{Effect, MAX_WORLDS};

/// By how much a probability must change to be told.
const WORTH_TELLING: f32 = 0.005;

/// What each robot was last said to believe: the probability of each value of each unknown.
#[derive(Clone, Debug)]
pub(crate) struct Beliefs(Vec<Vec<Vec<f32>>>);

impl Beliefs {
    /// All robots believe the prior.
    pub(crate) fn new(unknowns: &[UnknownSpec], robots: usize) -> Self {
        Self(vec![unknowns.iter().map(|unknown| unknown.prior.clone()).collect(); robots])
    }

    /// The event of a robot that believes something else than it was said to; a robot that does not
    /// tell its worlds has none.
    pub(crate) fn changed(
        &mut self,
        unknowns: &[UnknownSpec],
        robot: usize,
        worlds: Vec<f32>,
    ) -> Option<FlightEvent> {
        let known = self.0.get_mut(robot).filter(|_| !worlds.is_empty())?;
        let now = marginals(unknowns, &worlds);
        let pairs = now.iter().flatten().zip(known.iter().flatten());
        if pairs.into_iter().all(|(new, old)| (new - old).abs() < WORTH_TELLING) {
            return None;
        }
        known.clone_from(&now);
        Some(FlightEvent::Believes { robot, unknowns: now, worlds })
    }
}

/// The probability of each value of each unknown, by those of the worlds.
fn marginals(unknowns: &[UnknownSpec], worlds: &[f32]) -> Vec<Vec<f32>> {
    let priors: Vec<&[f32]> = unknowns.iter().map(|unknown| unknown.prior.as_slice()).collect();
    // A scenario has no more worlds than that, and its priors are distributions.
    let known = Worlds::<MAX_WORLDS>::new(&priors).unwrap_or(Worlds::NONE);
    let of = |(number, prior): (usize, &&[f32])| {
        (0..prior.len()).map(|value| known.probability(worlds, number, value)).collect()
    };
    priors.iter().enumerate().map(of).collect()
}

/// Beliefs in words: which goals serve or are taken, which cells are blocked, each with its
/// probability.
pub(crate) fn told(unknowns: &[UnknownSpec], beliefs: &[Vec<f32>]) -> String {
    let mut parts = Vec::new();
    for (unknown, of_values) in unknowns.iter().zip(beliefs) {
        let what = match unknown.effect {
            Effect::Blocks => "blocked",
            Effect::Serves => "serves",
            Effect::Takes => "is taken",
        };
        for (value, p) in of_values.iter().enumerate() {
            let first = unknown.cells.iter().find(|place| usize::from(place.value) == value);
            parts.extend(first.map(|place| format!("{} {what} {p:.3}", place.cell.0)));
        }
    }
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use iibt_core::grid::Cell;
    use iibt_core::navigation::{Place, Unknown};

    fn unknowns() -> Vec<UnknownSpec> {
        let goals = [Place::new(Cell(3), 0), Place::new(Cell(4), 0), Place::new(Cell(7), 1)];
        let of = |effect, cells: &[Place], prior: &[f32]| {
            UnknownSpec::from(&Unknown { effect, cells, prior, sights: &[] })
        };
        let (gate, prior) = ([Place::new(Cell(9), 1)], [0.5, 0.5]);
        vec![of(Effect::Blocks, &gate, &prior), of(Effect::Serves, &goals, &[0.25, 0.75])]
    }

    #[test]
    fn the_last_unknown_changes_fastest_and_small_changes_are_not_told() {
        let mut beliefs = Beliefs::new(&unknowns(), 2);
        assert_eq!(beliefs.changed(&unknowns(), 0, vec![]), None, "it does not tell");
        assert_eq!(beliefs.changed(&unknowns(), 0, vec![0.125, 0.377, 0.123, 0.375]), None);
        let worlds = vec![0.1, 0.0, 0.3, 0.6];
        let Some(FlightEvent::Believes { robot, unknowns: now, .. }) =
            beliefs.changed(&unknowns(), 1, worlds.clone())
        else {
            panic!("it believes something else")
        };
        assert_eq!(
            (robot, told(&unknowns(), &now).as_str()),
            (1, "9 blocked 0.900, 3 serves 0.400, 7 serves 0.600")
        );
        assert_eq!(beliefs.changed(&unknowns(), 1, worlds), None, "it was told");
    }
}
