//! What a tree has done tick by tick, as a robot or a run has recorded it.

use super::instance::Instance;
use super::records::records;
use crate::input::{FileError, utf8};
use iibt_core::time::Instant;
use iibt_core::tree::{NodeChange, Status, StatusChange};
use std::collections::BTreeSet;

/// The first bytes of a file of Groot2.
pub(super) const MAGIC: &[u8] = b"BTCPP4-FileLogger2";

/// A tick of a tree that was recorded, or a halt of the whole tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedTick {
    /// Its number; where the form of the log has none, its place in the log from one.
    pub tick: u32,
    /// The time in milliseconds.
    pub time: Instant,
    /// The nodes that it has changed, in their order.
    pub changes: Vec<NodeChange>,
    /// Where it stands in the log: `line 7`.
    pub place: String,
    /// Why the tree's state is not known before it: it begins the log, or something is missing.
    pub(super) before: Before,
}

/// What comes before a tick in a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Before {
    /// The tick that is recorded before, and others that changed the same nodes.
    Tick,
    /// The start of the robot, or of the run.
    Start,
    /// Something that is missing.
    Gap(String),
}

impl Instance {
    /// Reads the ticks of this tree from a log, which is called `name` in errors: lines of a
    /// [`TickEntry`](iibt_core::tree::TickEntry) as images and `run --tree-log` write them, also
    /// with other lines in between; a file of Groot2; or records of nine bytes. Of a log with the
    /// lines of several robots, `robot` names the one that is meant.
    ///
    /// # Errors
    /// [`FileError`] with the line and the reason, when this is no such log, or none of this tree.
    pub fn recorded(
        &self,
        name: &str,
        bytes: &[u8],
        robot: Option<&str>,
    ) -> Result<Vec<RecordedTick>, FileError> {
        let refuse = |line, reason| FileError { file: name.to_owned(), line, column: None, reason };
        if bytes.is_empty() {
            return Err(refuse(None, "the log is empty".into()));
        }
        let is_text = !bytes.contains(&0) && std::str::from_utf8(bytes).is_ok();
        if is_text && !bytes.starts_with(MAGIC) {
            return lines(name, utf8(name, bytes)?, robot, self.nodes.len());
        }
        if let Some(robot) = robot {
            return Err(refuse(
                None,
                format!("only a log of lines tells robots apart; \"{robot}\" is not in it"),
            ));
        }
        let records = match bytes.strip_prefix(MAGIC) {
            Some(rest) => self.groot(rest),
            None => self.records(bytes),
        };
        Ok(ticks_of(&records.map_err(|reason| refuse(None, reason))?))
    }

    /// The records in a file of Groot2, after its first bytes.
    fn groot(&self, rest: &[u8]) -> Result<Vec<StatusChange>, String> {
        let cut_off = || "the file ends within its head".to_owned();
        let (&[_version, a, b, c, d], rest) = rest.split_first_chunk().ok_or_else(cut_off)?;
        let len = usize::try_from(i32::from_le_bytes([a, b, c, d])).map_err(|_| cut_off())?;
        let (xml, rest) = rest.split_at_checked(len).ok_or_else(cut_off)?;
        let nodes = String::from_utf8_lossy(xml).matches(" _uid=\"").count();
        if nodes != self.nodes.len() {
            let (main, own) = (&self.main, self.nodes.len());
            return Err(format!("the log is of a tree of {nodes} nodes, and '{main}' has {own}"));
        }
        let (_start, rest) = rest.split_first_chunk::<8>().ok_or_else(cut_off)?;
        records(rest, nodes)
    }
}

/// The ticks of records: those of one time are of one tick, or of several passes in it.
fn ticks_of(records: &[StatusChange]) -> Vec<RecordedTick> {
    // That a finished node is idle again the file of Groot2 says, and the engine does not.
    let told: Vec<_> =
        (1..).zip(records).filter(|(_, record)| record.to.is_some() || record.from.is_some()).collect();
    let groups = told.chunk_by(|(_, a), (_, b)| a.time == b.time);
    (1..)
        .zip(groups)
        .map(|(tick, group)| RecordedTick {
            tick,
            time: group[0].1.time,
            changes: group
                .iter()
                .map(|(_, record)| NodeChange { node: record.node, to: record.to })
                .collect(),
            place: format!("record {}", group[0].0),
            before: if tick == 1 { Before::Start } else { Before::Tick },
        })
        .collect()
}

/// A line about a tree's tick.
struct Line {
    robot: Option<String>,
    entry: u32,
    dropped: u32,
    tick: RecordedTick,
}

