//! Section 6.1: three robots, obstacles, way-points, batteries.

mod published;
mod shift;

use super::Reproduction;
use super::report::Section;

/// Computes section 6.1.
pub(super) fn mission(run: &Reproduction<'_>) -> Section {
    let mut section = Section::new("6.1", "Three robots: obstacles, way-points, batteries");
    section.say(
        "By default the whole mission is one flight of the firmware's own controllers: a first choice, an obstacle on the way of \
         one robot, another on the way of a second one, the way-points p4 and p39, and two batteries that run low, one after the \
         other. The robot that notices opens a round; all announce what they know, make the same list of joint policies from it, \
         exchange their scores, and follow the one that costs all of them the least. While a robot charges, the others stand, as \
         in the paper. Where the robots are when something happens depends on their own choices, so the phases are the paper's \
         and the cells and paths are not.",
    );
    section.say(
        "Of the paper's own run it prints the chosen paths and, in bar charts, probabilities of ten strategies per robot whose \
         paths it does not list. Robot 3's bars in figure 9 tell most of its list: the ratio of its two pairings depends on \
         where and when a strategy arrives, and on nothing else. The lists of robots 1 and 2, and those of later phases, \
         cannot be recovered.",
    );
    let (items, figures) = shift::flown(run);
    section.items = items;
    section.figures = figures;
    section.items.extend(published::items());
    section.figures.extend(published::figures());
    section
}
