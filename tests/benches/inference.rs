//! The cost of inference: `cargo bench -p tests --bench inference`.
//!
//! Instructions as callgrind counts them, which do not depend on the machine's load, and the best
//! of many runs by the clock, each beside a plain dense implementation in the same run; then how
//! the cost grows. With `--draw FILE.svg` the growth is drawn. Without valgrind only times are
//! printed.

use firmware::bench::{Benchmark, t1, t2};
use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, Factor, IdentityNoise, Modality, Model, NextState,
    OutcomeTable, Policy, Problem, Scoring,
};
use std::fmt::Write;
use std::hint::black_box;
use std::process::Command;
use std::time::Instant;
use tests::dense::Dense;

/// The number of runs of a case under callgrind.
const REPETITIONS: u32 = 10;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--case", name] => run_case(name),
        ["--draw", file] => report(Some(file)),
        [] => report(None),
        _ => {
            eprintln!("usage: cargo bench -p tests --bench inference [-- --draw FILE.svg]");
            std::process::exit(2);
        }
    }
}

/// Everything that callgrind counts happens in here.
#[inline(never)]
fn measured(work: &mut dyn FnMut()) {
    work();
}

fn run_case(name: &str) {
    let mut work = case(name);
    for _ in 0..REPETITIONS {
        measured(&mut work);
    }
}

/// The work of a case, ready to be repeated.
fn case(name: &str) -> Box<dyn FnMut()> {
    let parts: Vec<&str> = name.split(':').collect();
    let size = |at: usize| parts[at].parse::<usize>().expect("a number");
    match parts[0] {
        "T1" => benchmark(t1::BENCHMARK),
        "T2" => benchmark(t2::BENCHMARK),
        "T1-dense" => dense(Dense::of(&t1::BENCHMARK, 4, [1, 0, 0])),
        "T2-dense" => dense(Dense::of(&t2::BENCHMARK, 4, [8, 36, 0])),
        "states" => match size(1) {
            4 => pair::<4>(4, 6),
            16 => pair::<16>(4, 6),
            64 => pair::<64>(4, 6),
            256 => pair::<256>(4, 6),
            1024 => pair::<1024>(4, 6),
            other => panic!("no case of {other} states"),
        },
        "policies" => pair::<{ t2::S }>(size(1), 6),
        "horizon" => pair::<{ t2::S }>(4, size(1)),
        "robots" => team(size(1)),
        other => panic!("no case {other}"),
    }
}

fn benchmark<const S: usize>(benchmark: Benchmark<S>) -> Box<dyn FnMut()> {
    let mut agent = benchmark.agent(Scoring::JAX_PYMDP).expect("it has the model's sizes");
    Box::new(move || {
        let posterior = black_box(&benchmark).run(&mut agent);
        black_box(posterior).expect("the observation is possible");
    })
}

fn dense(dense: Dense) -> Box<dyn FnMut()> {
    Box::new(move || {
        black_box(black_box(&dense).run(16.0));
    })
}

/// Two robots that share an outcome, with `S` states and `candidates` policies of `horizon` steps
/// each.
fn pair<const S: usize>(candidates: usize, horizon: usize) -> Box<dyn FnMut()> {
    let policies = candidates_of(candidates.isqrt().max(2), horizon);
    let lists = [policies.clone(), policies];
    let mut evaluation = Box::new(Evaluation::<S, 2, 8, 8>::new());
    chain::<S, 2>(2, move |model| {
        let sequences = lists.each_ref().map(Vec::as_slice);
        let mut beliefs = Beliefs::<S, 2>::prior(model);
        beliefs.update(model, &[Evidence::Outcome(0), Evidence::Outcome(S - 1)]).expect("both are possible");
        let problem = Problem::new(model, &beliefs, Candidates::all(&sequences), Scoring::JAX_PYMDP);
        evaluation.evaluate(black_box(&problem)).expect("there is room");
        black_box(evaluation.best());
    })
}

