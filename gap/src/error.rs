//! Why a diagnosis ends without a verdict.

use core::fmt::{Display, Formatter};

use sinscal::Diverged;

use runs::ReadError;

/// Which of the logs of a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// One of those to diagnose, by its place.
    Log(usize),
    /// The one to verify with.
    Verification,
}

impl Which {
    /// The first one to diagnose.
    pub(crate) const FIRST: Self = Self::Log(0);
}

impl Display for Which {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Log(0) => f.write_str("log"),
            Self::Log(place) => write!(f, "log number {}", place + 1),
            Self::Verification => f.write_str("verification log"),
        }
    }
}

/// Why a log cannot be diagnosed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A sample cannot be read.
    #[error("the {log} cannot be read: {source}")]
    Unreadable {
        /// Which log.
        log: Which,
        /// What its [`Samples`](runs::Samples) say.
        source: ReadError,
    },
    /// A filter diverged.
    #[error("the {log}: {source}")]
    Diverged {
        /// Which log.
        log: Which,
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
        log: Which,
        /// Updates there are.
        updates: usize,
    },
    /// The linear run broke down.
    #[error("the innovation covariance of the {log} is not positive definite; check the stated noise")]
    Indefinite {
        /// Which log.
        log: Which,
    },
}

impl Error {
    /// The log that is at fault, where it is one.
    pub fn which(&self) -> Option<Which> {
        match self {
            Self::Unreadable { log, .. }
            | Self::Diverged { log, .. }
            | Self::TooShort { log, .. }
            | Self::Indefinite { log } => Some(*log),
            Self::Compose(_) => None,
        }
    }

    pub(crate) fn of(log: Which, error: SceneError) -> Self {
        match error {
            SceneError::Unreadable(source) => Self::Unreadable { log, source },
            SceneError::Diverged(source) => Self::Diverged { log, source },
            SceneError::Indefinite => Self::Indefinite { log },
        }
    }
}

/// Why a log cannot be diagnosed, whichever it is.
#[derive(Debug)]
pub(crate) enum SceneError {
    Unreadable(ReadError),
    Diverged(Diverged),
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
