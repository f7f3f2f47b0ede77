//! Learning B from an execution log: how often each robot's moves succeed.

use crate::log::ExecutionLog;
use crate::scenario::Floor;
use crate::statistics::wilson;
use crate::text::move_name;
use iibt_core::grid::{Cell, Move};
use serde::Serialize;

/// The moves that can fail: all but to wait.
const MOVES: [Move; 4] = [Move::Up, Move::Down, Move::Left, Move::Right];

/// The transition probabilities learned from a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Learned {
    /// The actions, in the order of B's last index.
    pub actions: [&'static str; Move::ALL.len()],
    /// The robots in the order in which the log first names them, which is the order of B's
    /// factors.
    pub robots: Vec<RobotRatios>,
    /// P(s' | s, u) as `B[f][s'][s][u]`: factor, next cell, cell, action. A move leads to its cell
    /// with its ratio and else fails. A move that was never tried, or that leads nowhere, is
    /// certain.
    #[serde(rename = "B")]
    pub b: Vec<Vec<Vec<Vec<f64>>>>,
}

/// One robot's moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotRatios {
    /// Its name.
    pub robot: String,
    /// Its moves up, down, left and right.
    pub moves: Vec<MoveRatio>,
}

/// The success ratio of one robot's move.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MoveRatio {
    /// The move.
    #[serde(rename = "move")]
    pub name: &'static str,
    /// The number of successes.
    pub successes: u32,
    /// The number of failures.
    pub failures: u32,
    /// successes / (successes + failures); `None` when it was never tried.
    pub ratio: Option<f64>,
    /// The true probability lies between these with 95 % confidence: the score interval (Wilson
    /// 1927).
    pub interval: Option<[f64; 2]>,
}

impl Learned {
    /// Counts the attempts of a log and computes B: for each robot cells x cells x actions numbers.
    #[must_use]
    pub fn from(log: &ExecutionLog) -> Self {
        let mut names: Vec<&str> = Vec::new();
        for attempt in &log.attempts {
            if !names.contains(&attempt.robot.as_str()) {
                names.push(&attempt.robot);
            }
        }
        let robots: Vec<_> = names.into_iter().map(|name| RobotRatios::of(log, name)).collect();
        let b = robots.iter().map(|robot| robot.transition(&log.map)).collect();
        Self { actions: Move::ALL.map(move_name), robots, b }
    }

    /// Returns one line of JSON.
    ///
    /// # Errors
    /// None that can occur: every key is text.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    /// Returns a table with a line for each robot and move.
    #[must_use]
    pub fn table(&self) -> String {
        let widest = self.robots.iter().map(|of| of.robot.chars().count()).max().unwrap_or(0).max(5);
        let mut text = format!("{:<widest$}  move   successes  failures  ratio  95 % interval\n", "robot");
        for of in &self.robots {
            for of_move in &of.moves {
                text += &format!("{:<widest$}  {}\n", of.robot, of_move.line());
            }
        }
        text
    }
}

impl RobotRatios {
    fn of(log: &ExecutionLog, name: &str) -> Self {
        let moves = MOVES.map(|step| {
            let tries = log.attempts.iter().filter(|attempt| attempt.robot == name && attempt.step == step);
            let (successes, failures): (Vec<_>, Vec<_>) = tries.partition(|attempt| attempt.succeeded);
            MoveRatio::new(step, successes.len() as u32, failures.len() as u32)
        });
        Self { robot: name.to_owned(), moves: moves.into() }
    }

    /// Returns B of this robot, `[s'][s][u]`.
    fn transition(&self, map: &Floor) -> Vec<Vec<Vec<f64>>> {
        let cells = || (0..map.len() as u16).map(Cell);
        let column =
            |next, cell| Move::ALL.iter().map(|&step| self.probability(map, step, next, cell)).collect();
        cells().map(|next| cells().map(|cell| column(next, cell)).collect()).collect()
    }

    fn probability(&self, map: &Floor, step: Move, next: Cell, cell: Cell) -> f64 {
        let ahead = map.neighbour(cell, step);
        let to = if map.is_free(ahead) { ahead } else { cell };
        let ratio =
            self.moves.iter().find(|of| of.name == move_name(step)).and_then(|of| of.ratio).unwrap_or(1.0);
        match (next == to, next == cell) {
            (true, true) => 1.0,
            (true, false) => ratio,
            (false, true) => 1.0 - ratio,
            (false, false) => 0.0,
        }
    }
}

impl MoveRatio {
    fn new(step: Move, successes: u32, failures: u32) -> Self {
        let (made, tries) = (f64::from(successes), f64::from(successes) + f64::from(failures));
        let tried = tries > 0.0;
        Self {
            name: move_name(step),
            successes,
            failures,
            ratio: tried.then(|| made / tries),
            interval: tried.then(|| wilson(made / tries, tries)),
        }
    }

    fn line(&self) -> String {
        let counts = format!("{:<5}  {:>9}  {:>8}", self.name, self.successes, self.failures);
        match (self.ratio, self.interval) {
            (Some(ratio), Some([low, high])) => format!("{counts}  {ratio:.3}  {low:.3} to {high:.3}"),
            _ => format!("{counts}      -  never tried"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn b_has_a_column_for_every_cell_and_action() {
        let text = "# map ../.#\ntick,robot,cell,move,next,succeeded\n0,A,0,right,1,1\n1,A,1,left,1,0\n\
                    2,A,1,left,0,1\n3,B,0,down,2,1\n";
        let learned = Learned::from(&ExecutionLog::read("a.csv", text.as_bytes()).unwrap());
        assert_eq!(learned.robots.iter().map(|of| of.robot.as_str()).collect::<Vec<_>>(), ["A", "B"]);
        let of = |f: usize, next: usize, cell: usize, action: usize| learned.b[f][next][cell][action];
        assert_eq!((of(0, 0, 1, 2), of(0, 1, 1, 2), of(0, 1, 0, 3), of(1, 0, 1, 2)), (0.5, 0.5, 1.0, 1.0));
        assert_eq!(of(0, 1, 1, 1), 1.0, "the cell below is blocked");
        for robot in &learned.b {
            for cell in 0..4 {
                for action in 0..5 {
                    let sum: f64 = robot.iter().map(|row| row[cell][action]).sum();
                    assert_eq!(sum, 1.0, "{cell}, {action}");
                }
            }
        }
        assert!(
            learned.table().contains("A      left           1         1  0.500  0.095 to 0.905"),
            "{}",
            learned.table()
        );
        assert!(learned.table().contains("B      up             0         0      -  never tried"));
    }
}
