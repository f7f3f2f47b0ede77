//! The figures of the report, as data.

use crate::statistics::{Distribution, Share};
use crate::{Record, RobotRecord};
use iibt_core::grid::Cell;
use serde::Serialize;

/// A figure and what it shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// The caption.
    pub caption: String,
    /// The pictures, side by side.
    pub panels: Vec<Panel>,
}

/// One picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Panel {
    /// Paths on a map.
    Grid(Grid),
    /// Bars, the paper's beside ours.
    Bars(Bars),
    /// Curves.
    Lines(Lines),
    /// Values with their intervals.
    Intervals(Intervals),
    /// A tree.
    Tree(TreePicture),
}

/// A map with goals, obstacles and paths.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Grid {
    /// The picture's title.
    pub title: String,
    /// Columns.
    pub width: u16,
    /// Rows.
    pub height: u16,
    /// The goals.
    pub goals: Vec<Cell>,
    /// The blocked cells.
    pub blocked: Vec<Cell>,
    /// The chargers.
    pub chargers: Vec<Cell>,
    /// The way-points.
    pub way_points: Vec<Cell>,
    /// The cells where robots collide.
    pub conflicts: Vec<Cell>,
    /// The paths, a robot each.
    pub paths: Vec<Track>,
}

/// A robot's path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    /// The robot.
    pub name: String,
    /// Its cells, a step each; a cell that is repeated is a wait.
    pub cells: Vec<Cell>,
}

/// Bars in groups.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bars {
    /// The picture's title.
    pub title: String,
    /// The label of each group.
    pub labels: Vec<String>,
    /// The bars, one of each series in every group.
    pub series: Vec<DataSeries>,
    /// The scale of the bars.
    pub scale: Scale,
}

/// One value for each group or place; `None` where there is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DataSeries {
    /// The name of the series.
    pub name: String,
    /// The values.
    pub values: Vec<Option<f64>>,
}

/// The scale from values to lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// In proportion.
    Linear,
    /// By their logarithms, for probabilities.
    Logarithmic,
}

/// Curves over a common axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lines {
    /// The picture's title.
    pub title: String,
    /// The label of the horizontal axis.
    pub x: String,
    /// The label of the vertical axis.
    pub y: String,
    /// The position of each value on the horizontal axis.
    pub at: Vec<f64>,
    /// The curves.
    pub series: Vec<DataSeries>,
}

/// Values with their intervals, a line for each.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Intervals {
    /// The picture's title.
    pub title: String,
    /// The quantity and its unit.
    pub unit: String,
    /// The end of the axis; `None` for the largest value.
    pub most: Option<f64>,
    /// The lines.
    pub rows: Vec<IntervalRow>,
}

/// The values of one line, one for each who is compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IntervalRow {
    /// The conditions.
    pub label: String,
    /// The names and their values; `None` where there is no value.
    pub values: Vec<(String, Option<Estimate>)>,
}

/// A value and its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Intervals {
    /// Numbers from zero up.
    pub fn new(title: impl Into<String>, unit: impl Into<String>, rows: impl Into<Vec<IntervalRow>>) -> Self {
        Self { title: title.into(), unit: unit.into(), most: None, rows: rows.into() }
    }

    /// Shares of a whole.
    pub fn shares(
        title: impl Into<String>,
        of: impl Into<String>,
        rows: impl Into<Vec<IntervalRow>>,
    ) -> Self {
        Self { most: Some(1.0), ..Self::new(title, of, rows) }
    }
}

impl Estimate {
    /// A ratio.
    #[must_use]
    pub const fn of_share(share: &Share) -> Self {
        let [low, high] = share.interval;
        Self { value: share.ratio, low, high }
    }

    /// A mean; `None` of no values.
    #[must_use]
    pub fn of_mean(distribution: &Distribution) -> Option<Self> {
        let [low, high] = distribution.interval;
        (distribution.count > 0).then_some(Self { value: distribution.mean, low, high })
    }
}

/// A behavior tree, from the root down in preorder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TreePicture {
    /// The picture's title.
    pub title: String,
    /// The nodes.
    pub nodes: Vec<TreeNode>,
}

/// A node of a tree.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TreeNode {
    /// Its level, the root's is one.
    pub level: usize,
    /// The kind of node.
    pub kind: TreeNodeKind,
    /// Its name.
    pub name: String,
}

/// The kinds of nodes in a picture of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TreeNodeKind {
    /// Runs its children while they succeed.
    Sequence,
    /// Runs its children until one succeeds.
    Fallback,
    /// Any other node with children.
    Control,
    /// A condition.
    Condition,
    /// An action.
    Action,
    /// An inference node.
    Inference,
}

impl Figure {
    /// A figure of one or several pictures.
    #[must_use]
    pub fn new(caption: impl Into<String>, panels: impl IntoIterator<Item = Panel>) -> Self {
        Self { caption: caption.into(), panels: panels.into_iter().collect() }
    }
}

impl DataSeries {
    /// A value in every place.
    #[must_use]
    pub fn new(name: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        Self { name: name.into(), values: values.into_iter().map(Some).collect() }
    }
}

/// The true paths of the robots of a flight.
#[must_use]
pub(crate) fn tracks(record: &Record) -> Vec<Track> {
    let track = |(index, robot): (usize, &RobotRecord)| {
        let mut cells: Vec<Cell> = record.history.iter().map(|cells| cells[index]).collect();
        cells.dedup();
        Track { name: robot.name.clone(), cells }
    };
    record.robots.iter().enumerate().map(track).collect()
}
