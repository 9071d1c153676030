//! The paper's analyses of dither and delay (sections 3.2 and 3.3 of doi:10.3390/s22010278), closed form beside simulation.
//!
//! They return numbers; drawing them is somebody else's work.

pub mod delay;
pub mod size_effect;
