//! Execution logs: every move that a robot was told to make, and whether it was made, as a CSV
//! file.
//!
//! ```text
//! # map ...../..#../.....
//! tick,robot,cell,move,next,succeeded
//! 3,R1,0,right,1,1
//! 5,R1,1,right,1,0
//! ```
//! The first line draws the map, its rows apart by `/`. Waits are not logged.

use crate::fly::{Observer, Snapshot};
use crate::input::{FileError, utf8};
use crate::kept_output::KeptOutput;
use crate::scenario::{Floor, MAX_CELLS};
use crate::text::{move_called, move_name};
use iibt_core::grid::{Cell, Move};
use std::io::{self, Write};

const MAP: &str = "# map ";
const HEADER: &str = "tick,robot,cell,move,next,succeeded";

/// Writes the log of a flight.
#[derive(Debug)]
pub struct Logbook<W> {
    out: KeptOutput<W>,
    moves: Moves,
}

/// The moves that robots are making.
#[derive(Debug)]
struct Moves {
    /// The move that each robot is making, with the cell and tick in which it began; empty before
    /// the first tick.
    begun: Vec<Option<(u32, Cell, Move)>>,
    before: Vec<Cell>,
}

impl<W: Write> Logbook<W> {
    /// Creates an empty log.
    pub const fn new(out: W) -> Self {
        Self { out: KeptOutput::new(out), moves: Moves { begun: Vec::new(), before: Vec::new() } }
    }

    /// Returns the writer.
    ///
    /// # Errors
    /// The first error that occurred while writing; nothing was written after it.
    pub fn finish(self) -> io::Result<W> {
        self.out.finish()
    }
}

impl Moves {
    /// Writes those that have ended.
    fn write(&mut self, out: &mut impl Write, snapshot: &Snapshot<'_>) -> io::Result<()> {
        if self.before.is_empty() {
            writeln!(out, "{MAP}{}\n{HEADER}", drawn(&snapshot.scenario.map))?;
            self.begun = vec![None; snapshot.cells.len()];
        }
        for (index, robot) in snapshot.scenario.robots.iter().enumerate() {
            if let (Some(step), Some(&cell)) = (snapshot.commands[index], self.before.get(index)) {
                self.begun[index] =
                    Some((snapshot.tick.saturating_sub(1), cell, step)).filter(|_| step != Move::Wait);
            }
            if let Some((tick, cell, step)) = self.begun[index].take_if(|_| !snapshot.moving[index]) {
                let (next, name) = (snapshot.cells[index], quoted(&robot.name));
                let (step, made) = (move_name(step), u8::from(cell != next));
                writeln!(out, "{tick},{name},{},{step},{},{made}", cell.0, next.0)?;
            }
        }
        Ok(())
    }
}

impl<W: Write> Observer for Logbook<W> {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        self.out.write(|out| self.moves.write(out, snapshot));
        self.moves.before = snapshot.cells.to_vec();
    }
}

/// One move that a robot was told to make.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attempt {
    /// The tick, from zero.
    pub tick: u32,
    /// The robot's name.
    pub robot: String,
    /// The robot's cell before the move.
    pub cell: Cell,
    /// The move.
    pub step: Move,
    /// The robot's cell after the move.
    pub next: Cell,
    /// Whether the move succeeded; else the robot stayed.
    pub succeeded: bool,
}

/// A log read from a file, in which every attempt fits the map.
///
/// ```
/// use host_sim::{ExecutionLog, Learned};
///
/// let log = "# map .../...\n\
///            tick,robot,cell,move,next,succeeded\n\
///            3,R1,0,right,1,1\n\
///            5,R1,1,right,1,0\n";
/// let log = ExecutionLog::read("drive.csv", log.as_bytes())?;
/// let learned = Learned::from(&log);
/// let right = &learned.robots[0].moves[3];
/// assert_eq!((right.name, right.successes, right.failures), ("right", 1, 1));
/// assert_eq!(right.ratio, Some(0.5));
///
/// let wrong = ExecutionLog::read("drive.csv", b"# map ...\nno header\n").unwrap_err();
/// assert!(wrong.to_string().starts_with("drive.csv:2: "), "{wrong}");
/// # Ok::<(), host_sim::FileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ExecutionLog {
    /// The map the moves were made on.
    pub map: Floor,
    /// The attempts, in the order of the file.
    pub attempts: Vec<Attempt>,
}

