//! Groups of blocks that belong to one triad of sensors.

use state_macro::StateBlocks;

use super::{
    AccelBias, AccelMisalignment, AccelQuadratic, AccelScale, GyroBias, GyroMisalignment, GyroScale,
};

/// The nine errors of a gyro triad: scale, installation, bias (Eq. 22, 26, 34).
///
/// The body frame is tied to the triad, x along the x gyro's sensitive axis and y in the plane of the x and y gyros: three
/// installation angles remain.
#[derive(Debug, StateBlocks)]
#[group]
pub struct GyroErrors {
    scale: GyroScale,
    misalignment: GyroMisalignment,
    bias: GyroBias,
}

/// The fifteen errors of an accelerometer triad: scale, installation, bias, quadratic scale factor (Eq. 23, 27, 35).
#[derive(Debug, StateBlocks)]
#[group]
pub struct AccelErrors {
    scale: AccelScale,
    misalignment: AccelMisalignment,
    bias: AccelBias,
    quadratic: AccelQuadratic,
}

/// The twelve errors of an accelerometer triad that are linear in the specific force: scale, installation, bias.
#[derive(Debug, StateBlocks)]
#[group]
pub struct LinearAccelErrors {
    scale: AccelScale,
    misalignment: AccelMisalignment,
    bias: AccelBias,
}
