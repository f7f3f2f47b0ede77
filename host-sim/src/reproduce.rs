//! The paper's results, run through the core and put beside what the paper printed.
//!
//! ```text
//! chapter ─► Section: items, each with a verdict, and figures ─► table, JSON, page
//! ```
//!
//! Numbers of the paper stand in the file of their section and nowhere else. A [`Section`] says nothing that was not
//! computed when it was made.

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

pub use decision::{CELLS, Decision, Judged, Mode, map};
pub use figure::{
    Bars, Estimate, Figure, Grid, IntervalRow, Intervals, Lines, Panel, Scale, Series, Track, TreeNode,
    TreeNodeKind, TreePicture,
};
pub use page::page;
pub use report::{Item, Section, Tolerance, Verdict, number};
pub use section_5::{choice, detour};
pub use table::{table, tally};

/// How much is flown where chance has a say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// All that the report is about.
    Full,
    /// A few seeds, to see that it works.
    Quick,
}

/// How a chapter is run.
#[derive(Clone, Copy)]
pub struct Run<'p> {
    /// How much is flown.
    pub effort: Effort,
    /// Hears how far it has come: steps done, of how many.
    pub progress: &'p (dyn Fn(usize, usize) + Sync),
}

/// A chapter of the report: what makes a section.
#[derive(Clone, Copy, Debug)]
pub struct Chapter {
    /// Its name for `--only`.
    pub id: &'static str,
    /// What it is about, in a few words.
    pub about: &'static str,
    run: fn(&Run<'_>) -> Section,
}

impl<'p> Run<'p> {
    /// With this effort, and whoever wants to hear how far it has come.
    pub fn new(effort: Effort, progress: &'p (dyn Fn(usize, usize) + Sync)) -> Self {
        Self { effort, progress }
    }

    /// The seeds of a campaign that has `full` of them in the report.
    #[must_use]
    pub fn seeds(&self, full: u64) -> u64 {
        match self.effort {
            Effort::Full => full,
            Effort::Quick => full.min(8),
        }
    }
}

impl Chapter {
    /// Runs it.
    pub fn run(&self, run: &Run<'_>) -> Section {
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

/// The chapter with a name.
#[must_use]
pub fn chapter(id: &str) -> Option<&'static Chapter> {
    CHAPTERS.iter().find(|chapter| chapter.id == id)
}

/// Whether no item of the sections falls short.
#[must_use]
pub fn succeeds(sections: &[Section]) -> bool {
    sections.iter().flat_map(|section| &section.items).all(|item| item.verdict != Verdict::Misses)
}
