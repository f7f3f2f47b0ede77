//! The results that the paper prints in section 6.1: figure 9 and four joint plans.

use crate::reproduce::decision::{DecisionMode, PaperDecision, WIDTH, map, path};
use crate::reproduce::figure::{Bars, DataSeries, Figure, Grid, Panel, Scale, Track};
use crate::reproduce::report::{Item, Tolerance, number};
use crate::text::counted;
use iibt_core::grid::{Cell, Path};

/// The tolerance for the ratios of the paper's probabilities; the paper prints three digits of
/// each.
const TOLERANCE: Tolerance = Tolerance::Relative(0.005);

const GOALS: [u16; 3] = [24, 26, 32];

/// The preference of robot 3 for a goal that a teammate announced. It follows from the paper's
/// numbers; the text does not state it.
const CLAIMED: f32 = -1.0;

/// The steps that the numbers of figure 9 look at.
const HORIZON: usize = 7;

/// A bar of figure 9: one of robot 3's strategies.
struct Bar {
    /// The probability paired with robot 2.
    with_2: f64,
    /// The probability paired with robot 1.
    with_1: f64,
    /// The place and time of its arrival, as the ratio of both shows.
    arrival: &'static str,
    /// Its path, where the numbers tell it.
    cells: Option<&'static [u16]>,
}

/// Robot 3's ten strategies, the lowest bar first.
#[rustfmt::skip]
const BARS: [Bar; 10] = [
    Bar { with_2: 1.19e-20, with_1: 1.62e-21, arrival: "24@4", cells: Some(&[45, 38, 31, 31, 24]) },
    Bar { with_2: 1.48e-20, with_1: 9.20e-21, arrival: "24@5", cells: Some(&[45, 38, 31, 31, 31, 24]) },
    Bar { with_2: 1.61e-20, with_1: 1.00e-20, arrival: "24@5", cells: None },
    Bar { with_2: 1.84e-27, with_1: 1.01e-27, arrival: "26@5", cells: Some(&[45, 38, 31, 24, 25, 26]) },
    Bar { with_2: 2.01e-27, with_1: 1.10e-27, arrival: "26@5", cells: None },
    Bar { with_2: 5.68e-7, with_1: 3.27e-7, arrival: "32@3", cells: Some(&[45, 38, 31, 32]) },
    Bar { with_2: 7.23e-7, with_1: 0.467, arrival: "32@4", cells: Some(&[45, 38, 31, 31, 32]) },
    Bar { with_2: 8.02e-7, with_1: 4.41e-7, arrival: "32@5", cells: Some(&[45, 38, 31, 31, 31, 32]) },
    Bar { with_2: 8.57e-7, with_1: 4.72e-7, arrival: "32@5", cells: None },
    Bar { with_2: 0.999, with_1: 0.533, arrival: "32@6", cells: Some(&[45, 38, 31, 31, 31, 31, 32]) },
];

/// The bar that the others are compared with: its path is certain, and no other bar's depends on
/// it.
const REFERENCE: usize = 6;

/// The bar that the paper chooses, whose printed path does not give its number.
const CHOSEN: usize = 9;

/// Another path with the same arrival that does.
const CHOSEN_TOO: &[u16] = &[45, 38, 38, 38, 31, 31, 32];

