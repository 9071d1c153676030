//! What can go wrong in a run.

use sinscal::Diverged;

use crate::ReadError;

/// Why a run came to no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A sample cannot be read; the source says where and why.
    #[error(transparent)]
    Unreadable(#[from] ReadError),
    /// A filter has diverged.
    #[error("{filter}: {diverged}")]
    Diverged {
        /// Name of the filter.
        filter: String,
        /// When, and by what.
        diverged: Diverged,
    },
    /// A filter found no reading of what it measures.
    #[error(
        "no update was made: {filter} measures {measures}, and no row has such a reference that it accepts"
    )]
    NoUpdate {
        /// Name of the filter.
        filter: String,
        /// What it measures.
        measures: String,
    },
    /// A filter found nothing to align with.
    #[error("{filter} found no reference of position or velocity to align with in its first {seconds:.0} s")]
    NoAlignment {
        /// Name of the filter.
        filter: String,
        /// Length of the alignment.
        seconds: f64,
    },
    /// No values of the parameters explain a log even roughly.
    #[error("{filter} explains this log neither with what it found nor with what was believed before")]
    NoGuess {
        /// Name of the filter.
        filter: String,
    },
    /// There is nothing to compare navigation with.
    #[error("no row has a reference position to compare with")]
    NoPosition,
    /// Navigation ended in what is no number.
    #[error("navigation with the calibration of {filter} leads nowhere: its position is no number any more")]
    Lost {
        /// Name of the filter.
        filter: String,
    },
    /// The memory of the smoother failed.
    #[error("the temporary file of the smoother: {0}")]
    Tape(#[from] std::io::Error),
    /// A filter cannot be composed so.
    #[error(transparent)]
    Compose(#[from] crate::ComposeError),
    /// There is no effect of a name.
    #[error("there is no effect called {name}")]
    NoEffect {
        /// The name.
        name: String,
    },
    /// There is no filter of a name.
    #[error("there is no filter called {name}")]
    NoFilter {
        /// The name.
        name: String,
    },
}
