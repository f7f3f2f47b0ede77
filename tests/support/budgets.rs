//! The budgets file, and what README says of it.

const BUDGETS: &str = include_str!("../budgets.toml");
const README: &str = include_str!("../../README.md");

/// Holds a figure against its budget in a section of `budgets.toml`, and README against the budget.
///
/// # Panics
/// When the figure is over its budget or more than 5 % under, or README does not say what the
/// budget is.
pub fn assert_within(section: &str, figure: &str, measured: u64) {
    assert_within_or_under(section, figure, measured, 0);
}

/// Holds the deepest stack of a run against its budget: an interrupt at the deepest place adds up
/// to 300 bytes in one run and nothing in another.
///
/// # Panics
/// As [`assert_within`] does.
pub fn assert_stack_within(section: &str, figure: &str, measured: u64) {
    assert_within_or_under(section, figure, measured, 300);
}

/// `less` is by how much a run may be below another one.
fn assert_within_or_under(section: &str, figure: &str, measured: u64, less: u64) {
    let budgets: toml::Value = toml::from_str(BUDGETS).expect("budgets.toml is TOML");
    let budget =
        budgets.get(section).and_then(|section| section.get(figure)).and_then(toml::Value::as_integer);
    let budget = budget.and_then(|budget| u64::try_from(budget).ok());
    let budget = budget.unwrap_or_else(|| panic!("budgets.toml has no [{section}] {figure}"));
    println!("{section}: {figure} {measured} of {budget}");
    assert!(measured <= budget, "{figure}: {measured} is over the budget of {budget}");
    assert!((measured + less) * 100 >= budget * 95, "{figure}: {measured}: lower the budget of {budget}");
    assert!(README.contains(&with_commas(budget)), "README does not say {figure} {}", with_commas(budget));
}

/// A number the way README prints it: `12,345`.
fn with_commas(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| core::str::from_utf8(group).unwrap_or("")).collect();
    groups.join(",")
}