/// The paper's plans: phase, what it is about, and the path of every robot.
struct Plan {
    about: &'static str,
    blocked: &'static [u16],
    points: &'static [u16],
    paths: [&'static [u16]; 3],
}

/// The paper's four joint plans; the fifth phase, batteries, has none.
const PLANS: [Plan; 4] = [
    Plan {
        about: "Phase 1: the first choice",
        blocked: &[],
        points: &[],
        paths: [&[28, 21, 22, 23, 24, 25, 26], &[2, 9, 16, 16, 23, 23, 24], &[45, 38, 31, 31, 31, 31, 32]],
    },
    Plan {
        about: "Phase 2: p23 is blocked",
        blocked: &[23],
        points: &[],
        paths: [&[21, 14, 15, 16, 17, 24], &[9, 10, 17, 24, 31, 32], &[38, 38, 31, 24, 25, 26]],
    },
    Plan {
        about: "Phase 3: p31 is blocked too",
        blocked: &[23, 31],
        points: &[],
        paths: [&[14, 15, 16, 17, 24, 25, 26], &[16, 17, 18, 18, 25, 25, 32], &[38, 39, 32, 25, 18, 17, 24]],
    },
    Plan {
        about: "Phase 4: way-points p4 and p39",
        blocked: &[23, 31],
        points: &[4, 39],
        paths: [
            &[17, 10, 3, 4, 4, 3, 10, 17, 24],
            &[18, 25, 25, 25, 25, 25, 25, 25, 32],
            &[25, 32, 39, 39, 32, 25, 25, 25, 26],
        ],
    },
];

/// The items that can be compared.
pub(super) fn items() -> Vec<Item> {
    let mut items = figure_9();
    items.extend(PLANS.iter().flat_map(|plan| plan.items()));
    items
}

/// The bars of figure 9, and the plans.
pub(super) fn figures() -> [Figure; 2] {
    [bars_of_figure_9(), papers_plans()]
}

/// ln P of each path for robot 3 up to a constant, as published, paired with a teammate's announced
/// path.
fn scores(paths: &[&[u16]], teammate: &[u16]) -> Vec<f64> {
    let ours: Vec<(&str, &[u16])> = paths.iter().map(|&cells| ("", cells)).collect();
    let mut decision = PaperDecision::new([&ours, &[("", teammate)]], &GOALS, HORIZON);
    decision.preferences[0][24] = CLAIMED;
    decision.preferences[0][26] = CLAIMED;
    decision.judge(DecisionMode::AsPublished).scores.into_iter().map(f64::from).collect()
}

/// The scores paired with robot 1's and with robot 2's choice.
fn both_scores(paths: &[&[u16]]) -> [Vec<f64>; 2] {
    [0, 1].map(|robot| scores(paths, PLANS[0].paths[robot]))
}

fn figure_9() -> Vec<Item> {
    let known: Vec<(usize, &[u16])> =
        BARS.iter().enumerate().filter_map(|(bar, strategy)| Some((bar, strategy.cells?))).collect();
    let paths: Vec<&[u16]> = known.iter().map(|&(_, cells)| cells).collect();
    let scores = both_scores(&paths);
    let reference = known.iter().position(|&(bar, _)| bar == REFERENCE).expect("its path is known");
    let mut items = Vec::new();
    for (place, &(bar, _)) in
        known.iter().enumerate().filter(|&(_, &(bar, _))| bar != REFERENCE && bar != CHOSEN)
    {
        for (robot, with) in [(1, &scores[0]), (2, &scores[1])] {
            let what =
                format!("figure 9, robot 3 with robot {robot}: P of bar {} over that of bar 7", bar + 1);
            let ours = (with[place] - with[reference]).exp();
            items.push(Item::close(what, printed(bar, robot) / printed(REFERENCE, robot), ours, TOLERANCE));
        }
    }
    items.extend(chosen());
    items.push(arrivals());
    for robot in [1, 2] {
        items.push(Item::unknown(
            format!("figure 9, robot {robot}'s bars"),
            "ten",
            "its list of paths is not printed",
        ));
    }
    items.push(Item::unknown(
        "figures 10 to 12, all bars",
        "ninety",
        "the lists of paths are not printed, some bars cannot be read",
    ));
    items
}

/// The probability of a bar in one pairing.
const fn printed(bar: usize, robot: usize) -> f64 {
    if robot == 1 { BARS[bar].with_1 } else { BARS[bar].with_2 }
}

/// The choice of robot 3, and the path that gives the paper's number.
fn chosen() -> [Item; 3] {
    let paths =
        [BARS[CHOSEN].cells.expect("it is printed"), CHOSEN_TOO, BARS[REFERENCE].cells.expect("it is known")];
    let [with_1, _] = both_scores(&paths);
    let paper = BARS[CHOSEN].with_1 / BARS[REFERENCE].with_1;
    let [ours, other] = [0, 1].map(|path| (with_1[path] - with_1[2]).exp());
    let list: Vec<&[u16]> = BARS.iter().filter_map(|bar| bar.cells).collect();
    let best = |scores: &[f64]| {
        let best = (0..list.len()).max_by(|&a, &b| scores[a].total_cmp(&scores[b])).unwrap_or(0);
        list[best].iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
    };
    let [alone_1, alone_2] = both_scores(&list);
    let choices = [best(&alone_1), best(&alone_2)];
    let choice = if choices[0] == choices[1] { choices[0].clone() } else { choices.join(" or ") };
    [
        Item::same(
            "robot 3's choice in phase 1, as published, with either robot",
            "45 38 31 31 31 31 32",
            choice,
        ),
        Item::differs(
            "figure 9, robot 3 with robot 1: P of bar 10 over that of bar 7",
            number(paper),
            number(ours),
            "the path as the text prints it, with four steps on 31, does not give this number",
        ),
        Item::close("the same with two of its waits on 38 instead", paper, other, TOLERANCE),
    ]
}

/// Whether all ten bars arrive where and when the ratio of their two pairings says.
fn arrivals() -> Item {
    // Any path with the right arrival will do: its own value cancels.
    let stand_in = |bar: &Bar| {
        bar.cells.unwrap_or(match bar.arrival {
            "24@5" => &[45, 38, 38, 31, 31, 24],
            "26@5" => &[45, 38, 31, 32, 33, 26],
            _ => &[45, 38, 38, 31, 31, 32],
        })
    };
    let paths: Vec<&[u16]> = BARS.iter().map(stand_in).collect();
    let [with_1, with_2] = both_scores(&paths);
    let apart = |bar: usize| {
        let ours = (with_1[bar] - with_2[bar]) - (with_1[CHOSEN] - with_2[CHOSEN]);
        let strategy = &BARS[bar];
        let paper =
            (strategy.with_1 / strategy.with_2).ln() - (BARS[CHOSEN].with_1 / BARS[CHOSEN].with_2).ln();
        (ours - paper).abs()
    };
    let most = (0..BARS.len()).map(apart).fold(0.0, f64::max);
    let what = "figure 9: where and when robot 3's ten strategies arrive, by the ratio of both pairings";
    Item::claim(what, "all within 0.01 nat", format!("at most {} nat off", number(most)), most < 0.01)
}

fn bars_of_figure_9() -> Figure {
    let paths: Vec<&[u16]> = BARS.iter().filter_map(|bar| bar.cells).collect();
    let panel = |robot: usize, scores: &[f64]| {
        let mut scores = scores.iter();
        let ln: Vec<Option<f64>> =
            BARS.iter().map(|bar| bar.cells.and_then(|_| scores.next().copied())).collect();
        // The bars whose paths are unknown have their share of the whole in the paper.
        let anchor = ln[REFERENCE].unwrap_or(0.0);
        let ours = ln.iter().map(|ln| Some((ln.as_ref()? - anchor).exp() * printed(REFERENCE, robot)));
        Panel::Bars(Bars {
            title: format!("With robot {robot}"),
            labels: BARS
                .iter()
                .enumerate()
                .map(|(bar, strategy)| format!("{} {}", bar + 1, strategy.arrival))
                .collect(),
            series: vec![
                DataSeries::new("paper", (0..BARS.len()).map(|bar| printed(bar, robot))),
                DataSeries { name: "ours, as published".to_owned(), values: ours.collect() },
            ],
            scale: Scale::Logarithmic,
        })
    };
    let [with_1, with_2] = both_scores(&paths);
    Figure::new(
        "Figure 9, robot 3: the probabilities of its ten strategies, ours scaled to bar 7. Labels tell where a strategy \
         arrives and after how many moves.",
        [panel(1, &with_1), panel(2, &with_2)],
    )
}

impl Plan {
    fn paths(&self) -> [Path; 3] {
        self.paths.map(path)
    }

