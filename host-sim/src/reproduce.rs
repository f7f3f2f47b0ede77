//! The paper's results, computed with the core and compared with the printed ones.
//!
//! ```text
//! chapter ─► Section: items, each with a verdict, and figures ─► table, JSON, page
//! ```
//!
//! The file of a section is the only place that has the paper's numbers of it. A [`Section`]
//! contains only what was computed when it was made.

mod beyond;
mod comparison;
mod decision;
mod figure;
mod page;
mod report;
mod safety;
mod section_5;
mod section_6_1;
mod section_6_2;
mod table;
mod tables;

pub use decision::{CELLS, DecisionMode, Judged, PaperDecision, map};
pub use figure::{
    Bars, DataSeries, Estimate, Figure, Grid, IntervalRow, Intervals, Lines, Panel, Scale, Track, TreeNode,
    TreeNodeKind, TreePicture,
};
pub use page::page;
pub use report::{Item, Section, Tolerance, Verdict, number};
pub use section_5::{choice, detour};
pub use table::{table, tally};

/// The number of flights where results are random.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// All seeds of the report.
    Full,
    /// A few seeds, for a test.
    Quick,
}

/// A run of the reproduction.
#[derive(Clone, Copy)]
pub struct Reproduction<'p> {
    /// The number of flights.
    pub effort: Effort,
    /// Receives the progress: steps done, and all steps.
    pub progress: &'p (dyn Fn(usize, usize) + Sync),
}

/// A chapter of the report, which computes a section.
#[derive(Clone, Copy, Debug)]
pub struct Chapter {
    /// The name for `--only`.
    pub id: &'static str,
    /// The subject in a few words.
    pub about: &'static str,
    run: fn(&Reproduction<'_>) -> Section,
}

impl<'p> Reproduction<'p> {
    /// Creates a run with an effort and a receiver of the progress.
    pub fn new(effort: Effort, progress: &'p (dyn Fn(usize, usize) + Sync)) -> Self {
        Self { effort, progress }
    }

    /// Returns the number of seeds of a campaign that has `full` of them in the report.
    #[must_use]
    pub fn seeds(&self, full: u64) -> u64 {
        match self.effort {
            Effort::Full => full,
            Effort::Quick => full.min(8),
        }
    }
}

impl Chapter {
    /// Computes the section.
    pub fn run(&self, run: &Reproduction<'_>) -> Section {
        (self.run)(run)
    }
}

/// All chapters, in the paper's order; the last ones go beyond it.
pub const CHAPTERS: &[Chapter] = &[
    Chapter { id: "5.1", about: "two robots, two goals", run: section_5::choose },
    Chapter { id: "5.2", about: "an obstacle on the way", run: section_5::detour_around },
    Chapter { id: "6.1", about: "three robots, obstacles, way-points, batteries", run: section_6_1::mission },
    Chapter { id: "6.2", about: "a bottle and a plate", run: section_6_2::manipulate },
    Chapter { id: "tables", about: "how large the trees are", run: tables::count },
    Chapter { id: "safety", about: "every mission under the validator", run: safety::validate },
    Chapter { id: "comparison", about: "inference and conventional trees", run: comparison::compare },
    Chapter { id: "beyond", about: "unlike robots, learned preferences", run: beyond::measure },
];

/// Returns the chapter with a name.
#[must_use]
pub fn chapter(id: &str) -> Option<&'static Chapter> {
    CHAPTERS.iter().find(|chapter| chapter.id == id)
}

/// Returns whether no item of the sections misses.
#[must_use]
pub fn succeeds(sections: &[Section]) -> bool {
    sections.iter().flat_map(|section| &section.items).all(|item| item.verdict != Verdict::Misses)
}