/// The joint decision of `robots` robots, with 2 policies of 6 steps each.
fn team(robots: usize) -> Box<dyn FnMut()> {
    let policies = candidates_of(2, 6);
    let mut evaluation = Box::new(Evaluation::<16, 8, 2, 128>::new());
    chain::<16, 8>(robots, move |model| {
        let sequences = vec![policies.as_slice(); robots];
        let mut beliefs = Beliefs::<16, 8>::prior(model);
        beliefs.update(model, &[Evidence::Outcome(3)]).expect("it is possible");
        let problem = Problem::new(model, &beliefs, Candidates::all(&sequences), Scoring::JAX_PYMDP);
        evaluation.evaluate(black_box(&problem)).expect("there is room");
        black_box(evaluation.best());
    })
}

/// Different policies of `horizon` steps.
fn candidates_of(count: usize, horizon: usize) -> Vec<Policy> {
    let action = |policy: usize, step: usize| ((policy + step * (policy + 1)) % 4) as u8;
    let policy = |policy| (0..horizon).map(|step| action(policy, step)).collect::<Vec<_>>();
    (0..count).map(|number| Policy::new(&policy(number)).expect("it is short enough")).collect()
}

/// Calls `work` with a model of `robots` robots of `S` states each, of which the first shares an
/// outcome with every other.
fn chain<const S: usize, const G: usize>(
    robots: usize,
    mut work: impl FnMut(&Model) + 'static,
) -> Box<dyn FnMut()> {
    let next: Vec<u16> =
        [1, S - 1, 2, S - 2].iter().flat_map(|by| (0..S).map(move |s| ((s + by) % S) as u16)).collect();
    let labels: Vec<u8> = (0..S).map(|state| u8::from(state == 0) + 2 * u8::from(state == S - 1)).collect();
    let (prior, likes) =
        (vec![1.0 / S as f32; S], (0..S).map(|s| if s == 0 { 1.0 } else { 0.0 }).collect::<Vec<_>>());
    Box::new(move || {
        let motion = NextState::try_new(&next, S, 0.1).expect("a next state for each");
        let sensor = IdentityNoise::new(0.9, S);
        let labels = [labels.as_slice(); 2];
        let shared = OutcomeTable::new(
            &labels,
            &[0, 2, 2, 2, 2, 1, 2, 1, 2],
            &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            3,
        );
        let own: Vec<[usize; 1]> = (0..robots).map(|robot| [robot]).collect();
        let pairs: Vec<[usize; 2]> = (1..robots).map(|robot| [0, robot]).collect();
        let factors = vec![Factor::new(&motion, motion.shape(), &prior); robots];
        let own = own.iter().map(|factors| Modality::new(&sensor, sensor.shape(), factors, &likes));
        let shared =
            pairs.iter().map(|factors| Modality::new(&shared, shared.shape(), factors, &[0.0, 1.0, 0.0]));
        let modalities: Vec<Modality> = own.chain(shared).collect();
        work(&Model::new(&factors, &modalities));
    })
}

fn report(drawing: Option<&str>) {
    println!(
        "One belief update and policy posterior, against a plain dense implementation in the same run:\n"
    );
    println!("{:10} {:>14} {:>10} {:>8} {:>12} {:>8}", "", "instructions", "us", "", "dense", "ratio");
    for name in ["T1", "T2"] {
        let dense = format!("{name}-dense");
        let (ours, theirs) = times(name, &dense);
        let counts = (instructions(name), instructions(&dense));
        if let (Some(ours), Some(theirs)) = counts {
            println!(
                "{name:10} {ours:>14} {:>10} {:>8} {theirs:>12} {:>8.1}",
                "",
                "",
                theirs as f64 / ours as f64
            );
        }
        println!("{name:10} {:>14} {:>10.2} {:>8} {:>9.2} us {:>8.1}", "", ours, "", theirs, theirs / ours);
    }
    let curves: Vec<Curve> = SWEEPS.iter().filter_map(Curve::measure).collect();
    if curves.is_empty() {
        println!("\nvalgrind is not installed: no instruction counts, and no growth");
        return;
    }
    for curve in &curves {
        println!("\nInstructions by {} (exponent {:.2}):", curve.sweep.what, curve.exponent());
        for (size, count) in &curve.points {
            println!("{size:>8} {count:>12}");
        }
    }
    if let Some(file) = drawing {
        std::fs::write(file, draw(&curves)).unwrap_or_else(|error| panic!("{file}: {error}"));
        println!("\ndrawn in {file}");
    }
}

