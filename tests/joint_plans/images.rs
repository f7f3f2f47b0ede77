//! Plans of the images: the same on every target, within their budgets.

use firmware::bench::joint_plans::{List, Planner, Plans, Problems, SEARCHED, hardest, plan_all};
use tests::budgets::assert_within;
use tests::qemu::{Robot, image, number};

/// An image of the release profile, 200 problems of each size on 64 cells with a fifth of them
/// blocked: one plan, and a decision among four.
#[test]
fn plans_on_the_chip_are_those_of_the_host() {
    let mut robot = Robot::boot_counting(&image("joint_plans"));
    let (mut planner, mut list) = (Planner::new(), Box::new(List::new()));
    for robots in [2, 4, 8] {
        let plans = plan_all(robots, |problem| (problem.plan(&mut planner), 0));
        check_image(&mut robot, "plans", robots, &plans);
        let decisions = plan_all(robots, |problem| (problem.decide(&mut list), 0));
        check_image(&mut robot, "decisions", robots, &decisions);
        let line = robot.wait_for(&format!("hardest of {robots} robots: took")).message;
        let instructions = u64::from(number(&line, "took ")) * 1000 / 168;
        assert_within("joint_plans", &format!("plans_{robots}_of_20000"), instructions);
    }
}

/// Those that are planned on the chip are the hardest, by work units.
#[test]
fn no_problem_of_twenty_thousand_is_harder_than_the_hardest() {
    let mut planner = Planner::new();
    for robots in [2, 4, 8] {
        let mut problems = Problems::new(2026);
        let (mut solved, mut hard, mut others) = (0, Vec::new(), 0);
        for draw in 0.. {
            let planned = problems.next(robots).and_then(|problem| problem.plan(&mut planner));
            let Some((_, units)) = planned else { continue };
            if hardest(robots).contains(&draw) {
                hard.push(units);
            } else {
                others = others.max(units);
            }
            solved += 1;
            if solved == SEARCHED {
                break;
            }
        }
        println!("{robots} robots: {hard:?} units, {others} of all others");
        assert!(hard.iter().max() >= Some(&others), "{robots} robots: {hard:?}, {others} of another problem");
    }
}

fn check_image(robot: &mut Robot, what: &str, robots: usize, on_the_host: &Plans) {
    let line = robot.wait_for(&format!("{what} of {robots} robots: took")).message;
    let instructions = |before| u64::from(number(&line, before)) * 1000 / 168;
    let expected = format!("{} units, digest {:08x}", on_the_host.units, on_the_host.digest);
    assert!(line.ends_with(&expected), "{line}; on the host {expected}");
    assert_within("joint_plans", &format!("{what}_{robots}"), instructions("took "));
    assert_within("joint_plans", &format!("{what}_{robots}_worst"), instructions("worst "));
}
