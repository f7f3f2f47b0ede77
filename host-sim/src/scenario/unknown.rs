//! What the robots of a mission do not know, as written and checked.

use super::drawing::Drawing;
use super::file::{self, ScenarioFile};
use super::{MAX_CELLS, RobotSpec, StrangerSpec, UnknownSpec};
use crate::input::{Fault, Read, optional, refuse, share, whole};
use crate::text::counted;
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{Effect, MAX_UNKNOWNS, MAX_VALUES, MAX_WORLDS, Place, Sight, Tells};

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
            unknowns.push(unknown);
        }
        room(&unknowns, file)?;
        Ok(unknowns)
    }

    fn unknown(&self, written: &file::UnknownEntry, goals: &[Cell]) -> Read<UnknownSpec> {
        let (effect, key, groups) = effect(written)?;
        let prior = prior(written, effect, key, values(effect, key, groups)?)?;
        let first = prior.len() - groups.get_ref().len();
        let mut cells: Vec<Place> = Vec::new();
        for (value, group) in groups.get_ref().iter().enumerate() {
            for number in group {
                let cell = self.free("a cell of an unknown", number)?;
                if effect != Effect::Blocks && !goals.contains(&cell) {
                    return refuse(
                        number.span(),
                        format!("{} is no goal: it neither serves nor is taken", cell.0),
                    );
                }
                if cells.iter().any(|place| place.cell == cell) {
                    return refuse(number.span(), format!("{} belongs to the unknown already", cell.0));
                }
                cells.push(Place::new(cell, (value + first) as u8));
            }
        }
        let mut sights = written
            .sights
            .iter()
            .map(|sight| self.sight(sight.get_ref(), prior.len()))
            .collect::<Read<Vec<_>>>()?;
        if written.beside.is_some() {
            let right = share("beside", written.beside.as_ref(), 1.0)? as f32;
            sights.extend(self.beside(&cells, effect).map(|(from, value)| Sight {
                from,
                tells: Tells::Whether(value),
                right,
            }));
        }
        let last = prior.len() as u32 - 1;
        let real = written.real.as_ref().map(|real| whole("real", Some(real), 0..=last, 0)).transpose()?;
        let real = real.map(|value| value as u8);
        Ok(UnknownSpec { effect, cells, prior, sights, real, stranger: None })
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
        let value =
            written.tells.as_ref().map(|value| whole("tells", Some(value), 0..=last, 0)).transpose()?;
        let tells = value.map_or(Tells::Value, |value| Tells::Whether(value as u8));
        let right = share("right", written.right.as_ref(), 1.0)? as f32;
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
