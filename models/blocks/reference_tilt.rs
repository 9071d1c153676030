use super::units::ARCSEC;

effect! {
    /// A reference that is not level: tilt about east and north.
    ///
    /// - Frame: rotation vector in n without a component up.
    /// - Equation: `x_ref = (I - [tilt x]) x` for its velocity and position, `C_ref = (I - [tilt x]) C`. Not
    ///   in the paper.
    /// - Where: the frame turns as a whole about the site's origin; a path of kilometres, over which the vertical turns by
    ///   itself, is not what this means.
    /// - Sign: as of the attitude error: a reference with a positive tilt reports what a computed frame with
    ///   that error would.
    /// - Prior: 1 mrad, about 200 arcsec: a turntable levelled with a spirit level.
    ReferenceTilt {
        table: reference_tilt,
        jacobian: measurement,
        needs: &[],
        prior: 1e-3,
        sheet: "arcsec" = ARCSEC,
    }
}
