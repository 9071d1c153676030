//! Why a diagnosis ends without a verdict.

use sinscal::Diverged;

use runs::ReadError;

/// The log to diagnose, as errors name it.
pub(crate) const FIRST: &str = "log";
/// The one to verify with.
pub(crate) const SECOND: &str = "verification log";

/// Why a log cannot be diagnosed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A sample cannot be read.
    #[error("the {log} cannot be read: {source}")]
    Unreadable {
        /// Which log.
        log: &'static str,
        /// What its [`Samples`](runs::Samples) say.
        source: ReadError,
    },
    /// A filter diverged.
    #[error("the {log}: {source}")]
    Diverged {
        /// Which log.
        log: &'static str,
        /// When.
        source: Diverged,
    },
    /// The effects cannot be added to the filter.
    #[error(transparent)]
    Compose(#[from] runs::ComposeError),
    /// Too little to judge by.
    #[error(
        "{updates} updates by the reference in the {log} are too few to judge by; at least 100 are needed"
    )]
    TooShort {
        /// Which log.
        log: &'static str,
        /// Updates there are.
        updates: usize,
    },
    /// The linear run broke down.
    #[error("the innovation covariance of the {log} is not positive definite; check the stated noise")]
    Indefinite {
        /// Which log.
        log: &'static str,
    },
}

impl Error {
    /// Whether it is the verification log that is at fault.
    pub fn is_of_verification(&self) -> bool {
        match self {
            Self::Unreadable { log, .. }
            | Self::Diverged { log, .. }
            | Self::TooShort { log, .. }
            | Self::Indefinite { log } => *log == SECOND,
            Self::Compose(_) => false,
        }
    }

    pub(crate) fn of(log: &'static str, error: SceneError) -> Self {
        match error {
            SceneError::Unreadable(source) => Self::Unreadable { log, source },
            SceneError::Diverged(source) => Self::Diverged { log, source },
            SceneError::TooShort { updates } => Self::TooShort { log, updates },
            SceneError::Indefinite => Self::Indefinite { log },
        }
    }
}

/// Why a log cannot be diagnosed, whichever it is.
#[derive(Debug)]
pub(crate) enum SceneError {
    Unreadable(ReadError),
    Diverged(Diverged),
    TooShort { updates: usize },
    Indefinite,
}

impl From<ReadError> for SceneError {
    fn from(fault: ReadError) -> Self {
        Self::Unreadable(fault)
    }
}

impl From<std::io::Error> for SceneError {
    fn from(fault: std::io::Error) -> Self {
        Self::Unreadable(fault.into())
    }
}

impl From<runs::Error> for SceneError {
    fn from(error: runs::Error) -> Self {
        match error {
            runs::Error::Diverged { diverged, .. } => Self::Diverged(diverged),
            runs::Error::Unreadable(source) => Self::Unreadable(source),
            other => Self::Unreadable(other.into()),
        }
    }
}
