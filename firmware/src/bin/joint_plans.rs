//! Joint plans on the STM32F405: logs how long the plans for random problems of two, four and eight
//! robots take, and the digest of all of them.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This image runs on a robot: `cargo fw` builds it, `cargo fw-run joint_plans` starts it in QEMU."
    );
}

#[cfg(target_os = "none")]
mod image {
    use firmware::adapters::Chassis;
    use firmware::bench::joint_plans::{Instance, Planner, plan_all};
    use firmware::board::{self, Board};
    use iibt_core::grid::joint::JointPlan;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let chassis = Chassis { cell: 1.0, track: 0.1, speed: 1.0, duty: 0 };
        let Some(board) = Board::take(chassis) else { board::restart() };
        let mut planner = Planner::new();
        for robots in [2, 4, 8] {
            let plans = plan_all(robots, &mut planner, |problem, planner| {
                let started = board.clock.cycles();
                let plan = plan(problem, planner);
                (plan, board.clock.cycles().wrapping_sub(started))
            });
            defmt::info!(
                "{=usize} robots: took {=u32} cycles, worst {=u32}, {=u32} units, digest {=u32:08x}",
                robots,
                plans.mean,
                plans.worst,
                plans.units,
                plans.digest
            );
        }
        loop {
            board::sleep();
        }
    }

    #[inline(never)]
    fn plan(problem: &Instance, planner: &mut Planner) -> Option<(JointPlan<8>, u32)> {
        problem.plan(planner)
    }
}
