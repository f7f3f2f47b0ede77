//! What the robots of a mission do not know, as written and checked.

use super::drawing::Drawing;
use super::file::{self, ScenarioFile};
use super::{MAX_CELLS, RobotSpec, StrangerSpec, UnknownSpec};
use crate::input::{Fault, Read, RealNumber, optional, refuse, share};
use crate::text::counted;
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{Effect, MAX_UNKNOWNS, MAX_VALUES, MAX_WORLDS, Place, Sight, Tells};
use toml::Spanned;

/// The range in which a stranger must be seen: two robots that are no nearer come to no common cell
/// in a tick.
const NEAREST: u32 = 2;

/// As far as any map goes.
const FARTHEST: u32 = MAX_CELLS as u32;

impl Drawing {
    /// The unknowns of the mission.
    pub(super) fn unknowns(
        &self,
        file: &ScenarioFile,
        goals: &[Cell],
        robots: &[RobotSpec],
    ) -> Read<Vec<UnknownSpec>> {
        let mut unknowns: Vec<UnknownSpec> = Vec::new();
        for written in &file.unknowns {
            let of = |fault: Fault| fault.or_at(&written.span());
            let mut unknown = self.unknown(written.get_ref(), goals).map_err(of)?;
            let strangers = unknowns.iter().filter_map(|unknown| Some(unknown.stranger?.start));
            let taken: Vec<Cell> = robots.iter().map(|robot| robot.start).chain(strangers).collect();
            unknown.stranger = self.stranger(written.get_ref(), &unknown, &taken).map_err(of)?;
            may_be_blocked(written.get_ref(), &unknowns, &taken)?;
            if unknown.stranger.is_none() && unknown.sights.is_empty() {
                let reason = "nothing tells the value of this unknown: write beside = P, or add an \
                              [[unknown.sight]]";
                return refuse(written.span(), reason);
            }
            unknowns.push(unknown);
        }
        room(&unknowns, file)?;
        Ok(unknowns)
    }

    fn unknown(&self, written: &file::UnknownEntry, goals: &[Cell]) -> Read<UnknownSpec> {
        let (effect, key, groups) = effect(written)?;
        let prior = prior(written, effect, key, values(effect, key, groups)?)?;
        let cells = self.places(effect, groups, goals)?;
        let sights = self.sights(written, &cells, effect, prior.len())?;
        let last = prior.len() as u32 - 1;
        let real = optional("real", written.real.as_ref(), 0..=last)?.map(|value| value as u8);
        if let (Some(value), Some(number)) = (real, &written.real)
            && prior[usize::from(value)] == 0.0
        {
            let reason = format!("real = {value}, but the prior of that value is 0: robots rule it out");
            return refuse(number.span(), reason);
        }
        Ok(UnknownSpec { effect, cells, prior, sights, real, stranger: None })
    }

    /// The cells of an unknown, each with its value.
    fn places(&self, effect: Effect, groups: &file::Groups, goals: &[Cell]) -> Read<Vec<Place>> {
        let first = usize::from(effect == Effect::Blocks);
        let mut places: Vec<Place> = Vec::new();
        for (value, group) in groups.get_ref().iter().enumerate() {
            for number in group {
                let cell = self.free("a cell of an unknown", number)?;
                if effect != Effect::Blocks && !goals.contains(&cell) {
                    return refuse(
                        number.span(),
                        format!("{} is no goal: it neither serves nor is taken", cell.0),
                    );
                }
                if places.iter().any(|place| place.cell == cell) {
                    return refuse(number.span(), format!("{} belongs to the unknown already", cell.0));
                }
                places.push(Place::new(cell, (value + first) as u8));
            }
        }
        let empty = groups.get_ref().iter().filter(|group| group.is_empty()).count();
        if empty + first > 1 {
            let other =
                if first == 1 { "value 0, in which nothing is blocked" } else { "the other empty one" };
            return refuse(groups.span(), format!("an empty group means the same as {other}"));
        }
        Ok(places)
    }

