//! The self-test on chips with different cores: every vector has the same bits as on the host.

use firmware::bench::self_test;
use tests::budgets::assert_within;
use tests::chips::{CHIPS, Chip};

/// The rows of `budgets.toml` for the stacks, in the order of [`CHIPS`].
const STACKS: [&str; 3] = ["stack_m4f", "stack_m0", "stack_rv32"];

/// The first vector that a chip computes otherwise than the host.
fn difference(chip: Chip, printed: &[String], on_host: &[String]) -> Option<String> {
    let pairs = printed.iter().zip(on_host).find(|(printed, on_host)| printed != on_host);
    let difference = pairs.map(|(printed, on_host)| format!("{printed}, and {on_host} on the host"));
    let missing = (printed.len() != on_host.len())
        .then(|| format!("{} vectors, and {} on the host", printed.len(), on_host.len()));
    difference.or(missing).map(|difference| format!("{}: {difference}", chip.core))
}

#[test]
fn every_vector_has_the_same_bits_on_every_chip() {
    let mut on_host = Vec::new();
    self_test::run(&mut |vector| on_host.push(vector.to_string()));
    let stacks = CHIPS.map(|chip| {
        let printed = chip.run("self_test", "self-test");
        assert_eq!(difference(chip, &printed.lines, &on_host), None);
        println!("{}: {} bytes of stack", chip.core, printed.stack);
        printed.stack
    });
    for (row, stack) in STACKS.into_iter().zip(stacks) {
        assert_within("self_test", row, stack);
    }
}

#[test]
fn a_difference_names_the_vector_and_the_chip() {
    let on_host = ["beliefs 0: 12", "tree 7: 3456"].map(str::to_owned);
    let chip = CHIPS[1];
    assert_eq!(difference(chip, &on_host, &on_host), None);
    let mut printed = on_host.clone();
    printed[1] = "tree 7: 3457".to_owned();
    assert_eq!(
        difference(chip, &printed, &on_host).as_deref(),
        Some("Cortex-M0: tree 7: 3457, and tree 7: 3456 on the host")
    );
    assert_eq!(
        difference(chip, &on_host[..1], &on_host).as_deref(),
        Some("Cortex-M0: 1 vectors, and 2 on the host")
    );
}