impl ExecutionLog {
    /// Reads a log from the bytes of a file, which is called `name` in errors. Empty lines are
    /// skipped.
    ///
    /// # Errors
    /// [`FileError`] with the line and the reason for the first thing that is wrong.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, FileError> {
        let fault =
            |line, reason| FileError { file: name.to_owned(), line: Some(line), column: None, reason };
        let mut lines = (1..).zip(utf8(name, bytes)?.lines());
        let (_, first) = lines.next().unwrap_or((1, ""));
        let map = map_of(first).map_err(|reason| fault(1, reason))?;
        let (_, second) = lines.next().unwrap_or((2, ""));
        if second.trim() != HEADER {
            return Err(fault(2, format!("the second line is not \"{HEADER}\"")));
        }
        let rows = lines.filter(|(_, line)| !line.trim().is_empty());
        let attempts =
            rows.map(|(line, row)| attempt(&map, row.trim()).map_err(|reason| fault(line, reason)));
        Ok(Self { attempts: attempts.collect::<Result<_, _>>()?, map })
    }
}

fn drawn(map: &Floor) -> String {
    let mark = |cell| if map.is_free(Cell(cell)) { '.' } else { '#' };
    let cells: Vec<char> = (0..map.len() as u16).map(mark).collect();
    cells.chunks(usize::from(map.width())).map(String::from_iter).collect::<Vec<_>>().join("/")
}

fn map_of(line: &str) -> Result<Floor, String> {
    let drawing = line.trim().strip_prefix(MAP.trim_end()).map(str::trim);
    let drawing = drawing.ok_or_else(|| format!("the first line is not the map: \"{MAP}...../..#..\""))?;
    let rows: Vec<&str> = drawing.split('/').collect();
    let width = rows.first().map_or(0, |row| row.len());
    if let Some((number, row)) = rows.iter().enumerate().find(|(_, row)| row.len() != width) {
        return Err(format!("row {number} of the map has {} cells, but row 0 has {width}", row.len()));
    }
    let size = width.checked_mul(rows.len()).filter(|cells| (2..=MAX_CELLS).contains(cells));
    let mut map = size
        .and_then(|_| Floor::new(u16::try_from(width).ok()?, u16::try_from(rows.len()).ok()?).ok())
        .ok_or_else(|| format!("the map has {width} x {} cells, not 2 to {MAX_CELLS}", rows.len()))?;
    for (cell, mark) in (0..).map(Cell).zip(rows.concat().chars()) {
        match mark {
            '.' => {}
            '#' => _ = map.block(cell),
            other => {
                return Err(format!(
                    "'{}' is no cell of a map: '.' is free, '#' blocked",
                    other.escape_debug()
                ));
            }
        }
    }
    Ok(map)
}

fn attempt(map: &Floor, row: &str) -> Result<Attempt, String> {
    let (tick, rest) = row.split_once(',').ok_or_else(|| format!("there are no six values: {HEADER}"))?;
    // From the right: a robot's name may have commas.
    let mut values = rest.rsplitn(5, ',');
    let mut value = || values.next().ok_or_else(|| format!("there are no six values: {HEADER}"));
    let (succeeded, next, step, cell, robot) = (value()?, value()?, value()?, value()?, value()?);
    let tick = tick.parse().map_err(|_| format!("tick = {tick} is no whole number"))?;
    let (cell, next) = (free(map, "cell", cell)?, free(map, "next", next)?);
    let step = move_called(step)?;
    let succeeded = match succeeded {
        "1" => true,
        "0" => false,
        other => return Err(format!("succeeded = {other} is not 1 or 0")),
    };
    let led = if succeeded { map.neighbour(cell, step) } else { cell };
    if next != led || (succeeded && led == cell) {
        let (verb, name) = (if succeeded { "succeeded" } else { "failed" }, move_name(step));
        return Err(format!("a move {name} from {} that {verb} does not end on {}", cell.0, next.0));
    }
    Ok(Attempt { tick, robot: unquoted(robot)?, cell, step, next, succeeded })
}

fn free(map: &Floor, what: &str, text: &str) -> Result<Cell, String> {
    let cell = text.parse().ok().map(Cell).filter(|&cell| map.is_free(cell));
    cell.ok_or_else(|| format!("{what} = {text} is no free cell of the map"))
}

/// Returns a name quoted for CSV.
fn quoted(name: &str) -> String {
    if name.contains([',', '"']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

fn unquoted(text: &str) -> Result<String, String> {
    let inside = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
    let name = inside.map_or_else(|| text.to_owned(), |inside| inside.replace("\"\"", "\""));
    if name.trim().is_empty() { Err("the robot has no name".to_owned()) } else { Ok(name) }
}
