//! Why a diagnosis ends without a verdict.

use crate::scene::SceneError;

/// The log to diagnose, as errors name it.
pub(crate) const FIRST: &str = "log";
/// The one to verify with.
pub(crate) const SECOND: &str = "verification log";

/// Why a log cannot be diagnosed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// A filter diverged.
    #[error("the {log}: {source}")]
    Diverged {
        /// Which log.
        log: &'static str,
        /// When.
        source: sinscal::Diverged,
    },
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
        let (Self::Diverged { log, .. } | Self::TooShort { log, .. } | Self::Indefinite { log }) = self;
        *log == SECOND
    }

    pub(crate) fn of(log: &'static str, error: SceneError) -> Self {
        match error {
            SceneError::Diverged(source) => Self::Diverged { log, source },
            SceneError::TooShort { updates } => Self::TooShort { log, updates },
            SceneError::Indefinite => Self::Indefinite { log },
        }
    }
}
