use firmware::benchmarks::{Benchmark, Workspace, t1, t2};
use iibt_core::inference::Scoring;
use std::hint::black_box;

#[inline(never)]
fn measured<const S: usize>(b: &Benchmark<S>, w: &mut Workspace<S>) {
    black_box(black_box(b).run(w, Scoring::JAX_PYMDP)).unwrap();
}
#[inline(never)]
fn measured_t1() {
    let b = t1();
    let mut w = Workspace::new(&b);
    for _ in 0..100 {
        measured(&b, &mut w);
    }
}
#[inline(never)]
fn measured_t2() {
    let b = t2();
    let mut w = Workspace::new(&b);
    for _ in 0..100 {
        measured(&b, &mut w);
    }
}

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("t1") => measured_t1(),
        Some("t2") => measured_t2(),
        _ => {}
    }
}
