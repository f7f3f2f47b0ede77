//! Section 5: two robots, two goals, listed paths; then an obstacle.

use super::Reproduction;
use super::decision::{DecisionMode, Judged, PaperDecision, WIDTH, map};
use super::figure::{Bars, DataSeries, Figure, Grid, Panel, Scale, Track, tracks};
use super::report::{Item, Section, Tolerance, number};
use crate::text::route;
use crate::{Conditions, FlightEvent, Outcome, Record, fly, library};
use iibt_core::grid::{Cell, Path};
use iibt_core::math;

/// The tolerance for the recovered probabilities.
const TOLERANCE: Tolerance = Tolerance::Relative(0.005);

/// A probability as the paper prints it, with all its digits as they were recovered.
struct Published(&'static str, f64);

/// Section 5.1, a row for each path of robot 1. The paper cuts digits off, it does not round.
#[rustfmt::skip]
const CHOICE: [Published; 16] = [
    Published(".151e-7", 1.511_580_814_984_168e-8), Published(".566e-6", 5.661_653_180_796_627e-7),
    Published(".405e-7", 4.053_619_629_568_133e-8), Published(".357e-7", 3.570_795_671_553_069e-8),
    Published(".995e-7", 9.957_599_963_308_488e-8), Published(".210e-6", 2.100_489_129_943_526e-7),
    Published(".081", 0.081_268_092_863_472_61), Published(".072", 0.071_587_820_373_167_99),
    Published(".746e-7", 7.469_709_086_784_848e-8), Published(".847", 0.847_142_300_979_241_5),
    Published(".133e-7", 1.331_203_824_019_609e-8), Published(".117e-7", 1.172_637_054_925_103_4e-8),
    Published(".682e-7", 6.823_202_807_789_972e-8), Published(".573e-6", 5.737_539_482_674_496e-7),
    Published(".408e-7", 4.089_163_496_310_778_4e-8), Published(".360e-7", 3.602_081_496_971_725_5e-8),
];

/// Section 5.2, the same.
#[rustfmt::skip]
const DETOUR: [Published; 9] = [
    Published(".784e-6", 7.849_834_382_008_871e-7), Published(".166e-6", 1.661_324_114_992_681_4e-7),
    Published(".521e-7", 5.219_725_035_598_924e-8),
    Published(".999", 0.999_998_801_429_255_2), Published(".156e-6", 1.561_296_817_680_717e-7),
    Published(".134e-7", 1.343_881_527_908_846e-8),
    Published(".898e-13", 8.982_090_566_087_216e-14), Published(".256e-7", 2.568_905_288_241_471_6e-8),
    Published(".554e-14", 5.546_443_005_492_866e-15),
];

/// The initial beliefs: that robot 1 is on 28, and on any other cell that is no goal; the same of
/// robot 2 and 2.
const BELIEFS: [(&str, usize, usize, f64); 4] = [
    ("q1(28)", 0, 28, 0.993_314_800_284_670_8),
    ("q1 of any other cell", 0, 0, 1.453_304_285_874_283_8e-4),
    ("q2(2)", 1, 2, 0.884_474_534_347_872_2),
    ("q2 of any other cell", 1, 0, 2.511_423_166_242_157_7e-3),
];

/// Section 5.1's decision. Robot 2's paths are in the order of the paper's numbers, which is not
/// that of its text.
#[must_use]
pub fn choice() -> PaperDecision {
    let first: [(&str, &[u16]); 4] = [
        ("A", &[28, 29, 30, 31, 24]),
        ("B", &[28, 35, 36, 37, 38, 31, 24]),
        ("C", &[28, 29, 30, 31, 32, 33, 26]),
        ("D", &[28, 35, 36, 37, 38, 39, 40, 41, 34, 27, 26]),
    ];
    let second: [(&str, &[u16]); 4] = [
        ("b", &[2, 3, 10, 17, 24]),
        ("a", &[2, 1, 8, 15, 22, 23, 24]),
        ("c", &[2, 3, 4, 11, 18, 25, 26]),
        ("d", &[2, 3, 4, 5, 12, 19, 26]),
    ];
    PaperDecision::new([&first, &second], &[24, 26], 10)
}

/// Section 5.2's decision, with the waits that the numbers require; X3 and Y3 are the rest of the
/// old plan.
#[must_use]
pub fn detour() -> PaperDecision {
    let first: [(&str, &[u16]); 3] = [
        ("X1", &[29, 22, 15, 16, 17, 17, 24]),
        ("X2", &[29, 36, 37, 38, 31, 32, 33, 26]),
        ("X3", &[29, 30, 31, 32, 33, 26]),
    ];
    let second: [(&str, &[u16]); 3] = [
        ("Y1", &[1, 8, 9, 9, 10, 10, 17, 24]),
        ("Y3", &[1, 8, 15, 22, 23, 24]),
        ("Y2", &[1, 8, 9, 10, 11, 18, 19, 26]),
    ];
    PaperDecision::new([&first, &second], &[24, 26], 7).around(Cell(30))
}

/// Computes section 5.1.
pub(super) fn choose(_: &Reproduction<'_>) -> Section {
    let mut section = Section::new("5.1", "Two robots, two goals, nobody is told which");
    section.say(
        "Robot 1 weighs each of its four paths with each of robot 2's. As published, its sensors, one sweep of mean-field \
         inference and policies padded with \"up\" give the sixteen probabilities of the paper. By default, exact beliefs \
         and goals that count on arrival put everything on the three pairs that arrive together at different goals. In the \
         flight both robots make the same list of pairs without a conflict from what both have announced, and each scores it: \
         three pairs arrive together after six steps, and among equal ones the first of the list is flown.",
    );
    let decision = choice();
    let [published, ours] =
        [DecisionMode::AsPublished, DecisionMode::Default].map(|mode| decision.judge(mode));
    section.items = initial_beliefs(&published);
    section.items.extend(probabilities(&decision, &published, &CHOICE));
    section.items.extend(choices(&decision, [&published, &ours], "C with a"));
    let record = flown("two-goals");
    let note = "the paper's C with a costs the same six steps and comes later in the list";
    section.items.push(settled(&record, &decision).because(note));
    section.figures =
        vec![candidates(&decision, None, &record), posteriors(&decision, [&published, &ours], &CHOICE)];
    section
}

/// Computes section 5.2.
pub(super) fn detour_around(_: &Reproduction<'_>) -> Section {
    let mut section = Section::new("5.2", "An obstacle on the way");
    section.say(
        "One step later an obstacle blocks p30. Its preference falls by one, new paths are weighed beside the rest of the old \
         plan, and both robots settle on detours of equal length. In the second flight the robots start as in section 5.1, meet \
         the obstacle on their way and plan their own paths.",
    );
    let decision = detour();
    let [published, ours] =
        [DecisionMode::AsPublished, DecisionMode::Default].map(|mode| decision.judge(mode));
    section.items = probabilities(&decision, &published, &DETOUR);
    section.items.extend(choices(&decision, [&published, &ours], "X2 with Y1"));
    section.items.push(settled(&flown("detour"), &decision));
    let record = flown("obstacle");
    section.items.extend(replanned(&record));
    section.figures = vec![
        candidates(&decision, Some(Cell(30)), &record),
        posteriors(&decision, [&published, &ours], &DETOUR),
    ];
    section
}

fn initial_beliefs(published: &Judged) -> Vec<Item> {
    let item = |(what, robot, cell, exact): (&str, usize, usize, f64)| {
        let ours = f64::from(published.beliefs[robot][cell]);
        Item::close(format!("{what}, as published"), exact, ours, TOLERANCE)
    };
    BELIEFS.into_iter().map(item).collect()
}

fn probabilities(decision: &PaperDecision, published: &Judged, printed: &[Published]) -> Vec<Item> {
    let item = |(pair, &Published(digits, exact)): (usize, &Published)| {
        let what = format!("P({}), as published", decision.name(pair));
        Item::published(what, digits, exact, f64::from(published.posterior[pair]), TOLERANCE)
    };
    printed.iter().enumerate().map(item).collect()
}

/// The pair chosen in each mode, and whether the robots arrive together in the default mode.
fn choices(decision: &PaperDecision, [published, ours]: [&Judged; 2], paper: &str) -> [Item; 3] {
    let [by_paper, by_default] = [published, ours].map(|judged| math::argmax(&judged.posterior));
    let together = decision.simultaneous();
    let mass: f64 = together.iter().map(|&pair| f64::from(ours.posterior[pair])).sum();
    [
        Item::same("the pair chosen, as published", paper, decision.name(by_paper)),
        Item::claim(
            "the pair chosen, by default",
            "arrives together, apart from each other",
            decision.name(by_default),
            together.contains(&by_default) && !decision.conflicts(by_default),
        ),
        Item::claim("P(together at different goals), by default", "> 0.999", number(mass), mass > 0.999),
    ]
}

/// Whether both robots of a flight followed the pair that costs the least.
fn settled(record: &Record, decision: &PaperDecision) -> Item {
    let best = decision.soonest();
    let expected = decision.pair(best).map(|(_, path)| path);
    let paths: Vec<_> = record.robots.iter().map(|robot| robot.path.clone()).collect();
    let same = expected.iter().zip(&paths).all(|(path, cells)| path.cells(&map()).eq(cells.iter().copied()));
    let holds = same && record.outcome == Outcome::Together && record.collisions.total() == 0;
    let routes: Vec<String> = paths.iter().map(|path| route(path)).collect();
    let what = "the flight: the pair of the list that both robots follow";
    Item::claim(what, &format!("{}, arriving together", decision.name(best)), routes.join(" with "), holds)
}

/// The item on a flight in which the obstacle appeared on the way.
fn replanned(record: &Record) -> [Item; 3] {
    let (appeared, obstacle) = record.obstacles().next().unzip();
    let moved = appeared.is_some_and(|tick: u32| record.history[tick as usize] != record.history[0]);
    let chosen = record.events.iter().filter(|timed| matches!(timed.event, FlightEvent::Chose { .. }));
    let again = appeared.map_or(0, |tick| chosen.filter(|timed| timed.tick >= tick).count());
    let avoids = |cells: &[Cell]| obstacle.is_some_and(|cell| !cells.contains(&cell));
    let avoided = record.robots.iter().filter(|robot| avoids(&robot.path)).count();
    let together = record.outcome == Outcome::Together;
    [
        Item::claim(
            "the flight with an obstacle on the way: paths chosen after it appeared",
            "both, while the robots move",
            again.to_string(),
            again == 2 && moved,
        ),
        Item::claim(
            "the flight with an obstacle on the way: paths that avoid it",
            "both",
            avoided.to_string(),
            avoided == 2,
        ),
        Item::claim(
            "the flight with an obstacle on the way: the end",
            "together at different goals",
            format!("{:?} at tick {}", record.outcome, record.last_arrival()),
            together,
        ),
    ]
}

fn flown(scenario: &str) -> Record {
    fly(&library::built_in(scenario), Conditions::default(), &mut ()).expect("its mission fits")
}

fn candidates(decision: &PaperDecision, obstacle: Option<Cell>, record: &Record) -> Figure {
    let blocked: Vec<Cell> = obstacle.into_iter().collect();
    let grid = |title: String, paths| {
        Panel::Grid(Grid {
            title,
            width: WIDTH,
            height: WIDTH,
            goals: decision.goals.clone(),
            blocked: blocked.clone(),
            paths,
            ..Grid::default()
        })
    };
    let mut panels: Vec<Panel> = [0, 1]
        .into_iter()
        .map(|robot| {
            let track = |&(name, path): &(&str, Path)| Track {
                name: name.to_owned(),
                cells: path.cells(&map()).collect(),
            };
            grid(
                format!("Robot {}'s candidates", robot + 1),
                decision.candidates[robot].iter().map(track).collect(),
            )
        })
        .collect();
    panels.push(grid("The flight".to_owned(), tracks(record)));
    Figure::new(
        "What both robots can do, and where they went. A ring on a path is a wait, and the number how many.",
        panels,
    )
}

fn posteriors(decision: &PaperDecision, [published, ours]: [&Judged; 2], printed: &[Published]) -> Figure {
    let values = |judged: &Judged| judged.posterior.iter().copied().map(f64::from).collect::<Vec<_>>();
    let bars = Bars {
        title: "P of each joint policy".to_owned(),
        labels: (0..decision.pairs()).map(|pair| decision.name(pair)).collect(),
        series: vec![
            DataSeries::new("paper", printed.iter().map(|published| published.1)),
            DataSeries::new("ours, as published", values(published)),
            DataSeries::new("ours, default", values(ours)),
        ],
        scale: Scale::Logarithmic,
    };
    Figure::new("The posterior over joint policies, on a logarithmic scale.", [Panel::Bars(bars)])
}
