//! The benchmark models on the STM32F405: logs how long one belief update and policy posterior
//! takes, and its bits.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This image runs on a robot: `cargo fw` builds it, `cargo fw-run benchmark` starts it in QEMU."
    );
}

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use firmware::adapters::Chassis;
    use firmware::bench::{Benchmark, t1, t2};
    use firmware::board::{self, Board};
    use iibt_core::inference::Scoring;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(board) = Board::take(Chassis::STANDING) else { board::restart() };
        measure(&t1::BENCHMARK, &board);
        measure(&t2::BENCHMARK, &board);
        loop {
            board::sleep();
        }
    }

    #[inline(never)]
    fn measure<const S: usize>(benchmark: &Benchmark<S>, board: &Board) {
        let Ok(mut agent) = benchmark.agent(Scoring::JAX_PYMDP) else { return };
        let started = board.clock.cycles();
        let posterior = black_box(benchmark).run(&mut agent);
        let cycles = board.clock.cycles().wrapping_sub(started);
        defmt::info!("{=str}: took {=u32} cycles", benchmark.name, cycles);
        for (policy, p) in posterior.unwrap_or_default().iter().enumerate() {
            defmt::info!("{=str}: posterior of {=usize}: {=u32:08x}", benchmark.name, policy, p.to_bits());
        }
        for q in agent.beliefs().as_flat() {
            defmt::info!("{=str}: belief {=u32:08x}", benchmark.name, q.to_bits());
        }
    }
}
