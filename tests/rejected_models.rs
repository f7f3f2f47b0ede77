//! Models that are none do not compile, and the message names what is wrong.

#[test]
fn wrong_tables_fail_the_build() {
    trybuild::TestCases::new().compile_fail("rejected_models/*.rs");
}