    /// From where an unknown is seen: as its sights say, then from beside its cells.
    fn sights(
        &self,
        written: &file::UnknownEntry,
        cells: &[Place],
        effect: Effect,
        values: usize,
    ) -> Read<Vec<Sight>> {
        let mut sights: Vec<Sight> = Vec::new();
        let is_known = |sights: &[Sight], from, tells| {
            sights.iter().any(|sight| (sight.from, sight.tells) == (from, tells))
        };
        for entry in written.sights.iter().map(Spanned::get_ref) {
            let sight = self.sight(entry, values)?;
            if is_known(&sights, sight.from, sight.tells) {
                let reason = format!("the unknown has such a sight from {} already", sight.from.0);
                return refuse(entry.from.span(), reason);
            }
            sights.push(sight);
        }
        let Some(beside) = &written.beside else { return Ok(sights) };
        let right = right("beside", Some(beside), 2)?;
        for (from, value) in self.beside(cells, effect) {
            let tells = Tells::Whether(value);
            if is_known(&sights, from, tells) {
                let reason =
                    format!("a sight from {} tells of value {value} already, which beside does too", from.0);
                return refuse(beside.span(), reason);
            }
            sights.push(Sight { from, tells, right });
        }
        Ok(sights)
    }

    /// The stranger whose goal an unknown is; it starts where nobody else does, with a way to every
    /// goal that it may take.
    fn stranger(
        &self,
        written: &file::UnknownEntry,
        unknown: &UnknownSpec,
        taken: &[Cell],
    ) -> Read<Option<StrangerSpec>> {
        let Some(number) = &written.start else {
            return match (unknown.effect, &written.range) {
                (Effect::Takes, _) => Err(Fault::anywhere("a stranger takes a goal: write its start = CELL")),
                (_, Some(range)) => refuse(range.span(), "only a stranger has a range".to_owned()),
                _ => Ok(None),
            };
        };
        if unknown.effect != Effect::Takes {
            return refuse(number.span(), "only a stranger, which takes a goal, has a start".to_owned());
        }
        if unknown.cells.len() != unknown.prior.len() {
            return Err(Fault::anywhere("a stranger goes to one goal: takes = [[CELL], [CELL], ...]"));
        }
        let start = self.free("start", number)?;
        if taken.contains(&start) {
            return refuse(number.span(), format!("another robot starts on {}", start.0));
        }
        let near = self.map.connected(start);
        if let Some(place) = unknown.cells.iter().find(|place| !near.contains(place.cell)) {
            return refuse(
                number.span(),
                format!("no way leads from {} to the goal {}", start.0, place.cell.0),
            );
        }
        let range = optional("range", written.range.as_ref(), NEAREST..=FARTHEST)?;
        Ok(Some(StrangerSpec { start, range: range.map(|cells| cells as u16) }))
    }

    fn sight(&self, written: &file::SightEntry, values: usize) -> Read<Sight> {
        let last = values as u32 - 1;
        let value = optional("tells", written.tells.as_ref(), 0..=last)?;
        let (tells, answers) = match value {
            Some(value) => (Tells::Whether(value as u8), 2),
            None => (Tells::Value, values),
        };
        let right = right("right", written.right.as_ref(), answers)?;
        Ok(Sight { from: self.free("from", &written.from)?, tells, right })
    }

    /// The cells beside those of an unknown, and these themselves where a robot can stand on them,
    /// each with the value that is seen from there, once.
    fn beside(&self, cells: &[Place], effect: Effect) -> impl Iterator<Item = (Cell, u8)> + '_ {
        let mut seen = Vec::new();
        for place in cells {
            let beside = Move::ALL.into_iter().map(|step| self.map.neighbour(place.cell, step));
            let beside = beside.filter(|&cell| cell != place.cell && self.map.is_free(cell));
            let itself = Some(place.cell).filter(|_| effect == Effect::Serves);
            for cell in itself.into_iter().chain(beside) {
                if !seen.contains(&(cell, place.value)) {
                    seen.push((cell, place.value));
                }
            }
        }
        seen.into_iter()
    }
}

