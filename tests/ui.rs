//! What `#[derive(StateBlocks)]` accepts, and what it says about what it does not.

#[test]
#[cfg_attr(miri, ignore = "runs the compiler")]
fn diagnostics() {
    let cases = trybuild::TestCases::new();
    cases.pass("tests/ui/pass/*.rs");
    cases.compile_fail("tests/ui/*.rs");
}