fn lines(name: &str, text: &str, robot: Option<&str>, nodes: usize) -> Result<Vec<RecordedTick>, FileError> {
    let fault = |line, reason| FileError { file: name.to_owned(), line, column: None, reason };
    let mut found: Vec<Line> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        found.extend(read_line(number, line, nodes).map_err(|reason| fault(Some(number), reason))?);
    }
    if found.is_empty() {
        let reason = "no line is about a tree, like \"tick 7: tree 3 at 600 ms: 1:S\": was the image built with the \
                      feature explain?";
        return Err(fault(None, reason.into()));
    }
    let robots: BTreeSet<_> = found.iter().filter_map(|line| line.robot.clone()).collect();
    let names = || robots.iter().cloned().collect::<Vec<_>>().join(", ");
    match robot {
        Some(robot) if !robots.contains(robot) => {
            return Err(fault(None, format!("no robot is called \"{robot}\" there, only {}", names())));
        }
        None if robots.len() > 1 => {
            return Err(fault(
                None,
                format!("the log is of several robots: {}; choose one with --robot", names()),
            ));
        }
        _ => found.retain(|line| robot.is_none() || line.robot.as_deref() == robot),
    }
    Ok(in_order(found))
}

/// The ticks, with what is missing between them.
fn in_order(lines: Vec<Line>) -> Vec<RecordedTick> {
    let (mut last, mut dropped) = (0, 0);
    let tick = |line: Line| {
        let before = match line.entry {
            1 => Before::Start,
            entry if dropped > 0 => {
                Before::Gap(format!("{dropped} changes of entry {} are missing", entry - 1))
            }
            entry if entry == last + 1 => Before::Tick,
            entry if entry > last + 1 => Before::Gap(missing(last + 1, entry - 1)),
            entry => Before::Gap(format!("entry {entry} comes after entry {last}")),
        };
        (last, dropped) = (line.entry, line.dropped);
        RecordedTick { before, ..line.tick }
    };
    lines.into_iter().map(tick).collect()
}

fn missing(from: u32, to: u32) -> String {
    if from == to {
        format!("entry {from} is missing")
    } else {
        format!("entries {from} to {to} are missing")
    }
}

/// Reads a line of a log, as text or as an object of `host-sim log --json`; `None` for one about
/// something else.
fn read_line(number: usize, line: &str, nodes: usize) -> Result<Option<Line>, String> {
    let message =
        line.starts_with('{').then(|| serde_json::from_str::<serde_json::Value>(line).ok()).flatten();
    let message = message.as_ref().and_then(|object| object.get("message")?.as_str());
    let text = message.unwrap_or(line);
    let Some((head, rest)) = text.split_once(": tree ") else { return Ok(None) };
    let Some((before, tick)) = head.rsplit_once("tick ") else { return Ok(None) };
    let Ok(tick) = tick.parse() else { return Ok(None) };
    let robot = before.trim().strip_prefix("robot ").and_then(|name| name.strip_suffix(':'));
    let entry = || format!("\"tree {rest}\" is no entry, like \"tree 3 at 600 ms: 1:S 2:R\"");
    let (entry_number, rest) = rest.split_once(" at ").ok_or_else(entry)?;
    let (time, changes) = rest.split_once(" ms:").ok_or_else(entry)?;
    let whole = |text: &str| text.parse::<u32>().map_err(|_| format!("\"{text}\" is no whole number"));
    let (changes, dropped) = match changes.split_once(" and ") {
        Some((changes, dropped)) => (changes, whole(dropped.split(' ').next().unwrap_or_default())?),
        None => (changes, 0),
    };
    // What follows in parentheses is the place in the source, which other decoders add.
    let changes = changes.split(" (").next().unwrap_or_default().split_whitespace();
    let changes = changes.map(|change| read_change(change, nodes)).collect::<Result<_, _>>()?;
    let (time, place) = (Instant(whole(time)?), format!("line {number}"));
    let entry = whole(entry_number)?;
    if entry == 0 {
        return Err("entries of a tree are numbered from 1".into());
    }
    let tick = RecordedTick { tick, time, changes, place, before: Before::Tick };
    Ok(Some(Line { robot: robot.map(str::to_owned), entry, dropped, tick }))
}

fn read_change(text: &str, nodes: usize) -> Result<NodeChange, String> {
    let refuse = || format!("\"{text}\" is no change of a node, like 3:S; letters are S, F, R, K and I");
    let (node, letter) = text.split_once(':').ok_or_else(refuse)?;
    let node: u16 = node.parse().map_err(|_| refuse())?;
    if usize::from(node) >= nodes {
        return Err(format!("\"{text}\": the tree has no node {node}: there are {nodes}, from 0"));
    }
    let to = match letter {
        "S" => Some(Status::Success),
        "F" => Some(Status::Failure),
        "R" => Some(Status::Running),
        "K" => Some(Status::Skipped),
        "I" => None,
        _ => return Err(refuse()),
    };
    Ok(NodeChange { node, to })
}
