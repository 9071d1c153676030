//! What can be named on this command line. Set once, before any work is done.

use std::sync::OnceLock;

use runs::Vocabulary;

static VOCABULARY: OnceLock<Vocabulary> = OnceLock::new();

/// Sets what can be named; the first call counts.
pub(crate) fn set(vocabulary: Vocabulary) {
    let _ = VOCABULARY.set(vocabulary);
}

/// What can be named: where nobody has said so, what the library has.
pub(crate) fn vocabulary() -> &'static Vocabulary {
    VOCABULARY.get_or_init(Vocabulary::standard)
}
