//! The benchmark models on the emulated chip: their cost there, and the same bits as on the host.

use firmware::bench::{Benchmark, Workspace, t1, t2};
use iibt_core::inference::Scoring;
use tests::budgets::assert_within;
use tests::qemu::{Robot, image_with, number};

/// What the image logged after `marker`, word by word.
fn bits(robot: &mut Robot, marker: &str, words: usize) -> Vec<u32> {
    let mut read = || {
        let line = robot.wait_for(marker).message;
        let word = line.rsplit(' ').next().expect("a word at the end");
        u32::from_str_radix(word, 16).expect("eight hexadecimal digits")
    };
    (0..words).map(|_| read()).collect()
}

fn assert_same<const S: usize>(robot: &mut Robot, benchmark: &Benchmark<S>) -> u64 {
    let took = robot.wait_for(&format!("{}: took", benchmark.name)).message;
    let instructions = u64::from(number(&took, "took ")) * 1000 / 168;
    let mut agent = benchmark.agent(Scoring::JAX_PYMDP).expect("it has the model's sizes");
    let posterior = benchmark.run(&mut agent).expect("the observation is possible");
    let theirs = bits(robot, &format!("{}: posterior", benchmark.name), posterior.len());
    assert_eq!(theirs, posterior.map(f32::to_bits), "{}", benchmark.name);
    let beliefs: Vec<u32> = agent.beliefs().as_flat().iter().map(|q| q.to_bits()).collect();
    assert_eq!(
        bits(robot, &format!("{}: belief", benchmark.name), beliefs.len()),
        beliefs,
        "{}",
        benchmark.name
    );
    instructions
}

#[test]
fn the_benchmarks_have_the_same_bits_on_the_chip_and_keep_their_budgets() {
    let mut robot = Robot::boot_counting(&image_with("benchmark", "bench"));
    let first = assert_same(&mut robot, &t1::BENCHMARK);
    let second = assert_same(&mut robot, &t2::BENCHMARK);
    assert_within("benchmark", "t1", first);
    assert_within("benchmark", "t2", second);
}

#[test]
fn the_benchmarks_fit_their_memory() {
    let small = size_of::<Workspace<{ t1::S }>>();
    let large = size_of::<Workspace<{ t2::S }>>();
    println!("working memory: T1 {small}, T2 {large} bytes");
    assert!(small <= 1_024 && large <= 4_096, "T1 {small}, T2 {large} bytes");
}
