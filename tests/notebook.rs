//! Models from notebooks: the numbers of the field's tools, refusals that name the place, and
//! exported source that has the same bits.

#![allow(clippy::excessive_precision, reason = "the figures of other tools, as they give them")]

use host_sim::notebook::{
    BeliefMethod, Convention, Forms, InferenceReport, InferenceRun, Notebook, StepReport,
};
use iibt_core::inference::{Evidence, Update};
use tests::package::{Package, assert_is_kept};

const BENCHMARK_1: &str = include_str!("../host-sim/models/benchmark-1.json");
const BENCHMARK_2: &str = include_str!("../host-sim/models/benchmark-2.json");
const SWITCH: &str = include_str!("../host-sim/models/switch.json");

/// What a tool of the field gives for a model: pymdp 0.0.7.1 in numpy for the joint information
/// gain, pymdp 1.0.4 in JAX and double precision for the one per modality.
struct Expected {
    model: &'static str,
    convention: Convention,
    /// The most probable state of each factor.
    peaks: [(usize, f32); 2],
    free_energy: f32,
    /// G by policy, larger is better.
    values: [f32; 16],
    /// The posterior at precision 1.
    broad: [f32; 16],
    /// The posterior at precision 16.
    narrow: [f32; 16],
}

#[rustfmt::skip]
const EXPECTED: [Expected; 4] = [
    Expected {
        model: BENCHMARK_1,
        convention: Convention::Joint,
        peaks: [(1, 0.74908171), (0, 0.97920050)],
        free_energy: 3.161757,
        values: [
            -5.060211, -4.703613, -4.264898, -4.852329, -4.787128, -5.819390, -2.438933, -4.579257,
            -4.820627, -2.849493, -5.365363, -4.612749, -5.015325, -4.658702, -4.219720, -6.107951,
        ],
        broad: [
            0.024432, 0.034900, 0.054120, 0.030077, 0.032104, 0.011435, 0.336018, 0.039521,
            0.031046, 0.222874, 0.018007, 0.038220, 0.025553, 0.036503, 0.056621, 0.008569,
        ],
        narrow: [
            0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.9986, 0.0000,
            0.0000, 0.0014, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
        ],
    },
    Expected {
        model: BENCHMARK_1,
        convention: Convention::PerModality,
        peaks: [(1, 0.74909756), (0, 0.97921551)],
        free_energy: 3.161757,
        values: [
            -5.060218, -4.595005, -4.147678, -4.850808, -4.787117, -5.694411, -2.277204, -4.577728,
            -4.820615, -2.584003, -5.127449, -4.611216, -5.014614, -4.551307, -4.102303, -5.937508,
        ],
        broad: [
            0.021120, 0.033630, 0.052602, 0.026040, 0.027752, 0.011201, 0.341457, 0.034216,
            0.026838, 0.251244, 0.019747, 0.033089, 0.022105, 0.035132, 0.055043, 0.008784,
        ],
        narrow: [
            0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.9927, 0.0000,
            0.0000, 0.0073, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
        ],
    },
    Expected {
        model: BENCHMARK_2,
        convention: Convention::Joint,
        peaks: [(8, 0.99539908), (36, 0.90763052)],
        free_energy: 7.787849,
        values: [
            -50.172565, -50.182646, -49.252924, -50.088713, -50.172925, -50.183008, -49.253286, -50.089076,
            -49.183978, -49.194061, -50.237875, -51.073664, -50.091946, -50.102030, -51.145843, -52.070990,
        ],
        broad: [
            0.048673, 0.048185, 0.122092, 0.052931, 0.048656, 0.048168, 0.122048, 0.052912,
            0.130806, 0.129494, 0.045596, 0.019767, 0.052760, 0.052230, 0.018391, 0.007291,
        ],
        narrow: [
            0.0000, 0.0000, 0.1321, 0.0000, 0.0000, 0.0000, 0.1313, 0.0000,
            0.3980, 0.3387, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
        ],
    },
    Expected {
        model: BENCHMARK_2,
        convention: Convention::PerModality,
        peaks: [(8, 0.99539908), (36, 0.90763052)],
        free_energy: 7.787849,
        values: [
            -50.052993, -50.087312, -48.922395, -49.752111, -50.054620, -50.089142, -48.924158, -49.754065,
            -48.853973, -48.888428, -50.146254, -50.976094, -49.562521, -49.597109, -50.854868, -51.998637,
        ],
        broad: [
            0.040900, 0.039520, 0.126688, 0.055258, 0.040834, 0.039448, 0.126465, 0.055150,
            0.135660, 0.131066, 0.037258, 0.016249, 0.066793, 0.064523, 0.018343, 0.005844,
        ],
        narrow: [
            0.0000, 0.0000, 0.1496, 0.0000, 0.0000, 0.0000, 0.1455, 0.0000,
            0.4472, 0.2577, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000,
        ],
    },
];

