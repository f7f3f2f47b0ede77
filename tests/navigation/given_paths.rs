//! Teams without a planner, in the reduced configuration: they go by paths given by hand.

use super::*;
use firmware::missions::{SECTION_5_1, reduced};
use host_sim::TeamError;
use iibt_core::grid::Path;
use iibt_core::navigation::MissionError;

/// Robots with the sizes of the reduced image.
type Reduced<'m> = NavigatorFlight<
    'm,
    { reduced::CELLS },
    2,
    { reduced::LAYERS },
    { reduced::NODES },
    { reduced::POLICIES },
>;

/// Two robots on seven columns and three rows, from left to right along the outer rows.
static CORRIDOR: [Cell; 2] = [Cell(0), Cell(14)];
static ENDS: [Cell; 2] = [Cell(6), Cell(20)];

fn corridor() -> Mission<'static, 2> {
    Mission::new(Map::new(7, 3).expect("21 cells fit two words"), &CORRIDOR, &ENDS)
}

fn through(mission: &Mission<'_, 2>, cells: &[u16]) -> Path {
    let cells: Vec<_> = cells.iter().copied().map(Cell).collect();
    Path::through(&mission.map, &cells).expect("neighbours")
}

fn reduced<'m>(mission: &'m Mission<'m, 2>, faults: Faults, seed: u64) -> Reduced<'m> {
    Reduced::over(mission, faults, seed).expect("a sound mission")
}

/// Ticks a team this many times; returns the cells of the first robot.
fn track(team: &mut Reduced<'_>, ticks: u32) -> Vec<u16> {
    let cell = |team: &mut Reduced<'_>| {
        team.tick();
        team.cells()[0].0
    };
    (0..ticks).map(|_| cell(team)).collect()
}

fn has_arrived(team: &Reduced<'_>) -> bool {
    team.reports().iter().all(|report| report.stage == Stage::Arrived)
}

#[test]
fn a_team_without_a_planner_goes_on_by_what_is_left_of_another_path_where_an_obstacle_is() {
    let open = corridor();
    let first = [through(&open, &[0, 1, 2, 3, 4, 5, 6]), through(&open, &[0, 1, 2, 9, 10, 11, 4, 5, 6])];
    let second = [through(&open, &[14, 15, 16, 17, 18, 19, 20])];
    let paths: [&[Path]; 2] = [&first, &second];
    let mission = Mission { paths: Some(&paths), ..open };
    let mut team = reduced(&mission, Faults::default(), 1);
    team.cause(EventEffect::Block(Cell(3)));
    let cells = track(&mut team, 60);
    assert!(passed(&cells, &[2, 9, 10, 11, 4, 6]), "{cells:?}");
    assert!(has_arrived(&team) && team.collisions().total() == 0);
}

#[test]
fn a_team_without_a_planner_stands_where_no_path_is_free_and_goes_on_when_one_is() {
    let open = corridor();
    let (first, second) =
        ([through(&open, &[0, 1, 2, 3, 4, 5, 6])], [through(&open, &[14, 15, 16, 17, 18, 19, 20])]);
    let paths: [&[Path]; 2] = [&first, &second];
    let mission = Mission { paths: Some(&paths), ..open };
    let mut team = reduced(&mission, Faults::default(), 1);
    team.cause(EventEffect::Block(Cell(3)));
    let cells = track(&mut team, 100);
    assert_eq!(cells[60..], [2; 40], "it stands before the obstacle");
    assert!(!has_arrived(&team) && team.reports()[0].short_by > 0, "{:?}", team.reports()[0]);
    team.cause(EventEffect::Clear(Cell(3)));
    track(&mut team, 100);
    assert!(has_arrived(&team) && team.collisions().total() == 0, "{:?}", team.reports());
}

#[test]
fn what_takes_a_planner_is_refused_without_one() {
    let refused = |mission: &Mission<'_, 2>| match Reduced::over(mission, Faults::default(), 1).err() {
        Some(TeamError::Mission(error)) => Some(error),
        _ => None,
    };
    let chargers = [Some(Cell(0)), None];
    assert_eq!(refused(&Mission { paths: None, ..SECTION_5_1 }), Some(MissionError::NoPlanner));
    assert_eq!(refused(&Mission { chargers: &chargers, ..SECTION_5_1 }), Some(MissionError::NoPlanner));
    let mut team = reduced(&SECTION_5_1, Faults::default(), 1);
    let visit = team.robot_mut(0).robot_mut().navigation_mut().visit(Cell(30));
    assert_eq!(visit, Err(VisitError::NoPlanner));
}

/// Robots that lose frames, restart and die, with obstacles on their paths.
#[test]
fn robots_without_a_planner_never_collide() {
    let mut arrived = 0;
    for seed in 0..200_u64 {
        let radio = Radio { loss: 0.1 * (seed % 4) as f64, ..Radio::default() };
        let mut team = reduced(&SECTION_5_1, Faults { radio, ..Faults::default() }, seed);
        track(&mut team, 3 + (seed % 7) as u32);
        let obstacle = [30, 31, 37, 10, 4, 11, 17][(seed % 7) as usize];
        match seed % 5 {
            0 => team.cause(EventEffect::Block(Cell(obstacle))),
            1 => team.restart((seed % 2) as usize).expect("it has been built before"),
            2 => team.cause(EventEffect::Stop((seed % 2) as usize, None)),
            _ => {}
        }
        track(&mut team, 120);
        assert_eq!(team.collisions().total(), 0, "seed {seed}");
        arrived += usize::from(has_arrived(&team));
    }
    assert!(arrived >= 80, "{arrived} of the undisturbed arrive");
}
