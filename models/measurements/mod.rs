//! Measurements of strapdown filters: ours, and what runs need to take any of them from a log.
//!
//! A measurement is a type; `measures(...)` knows ours by their names, and any by its path:
//!
//! ```
//! use sinscal::prelude::*;
//! use sinscal::{Point, channel};
//! use nalgebra::Vector3;
//!
//! /// Distance to a beacon that stands 3 m north of the site origin.
//! struct Range;
//!
//! fn from_beacon<T: Real>(at: &Point<T>) -> Vector3<T> {
//!     at.point_position - Vector3::new(T::zero(), T::of(3.0), T::zero())
//! }
//!
//! impl Measurement for Range {
//!     type Dynamics = Strapdown;
//!     const INFO: MeasurementInfo = MeasurementInfo {
//!         name: "range",
//!         components: &["r"],
//!         unit: "m",
//!         columns: &["range_m"],
//!         sigma: 1e-3,
//!         channels: None, // a function of channels, not one of them
//!     };
//!     fn residual<T: Real>(at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
//!         put(0, from_beacon(at).norm() - reading[0]);
//!     }
//!     fn jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
//!         let way = from_beacon(at).normalize();
//!         for i in 0..3 {
//!             put(0, channel::POSITION + i, way[i]);
//!         }
//!     }
//! }
//!
//! #[derive(StateBlocks)]
//! #[filter(measures(velocity, Range))]
//! struct MyUnit {
//!     #[base]
//!     sins: sinscal::Sins36P,
//!     delay: ReferenceDelay, // acts on the range too: blocks act on channels
//! }
//! ```

mod attitude;
mod heading;
mod readings;

pub use attitude::Attitude;
pub use calib_core::{Measurement, MeasurementInfo};
pub use heading::Heading;
pub(crate) use readings::{KNOWN, Reading, Readings, own_columns};

use calib_core::Real;

use crate::{Point, Strapdown};

/// First channels of what a reference sees: [`Strapdown`]'s numbering.
pub mod channel {
    /// Velocity of the observed point over ground, east, north, up, m/s.
    pub const VELOCITY: usize = 0;
    /// Position of the observed point from the site origin, east, north, up, m.
    pub const POSITION: usize = 3;
    /// Attitude, east, north, up, rad: `C_pred = (I - [z x]) C_ref`.
    pub const ATTITUDE: usize = 6;
    /// Rate of the body against the Earth, along x, y, z of b, rad/s.
    pub const RATE: usize = 9;
}

const ENU: &[&str] = &["e", "n", "u"];

/// Ours, as `measures(...)` knows them by name.
pub const OURS: [MeasurementInfo; 6] =
    [Velocity::INFO, Position::INFO, Attitude::INFO, Rate::INFO, Height::INFO, Heading::INFO];

/// A measurement whose rows are channels as they are, `computed - read` of a vector.
macro_rules! vector {
    ($(#[$doc:meta])* $name:ident, $info:expr, |$at:ident| $computed:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl Measurement for $name {
            type Dynamics = Strapdown;
            const INFO: MeasurementInfo = $info;

            #[inline]
            fn residual<T: Real>($at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
                for i in 0..Self::INFO.components.len() {
                    put(i, $computed[i] - reading[i]);
                }
            }
        }
    };
}

vector! {
    /// Velocity of the observed point over ground: east, north, up.
    ///
    /// - Equation: `z = v + C (omega_eb x l) - v_ref` (Eq. 36, 46-47).
    Velocity,
    MeasurementInfo {
        name: "velocity",
        components: ENU,
        unit: "m/s",
        columns: &["ref_vel_e", "ref_vel_n", "ref_vel_u"],
        sigma: 1e-3,
        channels: Some(channel::VELOCITY),
    },
    |at| at.point_velocity
}

vector! {
    /// Position of the observed point from the site origin: east, north, up.
    ///
    /// - Equation: `z = p + C l - p_ref` (Eq. 37, 48-49).
    Position,
    MeasurementInfo {
        name: "position",
        components: ENU,
        unit: "m",
        columns: &["ref_pos_e", "ref_pos_n", "ref_pos_u"],
        sigma: 2e-3,
        channels: Some(channel::POSITION),
    },
    |at| at.point_position
}

vector! {
    /// Rate of the body against the Earth, in b: zero at rest. The biases of the gyros are then seen at once.
    ///
    /// - Equation: `z = omega_ib - C^T omega_ie - omega_eb_ref`, omega_ib that of the compensated gyros. A heading in doubt leaves
    ///   the Earth's part in doubt, up to 15 deg/h: the attitude error is in the rows.
    /// - A run takes the mean over the samples with a reading since the last update, and adds what the gyros' random walk
    ///   leaves of it to the variance. The sigma says how well the rate is known, and must hold how far the biases wander
    ///   where no block does. One far below the random walk over an update makes sigmas too small by up to the root of two: the
    ///   same random walk drives the attitude, and where velocity shows a bias as well it is taken for two.
    /// - Blocks of the reference (delay, tilt, misalignment) do not act on it.
    Rate,
    MeasurementInfo {
        name: "rate",
        components: &["x", "y", "z"],
        unit: "rad/s",
        columns: &["ref_rate_x", "ref_rate_y", "ref_rate_z"],
        sigma: 1e-6,
        channels: Some(channel::RATE),
    },
    |at| at.rate_eb
}

vector! {
    /// Height of the observed point over the site origin.
    ///
    /// - Equation: the third row of [`Position`].
    Height,
    MeasurementInfo {
        name: "height",
        components: &["u"],
        unit: "m",
        columns: &["ref_height"],
        sigma: 2e-3,
        channels: Some(channel::POSITION + 2),
    },
    |at| [at.point_position.z]
}
