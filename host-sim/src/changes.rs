//! The events between two ticks.

use crate::flight_event::FlightEvent;
use crate::progress::agreed_round;
use crate::scenario::Floor;
use crate::world::World;
use iibt_core::navigation::{Report, Stage};

/// Returns the events that follow from the reports of two ticks in a row.
pub(crate) fn between(before: &[Report], after: &[Report], world: &World) -> Vec<FlightEvent> {
    let mut events = Vec::new();
    for (robot, (old, new)) in before.iter().zip(after).enumerate() {
        events.extend(leave(robot, old, new, world.battery(robot).percent()));
        let obstructed = new.obstructed.filter(|_| new.obstructed != old.obstructed);
        events.extend(obstructed.map(|cell| FlightEvent::Obstructed { robot, cell }));
        events.extend(choice(robot, old, new, world.floor()));
        if new.stage == Stage::Arrived && old.stage != Stage::Arrived {
            events.push(FlightEvent::Arrived { robot, cell: world.cells()[robot] });
        }
    }
    let round = agreed_round(after).filter(|&round| agreed_round(before) != Some(round));
    events.extend(round.map(|round| FlightEvent::Agreed { round }));
    events
}

/// A choice is an event when it is another one, or belongs to another round. A robot that charges
/// or does not get on has chosen no goal.
fn choice(robot: usize, old: &Report, new: &Report, floor: &Floor) -> Option<FlightEvent> {
    let goal = new.goal.filter(|_| !matches!(new.stage, Stage::Deciding | Stage::Away | Stage::Stuck))?;
    if old.round == new.round && old.path == new.path && old.goal == new.goal {
        return None;
    }
    let path = new.path.cells(floor).collect();
    Some(FlightEvent::Chose { robot, round: new.round, goal, path, probability: new.probability })
}

/// Returns the event of a robot that leaves the team or comes back.
fn leave(robot: usize, old: &Report, new: &Report, charge: u8) -> Option<FlightEvent> {
    match (old.stage == Stage::Away, new.stage == Stage::Away) {
        (false, true) => Some(FlightEvent::Left { robot, charge }),
        (true, false) => Some(FlightEvent::Returned { robot, charge }),
        _ => None,
    }
}
