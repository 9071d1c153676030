//! Work side by side.

/// Two things at once.
pub(crate) fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B) -> (Option<A>, B) {
    std::thread::scope(|scope| {
        let other = scope.spawn(a);
        let mine = b();
        (other.join().ok(), mine)
    })
}
