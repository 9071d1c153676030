//! The noise of a sensor at rest: overlapping Allan deviation with confidence, and the composite of noise processes that explains it.
//!
//! It knows nothing of inertial units. A [`Channel`] takes the readings of a sensor, rest by rest, and keeps their running sum in a
//! temporary file; [`scales`] makes the Allan variances of octaves of averaging times from it in bounded memory. [`identify`] fits
//! sums of [`Process`]es to them and chooses one; [`intervals`] says how well each parameter is known.
//!
//! The fit is the generalised method of wavelet moments (S. Guerrier, J. Skaloud, Y. Stebler, M.-P. Victoria-Feser, "Wavelet-variance-
//! based estimation for composite stochastic processes", J. Am. Stat. Assoc. 108, 2013) with the Haar wavelet, whose variance at an
//! averaging time is half the Allan variance there: the moments are the same numbers.
//!
//! Units: a reading is u (rad/s, m/s^2, anything), times are s. Everything is a continuous-time density or size: quantisation u s,
//! white u sqrt(s), Gauss-Markov u, random walk u/sqrt(s), ramp u/s. Bounds are those of 95 %.

mod allan;
mod bootstrap;
mod channel;
mod edf;
mod fit;
mod model;
mod record;
mod whole;

pub use allan::{Scale, scales};
pub use bootstrap::{Interval, intervals};
pub use channel::{Channel, Finished};
pub use edf::{PowerLaw, edf};
pub use fit::{Fit, identify};
pub use model::{Kind, Process, composite, simulate};
pub use record::{Recorded, Recorder};
pub use whole::{Component, Identified, most_white, typical};

/// Probability that a true value lies below the lower bound of an interval, and above the upper one.
const TAIL: f64 = 0.025;
