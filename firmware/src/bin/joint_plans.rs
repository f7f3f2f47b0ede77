//! Joint plans on the STM32F405: logs how long the plans for random problems of two, four and eight
//! robots take, and the decisions among four, and the digests of all of them; and the plans for the
//! hardest of twenty thousand problems.
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
    use firmware::bench::joint_plans::{Instance, List, Planner, Plans, plan_all, worst};
    use firmware::board::{self, Board};
    use iibt_core::grid::joint::JointPlan;

    /// A plan and the work units that it took.
    type Planned = Option<(JointPlan<8>, u32)>;

    struct Memory {
        planner: Planner,
        list: List,
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(board) = Board::take(Chassis::STANDING) else { board::restart() };
        let mut memory = Memory { planner: Planner::new(), list: List::new() };
        for robots in [2, 4, 8] {
            let measured = |work: &mut dyn FnMut() -> Planned| {
                let started = board.clock.cycles();
                let plan = work();
                (plan, board.clock.cycles().wrapping_sub(started))
            };
            let plans = plan_all(robots, |problem| measured(&mut || plan(problem, &mut memory)));
            log("plans", robots, &plans);
            let decisions = plan_all(robots, |problem| measured(&mut || decide(problem, &mut memory)));
            log("decisions", robots, &decisions);
            let hardest = worst(robots, |problem| measured(&mut || plan(problem, &mut memory)));
            defmt::info!("hardest of {=usize} robots: took {=u32} cycles", robots, hardest);
        }
        loop {
            board::sleep();
        }
    }

    fn log(what: &str, robots: usize, plans: &Plans) {
        defmt::info!(
            "{=str} of {=usize} robots: took {=u32} cycles, worst {=u32}, {=u32} units, digest {=u32:08x}",
            what,
            robots,
            plans.mean,
            plans.worst,
            plans.units,
            plans.digest
        );
    }

    #[inline(never)]
    fn plan(problem: &Instance, memory: &mut Memory) -> Planned {
        problem.plan(&mut memory.planner)
    }

    #[inline(never)]
    fn decide(problem: &Instance, memory: &mut Memory) -> Planned {
        problem.decide(&mut memory.list)
    }
}