/// What an unknown means for its cells, and the key with their groups.
fn effect(written: &file::UnknownEntry) -> Read<(Effect, &'static str, &file::Groups)> {
    let keys = [
        (Effect::Blocks, "blocks", &written.blocks),
        (Effect::Serves, "serves", &written.serves),
        (Effect::Takes, "takes", &written.takes),
    ];
    let mut given =
        keys.into_iter().filter_map(|(effect, key, groups)| Some((effect, key, groups.as_ref()?)));
    match (given.next(), given.next()) {
        (Some(only), None) => Ok(only),
        (Some((_, one, _)), Some((_, other, groups))) => refuse(
            groups.span(),
            format!("an unknown has {one} or {other}, not both: leave one of the two out"),
        ),
        (None, _) => Err(Fault::anywhere(
            "an unknown needs one of blocks, serves and takes: the cells that it may block, the goals \
             that may serve, or those that a stranger may take",
        )),
    }
}

/// The number of values of an unknown, at least two.
fn values(effect: Effect, key: &str, groups: &file::Groups) -> Read<usize> {
    let count = groups.get_ref().len();
    let (values, least) = if effect == Effect::Blocks { (count + 1, 1) } else { (count, 2) };
    if count < least {
        let reason = format!("{key} has {}: list {least} or more", counted(count as u32, "group"));
        return refuse(groups.span(), reason);
    }
    Ok(values)
}

/// The probability of each of so many values, which add up to one.
fn prior(written: &file::UnknownEntry, effect: Effect, key: &str, values: usize) -> Read<Vec<f32>> {
    let listed = written.prior.get_ref();
    let prior = listed.iter().map(|p| share("prior", Some(p), 0.0)).collect::<Read<Vec<f64>>>()?;
    if prior.len() != values {
        let first = if effect == Effect::Blocks { "one that nothing is blocked, and " } else { "" };
        let count = match prior.len() {
            1 => "1 probability".to_owned(),
            count => format!("{count} probabilities"),
        };
        let reason = format!("{count} for {values} values: {key} has {first}one for each group");
        return refuse(written.prior.span(), reason);
    }
    let sum: f64 = prior.iter().sum();
    if (sum - 1.0).abs() > 1e-4 {
        let sum = (sum * 1e6).round() / 1e6;
        let reason = format!("the probabilities of the values add up to {sum}, not to 1");
        return refuse(written.prior.span(), reason);
    }
    Ok(prior.into_iter().map(|p| p as f32).collect())
}

/// The probability that a reading is right, which has this many possible answers: more than that of
/// a guess.
fn right(key: &str, number: Option<&RealNumber>, answers: usize) -> Read<f32> {
    let right = share(key, number, 1.0)? as f32;
    match number {
        Some(number) if right * answers as f32 <= 1.0 => refuse(
            number.span(),
            format!("{key} = {right} is no better than a guess: of {answers} answers it is over 1/{answers}"),
        ),
        _ => Ok(right),
    }
}

/// Whether the cells that an unknown may block are no other's, and nobody starts there.
fn may_be_blocked(written: &file::UnknownEntry, others: &[UnknownSpec], starts: &[Cell]) -> Read<()> {
    let groups = written.blocks.iter().flat_map(Spanned::get_ref);
    let others = others.iter().filter(|other| other.effect == Effect::Blocks);
    for number in groups.flatten() {
        let is_it = |cell: Cell| i64::from(cell.0) == *number.get_ref();
        if starts.iter().copied().any(is_it) {
            return refuse(
                number.span(),
                format!("{} is where a robot starts: it is not blocked", number.get_ref()),
            );
        }
        if others.clone().flat_map(|other| &other.cells).any(|place| is_it(place.cell)) {
            return refuse(number.span(), format!("{} belongs to another unknown already", number.get_ref()));
        }
    }
    Ok(())
}

/// Whether there is room for so many values, and combinations of them.
fn room(unknowns: &[UnknownSpec], file: &ScenarioFile) -> Read<()> {
    let values = || unknowns.iter().map(|unknown| unknown.prior.len());
    let most = [
        (unknowns.len(), MAX_UNKNOWNS, "unknowns"),
        (values().sum(), MAX_VALUES, "values of unknowns"),
        (values().fold(1, usize::saturating_mul), MAX_WORLDS, "combinations of the values of unknowns"),
    ];
    match (most.into_iter().find(|&(count, most, _)| count > most), file.unknowns.last()) {
        (Some((count, most, what)), Some(last)) => {
            refuse(last.span(), format!("{count} {what}, but a mission has at most {most}"))
        }
        _ => Ok(()),
    }
}
