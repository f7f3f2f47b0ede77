//! Both planners for robots that own their targets, on random teams: every plan is checked cell by
//! cell, and what is said of small teams is compared with all that they can do.

use super::super::pictures::Random;
use super::super::{Cell, Map, Move};
use super::teams::{Answer, Trial, own, print_units, random_map};
use super::{Errand, Failure, Lacam, Prioritised, Problem, ProblemError, Target};
use std::boxed::Box;
use std::collections::HashSet;
use std::println;
use std::vec::Vec;

#[test]
fn every_plan_is_possible_cell_by_cell() {
    let mut random = Random(2026);
    let (mut lacam, mut prioritised) = (Box::new(Lacam::<2, 8, 256>::new(600)), Box::new(Prioritised::new()));
    let mut all = [const { Vec::new() }; 2];
    for number in 0..4000 {
        let mut trial = Trial::random(number, &mut random);
        if number % 3 == 0 {
            let robots = trial.errands.len();
            trial.errands[random.below(robots)].target = Target::Stand;
            trial.closed = (0..2).map(|_| random.cell(&trial.map)).collect();
        }
        let answers = [trial.lacam(&mut lacam, 100_000), trial.prioritised(&mut prioritised, 100_000)];
        for (planner, (answer, work)) in answers.into_iter().enumerate() {
            all[planner].push((answer, work));
            let Ok(plan) = answer else { continue };
            let follows = trial.check(&plan);
            if planner == 1 {
                assert!(!follows && plan.paths().iter().all(|path| path.len() == plan.steps()));
            }
        }
    }
    print_units("LaCAM, 256 nodes, 600 calls", &all[0]);
    print_units("prioritised", &all[1]);
    let solved = all.map(|answers| answers.iter().filter(|(answer, _)| answer.is_ok()).count());
    assert!(solved[0] > 2300 && solved[1] > 1800, "{solved:?}");
}

/// Teams of up to four robots on up to 11 free cells, with the fewest steps that they need.
fn small_teams(count: usize, random: &mut Random) -> Vec<(Trial, Option<usize>)> {
    let mut teams = Vec::new();
    while teams.len() < count {
        let map = random_map(4, random);
        let trial = Trial::on(map, 2 + random.below(3), random).filter(|_| map.free_cells().len() < 12);
        teams.extend(trial.map(|trial| {
            let exact = trial.exact();
            (trial, exact)
        }));
    }
    teams
}

#[test]
fn a_large_arena_solves_and_proves_all_that_is_so() {
    let mut large = Box::new(Lacam::<2, 8, 8000>::new(u32::MAX));
    let (mut solved, mut impossible, mut steps, mut fewest) = (0, 0, 0, 0);
    for (trial, exact) in small_teams(1000, &mut Random(14)) {
        match (trial.lacam(&mut large, u32::MAX).0, exact) {
            (Ok(plan), Some(exact)) => {
                trial.check(&plan);
                assert!(plan.steps() >= exact);
                (solved, steps, fewest) = (solved + 1, steps + plan.steps(), fewest + exact);
            }
            (Err(Failure::Impossible), None) => impossible += 1,
            (answer, exact) => panic!("{answer:?} where the fewest steps are {exact:?}: {:?}", trial.errands),
        }
    }
    println!("{solved} solved in {steps} steps, {fewest} at best; {impossible} proved impossible");
    assert!(solved > 500 && impossible > 100 && steps * 4 < fewest * 5);
}

#[test]
fn sixty_four_nodes_solve_most_of_what_can_be_solved() {
    let mut small = Box::new(Lacam::<2, 8, 64>::new(600));
    let mut prioritised = Box::new(Prioritised::new());
    let (mut solvable, mut by_search, mut by_either) = (0, 0, 0);
    for (trial, _) in small_teams(1000, &mut Random(15)).into_iter().filter(|(_, exact)| exact.is_some()) {
        if trial.errands.len() == 4 {
            let searched = trial.lacam(&mut small, u32::MAX).0;
            let planned = trial.prioritised(&mut prioritised, u32::MAX).0;
            assert_ne!(searched, Err(Failure::Impossible), "{:?}", trial.errands);
            solvable += 1;
            by_search += usize::from(searched.is_ok());
            by_either += usize::from(searched.is_ok() || planned.is_ok());
        }
    }
    println!(
        "of {solvable} teams of four, 64 nodes solve {by_search}, with prioritised planning {by_either}"
    );
    assert!(solvable > 150 && by_search * 100 >= solvable * 84, "{by_search} of {solvable}");
}