fn notebook(text: &str) -> Notebook {
    Notebook::read("model.json", text.as_bytes()).expect("a model")
}

fn run(notebook: &Notebook, run: InferenceRun) -> InferenceReport {
    notebook.infer(run, &mut |_| ()).expect("a report")
}

fn only(report: &InferenceReport) -> &StepReport {
    assert_eq!(report.result.steps().len(), 1);
    &report.result.steps()[0]
}

/// Why a text is refused.
fn refusal(text: &str) -> String {
    Notebook::read("model.json", text.as_bytes()).expect_err(text).to_string()
}

fn farthest(found: &[f32], expected: &[f32]) -> f32 {
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[test]
fn the_tools_of_the_field_give_the_same_numbers() {
    for expected in &EXPECTED {
        let convention = expected.convention;
        let model = notebook(expected.model);
        let report = run(&model, InferenceRun { convention, ..InferenceRun::default() });
        let step = only(&report);
        assert!(step.converged && step.beliefs == "parallel sweeps");
        for (q, (state, probability)) in step.qs.iter().zip(expected.peaks) {
            assert!(
                (q[state] - probability).abs() < 1e-5,
                "{convention:?}: {} is not {probability}",
                q[state]
            );
        }
        assert!((step.F.expect("F") - expected.free_energy).abs() < 1e-4);
        assert!(farthest(&step.G, &expected.values) < 1e-4, "{convention:?}: {:?}", step.G);
        assert!(farthest(&step.q_pi, &expected.narrow) < 1e-3, "{convention:?}: {:?}", step.q_pi);
        for (free_energy, value) in step.expected_free_energy.iter().zip(&step.G) {
            assert_eq!(*free_energy, -value);
        }
        if convention == Convention::PerModality || report.name == "benchmark-1" {
            let broad = run(
                &model.with_precision(1.0).expect("a precision"),
                InferenceRun { convention, ..InferenceRun::default() },
            );
            assert!(farthest(&only(&broad).q_pi, &expected.broad) < 1e-4);
        }
    }
}

#[test]
fn exact_beliefs_have_the_surprise_for_their_free_energy() {
    for text in [BENCHMARK_1, BENCHMARK_2] {
        let model = notebook(text);
        let default = run(&model, InferenceRun::default());
        let step = only(&default);
        assert_eq!((step.beliefs, step.F), ("exact", step.surprise));
        let ascent =
            run(&model, InferenceRun { beliefs: Some(BeliefMethod::Ascent), ..InferenceRun::default() });
        assert_eq!(only(&ascent).beliefs, "coordinate ascent");
        assert_eq!(only(&ascent).surprise, step.surprise);
        assert!(only(&ascent).F >= step.F);
    }
}

#[test]
fn sweeps_that_do_not_come_to_rest_give_way_to_exact_beliefs() {
    // Both robots see themselves beside the goals and hear of a failure: factors swept in parallel
    // oscillate.
    let model = notebook(BENCHMARK_2).observing("24,25,2").expect("an observation");
    let report = run(&model, InferenceRun { convention: Convention::PerModality, ..InferenceRun::default() });
    let step = only(&report);
    assert_eq!(step.beliefs, "exact");
    assert!(step.note.as_ref().is_some_and(|note| note.contains("did not come to rest")));
    assert!(step.qs[0][24] > 0.5 && step.qs[1][25] > 0.5);
}

#[test]
fn structure_changes_no_result() {
    for text in [BENCHMARK_1, BENCHMARK_2, SWITCH] {
        let model = notebook(text);
        let structured = run(&model, InferenceRun::default());
        let dense = run(&model, InferenceRun { forms: Forms::Dense, ..InferenceRun::default() });
        assert!(dense.structure.A.iter().chain(&dense.structure.B).all(|form| *form == "dense"));
        assert!(structured.structure.bytes < dense.structure.bytes);
        for (a, b) in structured.result.steps().iter().zip(dense.result.steps()) {
            assert!(a.qs.iter().zip(&b.qs).all(|(a, b)| farthest(a, b) < 1e-5));
            assert!(farthest(&a.G, &b.G) < 1e-4 && farthest(&a.q_pi, &b.q_pi) < 1e-3);
            assert_eq!(a.policy, b.policy);
        }
    }
}

#[test]
fn a_team_on_a_grid_takes_three_kilobytes() {
    let report = run(&notebook(BENCHMARK_2), InferenceRun::default());
    assert_eq!(report.structure.A, ["identity with noise", "identity with noise", "outcome table"]);
    assert_eq!(report.structure.B, ["next state"; 2]);
    assert!(report.structure.bytes <= 3072 && report.structure.dense_bytes > 1_000_000);
}

#[test]
fn terms_add_up_and_the_choice_is_explained() {
    for convention in [Convention::Default, Convention::Joint, Convention::AsPrinted] {
        let report = run(&notebook(BENCHMARK_1), InferenceRun { convention, ..InferenceRun::default() });
        let step = only(&report);
        for (terms, free_energy) in step.terms.iter().zip(&step.expected_free_energy) {
            let total = terms.total;
            let sign = if convention == Convention::AsPrinted { -1.0 } else { 1.0 };
            assert!((total.risk + sign * total.ambiguity - free_energy).abs() < 1e-5);
            let utility: f32 = terms.by_modality.iter().map(|part| part.utility).sum();
            assert!((utility - total.utility).abs() < 1e-5);
            let ambiguity: f32 = terms.by_step.iter().map(|part| part.ambiguity).sum();
            assert!((ambiguity - total.ambiguity).abs() < 1e-4);
        }
        let why = step.why.as_ref().expect("a runner-up");
        assert!(why.lead >= 0.0 && why.runner_up != step.policy);
        let parts = why.by_modality.iter().sum::<f32>() + why.beyond;
        assert!((parts * report.gamma + why.habit - why.lead).abs() < 1e-3);
    }
}

#[test]
fn a_record_of_steps_goes_on_from_step_to_step() {
    let report = run(&notebook(SWITCH), InferenceRun::default());
    let steps = report.result.steps();
    assert_eq!(steps.len(), 3);
    assert_eq!(steps[0].qs, [vec![1.0, 0.0, 0.0], vec![0.5, 0.5]]);
    // From cell 0 by action 2: 0.8 to cell 1; the reading has weights 0.2, 0.7, 0.1.
    let weights = [0.2 * (0.9 * 0.2 + 0.05 * 0.8), 0.8 * (0.05 * 0.3 + 0.9 * 0.7)];
    assert!(steps[1].qs[0][1] > weights[1] / (weights[0] + weights[1]) - 0.02);
    assert_eq!(steps[1].qs[1], [0.0, 1.0]);
    for step in steps {
        assert_eq!(step.q_pi.len(), 9);
        assert!(step.q_pi[5..].iter().all(|p| *p == 0.0), "a policy of no prior probability");
        assert!((step.q_pi.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        assert_eq!(step.actions.len(), 2);
    }
}

#[test]
fn an_impossible_observation_is_told_and_changes_nothing() {
    let off = SWITCH.replace("[0.5, 0.5]],\n \"E\"", "[1, 0]],\n \"E\"");
    let model = notebook(&off).observing("null, 1").expect("an observation");
    let report = run(&model, InferenceRun::default());
    let step = only(&report);
    assert_eq!((step.F, step.surprise, step.converged), (None, None, false));
    assert!(step.impossible.as_ref().is_some_and(|reason| reason.contains("modality 1")));
    assert_eq!(step.qs, [vec![1.0, 0.0, 0.0], vec![1.0, 0.0]]);
}

#[test]
fn malformed_models_are_refused_by_their_place() {
    let cases = [
        (r#"[0, 2, -2]"#, r#"[0, 2]"#, "C[2] has 2 entries, A[2] has 3 outcomes"),
        (r#"[0.7, 0.1, 0.1, 0.1]"#, r#"[0.7, 0.1, 0.1, 0.2]"#, "D[0] sums to 1.1, not to 1"),
        (
            r#"[0.7, 0.1, 0.1, 0.1]"#,
            r#"[0.7, 0.1, -0.1, 0.3]"#,
            "D[0][2] is -0.1: a probability is not negative",
        ),
        (r#"[0.7, 0.1, 0.1, 0.1]"#, r#"[0.7, NaN, 0.1, 0.1]"#, "D[0][1] is NaN, not a finite number"),
        (r#"[0.7, 0.1, 0.1, 0.1]"#, r#"[0.7, 0.3]"#, "D[0] has 2 entries, B[0] has 4 states"),
        (r#""A_dep""#, r#""A_deps""#, "\"A_deps\" is no key of a model; the keys are name, A, "),
        (r#""gamma": 16"#, r#""gamma": -1"#, "gamma is -1: a precision is from 0"),
        (r#""gamma": 16"#, r#""policy_len": 2"#, "policies and policy_len are both there"),
        (r#"[[1, 2]]"#, r#"[[1, 7]]"#, "policy 6 step 0 factor 1 has action 7, but B[1] has 4 actions"),
        (
            r#"[[1, 2]]"#,
            r#"[[1, 2], [0, 0]]"#,
            "policies is ragged: policies[6] has 2 steps, policies[0] has 1",
        ),
        (r#""obs": [1, 0, 0]"#, r#""obs": [4, 0, 0]"#, "obs[0] is 4, but A[0] has 4 outcomes, from 0"),
        (r#""obs": [1, 0, 0]"#, r#""obs": [1, 0]"#, "obs has 2 entries, A has 3 modalities"),
        (r#""obs": [1, 0, 0]"#, r#""obs": [1, 0, [0, 0, 0]]"#, "obs[2] has no weight"),
        (r#""obs": [1, 0, 0]"#, r#""horizon": 65"#, "horizon is 65: a policy has 1 to 64 steps"),
        (r#"[[0], [1], [0, 1]]"#, r#"[[0], [1], [0, 2]]"#, "A_dep[2][1] is 2: B has factors 0 to 1"),
        (
            r#"[[0], [1], [0, 1]]"#,
            r#"[[0], [1], [0]]"#,
            "A[2] has 3 axes, not 2: the outcome and a state of each factor",
        ),
    ];
    for (sound, broken, reason) in cases {
        let text = BENCHMARK_1.replacen(sound, broken, 1);
        assert_ne!(text, BENCHMARK_1, "{sound}");
        let refusal = refusal(&text);
        assert!(refusal.starts_with(&format!("model.json: {reason}")), "{broken}: {refusal}");
    }
}

#[test]
fn a_broken_table_is_named_with_its_column() {
    let of = |table: &str, at: &str, broken: &str| {
        let begin = BENCHMARK_1.find(table).expect("a table");
        let (before, after) = BENCHMARK_1.split_at(begin);
        refusal(&(before.to_owned() + &after.replacen(at, broken, 1)))
    };
    let likelihood = "\"A_red\"";
    assert_eq!(of(likelihood, "0.08", "0.05"), "model.json: A[2] column (1, 1) sums to 0.97, not to 1");
    assert_eq!(
        of(likelihood, "0.08", "-0.08"),
        "model.json: A[2][0][1][1] is -0.08: a probability is not negative"
    );
    assert_eq!(of(likelihood, "0.08", "NaN"), "model.json: A[2][0][1][1] is NaN, not a finite number");
    assert_eq!(
        of(likelihood, "0.08, ", ""),
        "model.json: A[2] is ragged: A[2][0][1] has 3 entries, A[2][0][0] has 4"
    );
    assert_eq!(of(likelihood, "0.08", "0.08,"), "model.json:18:43: expected value, found ','");
    assert_eq!(of("\"B\"", "[1,", "[0.9,"), "model.json: B[0] column (0, 0) sums to 0.9, not to 1");
}

#[test]
fn models_beyond_the_limits_are_refused_with_the_limit() {
    let corridor = |states: usize| {
        let identity: Vec<Vec<Vec<u8>>> =
            (0..states).map(|a| (0..states).map(|b| vec![u8::from(a == b)]).collect()).collect();
        serde_json::json!({
            "A": [[vec![1; states]]], "B": [identity], "C": [[0]], "D": [vec![1.0 / states as f64; states]], "obs": [0],
        })
    };
    assert!(Notebook::read("m", corridor(5).to_string().as_bytes()).is_ok());
    let with = |key: &str, value: serde_json::Value| {
        let mut model = corridor(3);
        model[key] = value;
        refusal(&model.to_string())
    };
    let sixteen = |count: usize| serde_json::json!([vec![vec![vec![1; count]]]]);
    assert_eq!(with("B", sixteen(17)), "model.json: B[0] has 17 actions: a factor has at most 16");
    assert_eq!(
        with("B", serde_json::json!(vec![vec![vec![vec![1]]]; 17])),
        "model.json: B has 17 factors: a model has 1 to 16"
    );
    assert_eq!(
        with("A", serde_json::json!(vec![vec![vec![1; 3]]; 41])),
        "model.json: A has 41 modalities: a model has 1 to 40"
    );
    let many = serde_json::json!(vec![[[0]]; 4097]);
    assert_eq!(with("policies", many), "model.json: policies has 4097 entries: this program takes 1 to 4096");
    let mut model = serde_json::from_str::<serde_json::Value>(BENCHMARK_1).expect("JSON");
    model.as_object_mut().expect("an object").remove("policies");
    model["policy_len"] = 4.into();
    assert!(refusal(&model.to_string()).contains("more than the 4096 policies"));
    model["policy_len"] = 3.into();
    assert_eq!(only(&run(&notebook(&model.to_string()), InferenceRun::default())).q_pi.len(), 4096);
}

#[rustfmt::skip]
#[allow(dead_code, unreachable_pub, reason = "modules as they are written for other crates")]
mod exported {
    #[path = "../exported/benchmark_1.rs"]
    pub mod benchmark_1;
    #[path = "../exported/benchmark_2.rs"]
    pub mod benchmark_2;
    #[path = "../exported/switch.rs"]
    pub mod switch;
}

/// Runs an exported model and compares every bit with the report.
macro_rules! same_bits {
    ($model:ident, $text:expr, $observation:expr, $listed:expr) => {{
        use exported::$model as model;
        let report =
            run(&notebook($text).observing($listed).expect("an observation"), InferenceRun::default());
        let step = only(&report);
        let mut agent = model::AGENT;
        let update: Update = agent.observe(&$observation).expect("a possible observation");
        let decision = agent.decide(model::CANDIDATES).expect("a policy that can be chosen");
        let values: Vec<f32> = agent.terms().iter().map(|terms| -terms.expected_free_energy()).collect();
        assert_eq!(Some(update.free_energy), step.F);
        assert_eq!(values, step.G);
        for (factor, q) in step.qs.iter().enumerate() {
            assert_eq!(agent.belief(factor), Ok(&q[..]));
        }
        assert_eq!((decision.policy(), agent.posterior()), (step.policy, &step.q_pi[..]));
    }};
}

#[test]
fn exported_source_has_the_same_bits() {
    use Evidence::{Missing, Outcome};
    same_bits!(benchmark_1, BENCHMARK_1, [Outcome(1), Outcome(0), Outcome(0)], "1, 0, 0");
    same_bits!(benchmark_2, BENCHMARK_2, [Outcome(8), Outcome(36), Outcome(0)], "8, 36, 0");
    same_bits!(benchmark_2, BENCHMARK_2, [Outcome(24), Outcome(25), Missing], "[24, 25, null]");
    same_bits!(switch, SWITCH, [Evidence::Soft(&[0.5, 0.3, 0.2]), Outcome(0)], "[0.5, 0.3, 0.2], 0");
}

#[test]
fn exported_source_is_what_export_writes() {
    let models = [("benchmark_1", BENCHMARK_1), ("benchmark_2", BENCHMARK_2), ("switch", SWITCH)];
    for (name, text) in models {
        let written = notebook(text).to_rust(Forms::Structured).expect("source");
        assert_is_kept(&format!("{name}.rs"), &written);
    }
}

#[test]
fn exported_source_compiles_without_std() {
    let source = |text, forms| notebook(text).to_rust(forms).expect("source");
    let sources = [
        ("lib.rs", "#![no_std]\npub mod dense;\npub mod structured;\npub mod team;\n".to_owned()),
        ("dense.rs", source(SWITCH, Forms::Dense)),
        ("structured.rs", source(SWITCH, Forms::Structured)),
        ("team.rs", source(BENCHMARK_2, Forms::Structured)),
    ];
    Package::new(concat!(env!("CARGO_TARGET_TMPDIR"), "/exported"), sources).assert_compiles_for_the_chip();
}
