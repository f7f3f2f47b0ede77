//! What is new from one tick to the next.

use crate::news::News;
use crate::progress::agreed_round;
use crate::scenario::Floor;
use crate::world::World;
use iibt_core::navigation::{Report, Stage};

/// What the reports of two ticks in a row tell together.
pub(crate) fn between(before: &[Report], after: &[Report], world: &World) -> Vec<News> {
    let mut news = Vec::new();
    for (robot, (old, new)) in before.iter().zip(after).enumerate() {
        news.extend(leave(robot, old, new, world.battery(robot).percent()));
        news.extend(choice(robot, old, new, world.floor()));
        if new.stage == Stage::Arrived && old.stage != Stage::Arrived {
            news.push(News::Arrived { robot, cell: world.cells()[robot] });
        }
    }
    let round = agreed_round(after).filter(|&round| agreed_round(before) != Some(round));
    news.extend(round.map(|round| News::Agreed { round }));
    news
}

/// A choice is news when it is another one, or belongs to another round.
fn choice(robot: usize, old: &Report, new: &Report, floor: &Floor) -> Option<News> {
    let goal = new.goal.filter(|_| !matches!(new.stage, Stage::Deciding | Stage::Away))?;
    if old.round == new.round && old.path == new.path && old.goal == new.goal {
        return None;
    }
    let path = new.path.cells(floor).collect();
    Some(News::Chose { robot, round: new.round.0, goal, path, probability: new.probability })
}

/// Leaving the team to charge, and coming back.
fn leave(robot: usize, old: &Report, new: &Report, charge: u8) -> Option<News> {
    match (old.stage == Stage::Away, new.stage == Stage::Away) {
        (false, true) => Some(News::Left { robot, charge }),
        (true, false) => Some(News::Returned { robot, charge }),
        _ => None,
    }
}