#[test]
fn most_teams_on_open_ground_are_solved_with_little_memory() {
    for (robots, most_units) in [(2, 100), (4, 200), (8, 1000)] {
        let mut random = Random(77);
        let (mut small, mut planner) = (Box::new(Lacam::<2, 8, 64>::new(600)), Box::new(Prioritised::new()));
        let mut teams = (0..).filter_map(|_| {
            let map = random.map(8, 8, 20);
            Trial::on(map, robots, &mut random)
        });
        let teams: Vec<Trial> = teams.by_ref().take(150).collect();
        let answers: Vec<_> = teams.iter().map(|trial| trial.prioritised(&mut planner, u32::MAX)).collect();
        let searched: Vec<_> = teams.iter().map(|trial| trial.lacam(&mut small, u32::MAX)).collect();
        print_units(&std::format!("{robots} robots, prioritised, 8x8"), &answers);
        print_units(&std::format!("{robots} robots, LaCAM, 64 nodes, 8x8"), &searched);
        let either = answers.iter().zip(&searched).filter(|(a, b)| a.0.is_ok() || b.0.is_ok()).count();
        let units: u32 = answers.iter().map(|(_, units)| units).sum();
        assert!(either >= 147 && units / 150 < most_units, "{robots} robots: {either}, {units} units");
    }
}

#[test]
fn the_plan_does_not_depend_on_how_the_work_was_cut() {
    let mut random = Random(3);
    let (mut lacam, mut prioritised) = (Box::new(Lacam::<2, 8, 64>::new(300)), Box::new(Prioritised::new()));
    let mut answers = HashSet::new();
    for number in 0..300 {
        let trial = Trial::random(number, &mut random);
        let whole = [trial.lacam(&mut lacam, u32::MAX), trial.prioritised(&mut prioritised, u32::MAX)];
        for slice in [1, 7, 100] {
            let cut = [trial.lacam(&mut lacam, slice), trial.prioritised(&mut prioritised, slice)];
            assert_eq!(cut, whole, "{slice} units at a time");
        }
        answers.extend(whole.map(|(answer, _)| answer));
    }
    assert!(answers.len() > 150, "all the same");
}

#[test]
fn a_search_that_is_dropped_leaves_nothing_behind() {
    let [first, second] = [Trial::drawn(&["1..b", "#a2#"]), Trial::drawn(&["b1.2a"])];
    let (mut lacam, mut prioritised) = (Lacam::<2, 8, 64>::new(600), Prioritised::new());
    let expected = [second.lacam(&mut lacam, u32::MAX), second.prioritised(&mut prioritised, u32::MAX)];
    for done in 1..40 {
        assert_eq!(lacam.work(&first.problem(), &first.targets(), &mut done.min(8)), None);
        assert_eq!(prioritised.work(&first.problem(), &first.targets(), &mut done.min(8)), None);
        lacam.start();
        prioritised.start();
        assert_eq!(second.lacam(&mut lacam, u32::MAX), expected[0]);
        assert_eq!(second.prioritised(&mut prioritised, u32::MAX), expected[1]);
    }
}

/// What both planners say of a team, LaCAM with 64 nodes and 600 calls.
#[track_caller]
fn check(rows: &[&str], lacam: Result<usize, Failure>, prioritised: Result<usize, Failure>) {
    let trial = Trial::drawn(rows);
    let searched = trial.lacam(&mut Lacam::<2, 8, 64>::new(600), u32::MAX).0;
    let planned = trial.prioritised(&mut Prioritised::new(), u32::MAX).0;
    for plan in [searched, planned].into_iter().flatten() {
        trial.check(&plan);
    }
    let steps = |answer: Answer| answer.map(|plan| plan.steps());
    assert_eq!((steps(searched), steps(planned)), (lacam, prioritised), "{rows:?}");
}

#[test]
fn ends_with_the_right_word() {
    use Failure::{Impossible, NoWay, NotFound};
    // Two way-points behind each other's robot, in a corridor with a corner but no place to pass.
    check(&["b1..2a.", ".######"], Err(Impossible), Err(NotFound));
    check(&["b1..2a.", ".###.##"], Ok(8), Ok(10));
    check(&["12...ba"], Err(Impossible), Err(NotFound));
    // There is no plan here either, but 64 states are too few to prove it.
    check(&["1234...dcba"], Err(NotFound), Err(NotFound));
    check(&["1#a", "###", "2.b"], Err(NoWay), Err(NoWay));
    // A line goes into a dead end in its order: at once by following, with gaps without.
    check(&["1234...abcd"], Ok(7), Ok(10));
    check(&["12345678...............abcdefgh"], Ok(23), Err(NotFound));
}

