//! Work side by side.

/// Two things at once. A panic in either is one of the caller's: nothing is lost on the way to a verdict.
pub(crate) fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B) -> (A, B) {
    std::thread::scope(|scope| {
        let other = scope.spawn(a);
        let mine = b();
        match other.join() {
            Ok(other) => (other, mine),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_done() {
        let values = [1.0, 2.0];
        assert_eq!(both(|| values[0] + 1.0, || values[1] * 3.0), (2.0, 6.0));
    }

    #[test]
    fn a_panic_on_either_side_is_the_callers() {
        let lost = |a: bool, b: bool| std::panic::catch_unwind(|| both(|| assert!(!a), || assert!(!b)));
        assert!(lost(false, false).is_ok());
        assert!(lost(true, false).is_err() && lost(false, true).is_err());
    }
}