/// The best times of two cases, in microseconds, taken in turns.
fn times(first: &str, second: &str) -> (f64, f64) {
    let mut work = [case(first), case(second)];
    let mut best = [f64::INFINITY; 2];
    for _ in 0..200 {
        for (work, best) in work.iter_mut().zip(&mut best) {
            let started = Instant::now();
            work();
            *best = best.min(started.elapsed().as_secs_f64() * 1e6);
        }
    }
    (best[0], best[1])
}

/// The instructions of one run of a case; `None` without valgrind.
fn instructions(name: &str) -> Option<u64> {
    let this = std::env::current_exe().expect("this program has a path");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*measured*"])
        .arg(this)
        .args(["--case", name])
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let count = text.lines().find_map(|line| line.split("Collected :").nth(1))?.trim().parse::<u64>().ok()?;
    Some(count / u64::from(REPETITIONS))
}

/// What is varied, and over which sizes.
struct Sweep {
    what: &'static str,
    case: &'static str,
    sizes: &'static [usize],
}

const SWEEPS: [Sweep; 4] = [
    Sweep { what: "robots, 2 policies each", case: "robots", sizes: &[2, 3, 4, 5, 6, 7, 8] },
    Sweep { what: "joint policies of two robots", case: "policies", sizes: &[4, 9, 16, 25, 36, 49, 64] },
    Sweep { what: "steps of the horizon", case: "horizon", sizes: &[1, 2, 4, 8, 16, 32] },
    Sweep { what: "states of each of two robots", case: "states", sizes: &[4, 16, 64, 256, 1024] },
];

struct Curve {
    sweep: &'static Sweep,
    points: Vec<(usize, u64)>,
}

impl Curve {
    fn measure(sweep: &'static Sweep) -> Option<Self> {
        let point = |&size: &usize| Some((size, instructions(&format!("{}:{size}", sweep.case))?));
        Some(Self { sweep, points: sweep.sizes.iter().map(point).collect::<Option<_>>()? })
    }

    /// The slope between the last two points on logarithmic axes: one is linear.
    fn exponent(&self) -> f64 {
        let [.., (before, less), (last, more)] = self.points[..] else { return f64::NAN };
        (more as f64 / less as f64).ln() / (last as f64 / before as f64).ln()
    }
}

/// The curves side by side, on linear axes from zero.
fn draw(curves: &[Curve]) -> String {
    let (width, height, margin) = (300.0, 220.0, 50.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        2.0 * (width + 1.5 * margin),
        2.0 * (height + 2.0 * margin)
    );
    for (number, curve) in curves.iter().enumerate() {
        let left = margin * 1.2 + (number % 2) as f64 * (width + 1.5 * margin);
        let top = margin + (number / 2) as f64 * (height + 2.0 * margin);
        let most = curve
            .points
            .iter()
            .fold((1.0, 1.0), |(x, y): (f64, f64), &(size, count)| (x.max(size as f64), y.max(count as f64)));
        let at =
            |size: f64, count: f64| (left + size / most.0 * width, top + height - count / most.1 * height);
        let line = curve.points.iter().map(|&(size, count)| {
            let (x, y) = at(size as f64, count as f64);
            format!("{x:.1},{y:.1}")
        });
        let _ = writeln!(
            svg,
            "<text x=\"{left}\" y=\"{:.1}\" font-weight=\"bold\">{}</text>",
            top - 18.0,
            curve.sweep.what
        );
        let _ = writeln!(
            svg,
            "<text x=\"{left}\" y=\"{:.1}\" fill=\"#666\">instructions, up to {:.0}</text>",
            top - 4.0,
            most.1
        );
        let _ = writeln!(svg, "<path d=\"M{left} {top} v{height} h{width}\" fill=\"none\" stroke=\"#888\"/>");
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"2\"/>",
            line.collect::<Vec<_>>().join(" ")
        );
        for &(size, count) in &curve.points {
            let (x, y) = at(size as f64, count as f64);
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#1f5fa8\"><title>{size}: {count}</title></circle>"
            );
        }
        let shown = curve.points.iter().filter(|(size, _)| *size as f64 >= most.0 / 16.0);
        for &(size, _) in shown {
            let (x, y) = at(size as f64, 0.0);
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#666\">{size}</text>",
                y + 15.0
            );
        }
    }
    svg + "</svg>\n"
}