#[test]
fn a_robot_that_is_alone_makes_no_move_too_many() {
    let mut random = Random(8);
    let (mut lacam, mut prioritised) = (Box::new(Lacam::<2, 8, 64>::new(600)), Box::new(Prioritised::new()));
    for _ in 0..300 {
        let Some(trial) = Trial::on(random_map(8, &mut random), 1, &mut random) else { continue };
        let fewest = trial.exact();
        for (answer, _) in [trial.lacam(&mut lacam, 1000), trial.prioritised(&mut prioritised, 1000)] {
            let path = answer.unwrap().paths()[0];
            let moves = path.moves().filter(|&step| step != Move::Wait).count();
            assert_eq!(Some(moves), fewest, "{path:?}");
        }
    }
}

#[test]
fn a_robot_that_stands_is_a_wall_and_a_closed_cell_is_only_left() {
    let mut trial = Trial::drawn(&["1.2a", "...b"]);
    trial.errands[1].target = Target::Stand;
    trial.closed = [Cell(0)].into_iter().collect();
    let plan = trial.lacam(&mut Lacam::<2, 8, 64>::new(600), u32::MAX).0.unwrap();
    assert_eq!((trial.check(&plan), plan.steps()), (false, 5));
    let plan = trial.prioritised(&mut Prioritised::new(), u32::MAX).0.unwrap();
    assert_eq!((trial.check(&plan), plan.steps()), (false, 5));
    // Nobody comes back to a closed cell, or past the robot that stands where there is one row.
    let mut trial = Trial::drawn(&["1.2a"]);
    trial.errands.truncate(1);
    trial.errands.push(Errand { from: Cell(2), target: Target::Stand });
    assert_fails(&trial, Failure::NoWay);
    trial.errands = std::vec![own(Cell(2), Cell(0))];
    trial.closed = [Cell(0)].into_iter().collect();
    assert_fails(&trial, Failure::NoWay);
}

#[track_caller]
fn assert_fails(trial: &Trial, failure: Failure) {
    assert_eq!(trial.lacam(&mut Lacam::<2, 8, 64>::new(600), u32::MAX).0, Err(failure));
    assert_eq!(trial.prioritised(&mut Prioritised::new(), u32::MAX).0, Err(failure));
}

#[test]
fn what_makes_no_sense_is_named() {
    let map = Map::drawn("....").unwrap();
    let errands = [0, 1].map(|from| Errand { from: Cell(from), target: Target::Any });
    let problem = Problem::new(&map, &errands);
    let check = |targets: [Cell; 8], error| {
        let answer = Some(Err(Failure::Invalid(error)));
        assert_eq!(Lacam::<2, 8, 64>::new(600).work(&problem, &targets, &mut 1000), answer);
        assert_eq!(Prioritised::<2, 65, 8>::new().work(&problem, &targets, &mut 1000), answer);
    };
    check([3; 8].map(Cell), ProblemError::SharedTarget { cell: Cell(3) });
    check([3, 4, 0, 0, 0, 0, 0, 0].map(Cell), ProblemError::TargetOutside { cell: Cell(4) });
}

#[test]
fn ends_where_it_is_and_without_a_robot() {
    let mut trial = Trial::drawn(&["1a"]);
    trial.errands = std::vec![own(Cell(0), Cell(0))];
    for robots in [1, 0] {
        trial.errands.truncate(robots);
        let lacam = trial.lacam(&mut Lacam::<2, 8, 64>::new(600), u32::MAX).0.unwrap();
        let planned = trial.prioritised(&mut Prioritised::new(), u32::MAX).0.unwrap();
        assert_eq!((lacam.paths().len(), lacam.steps(), planned), (robots, 0, lacam));
    }
}

#[test]
fn robots_with_time_to_spare_wait_and_do_not_wander() {
    let rows = ["1........a", "##########", "2b...c..3.", "##########", ".d...4...."];
    let trial = Trial::drawn(&rows);
    let lacam = trial.lacam(&mut Lacam::<2, 8, 64>::new(600), u32::MAX).0.unwrap();
    let planned = trial.prioritised(&mut Prioritised::new(), u32::MAX).0.unwrap();
    for plan in [lacam, planned] {
        let moves = plan.paths().iter().map(|path| path.moves().filter(|&step| step != Move::Wait).count());
        assert!(moves.eq([9, 1, 3, 4]), "{plan:?}");
    }
}

#[test]
fn arenas_are_as_small_as_their_documentation_says() {
    let sizes = [
        size_of::<Prioritised<2, 33, 8>>(),
        size_of::<Prioritised<2, 65, 8>>(),
        size_of::<Lacam<2, 8, 64>>(),
        size_of::<Lacam<2, 8, 256>>(),
        size_of::<Lacam<32, 8, 4096>>(),
    ];
    println!("bytes of the arenas: {sizes:?}");
    for (size, most) in sizes.into_iter().zip([1000, 1800, 2900, 9100, 144_000]) {
        assert!(size <= most, "{sizes:?}");
    }
}