    /// The meetings of two robots: the cell, the step and the robots.
    fn meetings(&self) -> Vec<(Cell, String)> {
        let (map, paths) = (map(), self.paths());
        let longest = paths.iter().map(Path::len).max().unwrap_or(0);
        let mut found = Vec::new();
        for step in 1..=longest {
            for (one, other) in [(0, 1), (0, 2), (1, 2)] {
                let at = |robot: usize, step: usize| paths[robot].cell_at(&map, step);
                let (here, there) = (at(one, step), at(other, step));
                let pair = format!("R{} and R{}", one + 1, other + 1);
                if here == there {
                    found.push((here, format!("{pair} on p{} at step {step}", here.0)));
                } else if here == at(other, step - 1) && there == at(one, step - 1) {
                    found.push((
                        here,
                        format!("{pair} change places on p{} and p{} at step {step}", here.0, there.0),
                    ));
                }
            }
        }
        found
    }

    fn items(&self) -> [Item; 2] {
        let paths = self.paths();
        let lengths: Vec<String> = paths.iter().map(|path| path.len().to_string()).collect();
        let together = paths.iter().all(|path| path.len() == paths[0].len());
        let meetings = self.meetings();
        let list: Vec<_> = meetings.iter().map(|(_, text)| text.clone()).collect();
        let count = counted(meetings.len(), "collision");
        [
            Item::claim(
                format!("{}, the paper's paths: legal, and together", self.about),
                "equal numbers of moves",
                lengths.join(", "),
                together,
            ),
            Item::measured(format!("{}, the paper's paths: collisions", self.about), count)
                .because(if list.is_empty() { "none".to_owned() } else { list.join("; ") }),
        ]
    }

    fn picture(&self) -> Grid {
        let track = |(robot, path): (usize, &Path)| Track {
            name: format!("R{}", robot + 1),
            cells: path.cells(&map()).collect(),
        };
        let cells = |list: &[u16]| list.iter().copied().map(Cell).collect();
        Grid {
            title: self.about.to_owned(),
            width: WIDTH,
            height: WIDTH,
            goals: cells(&GOALS),
            blocked: cells(self.blocked),
            way_points: cells(self.points),
            conflicts: self.meetings().into_iter().map(|(cell, _)| cell).collect(),
            paths: self.paths().iter().enumerate().map(track).collect(),
            ..Grid::default()
        }
    }
}

fn papers_plans() -> Figure {
    Figure::new(
        "The paper's own plans. Red rings: where robots would collide.",
        PLANS.iter().map(|plan| Panel::Grid(plan.picture())),
    )
}
