use super::units::ARCSEC;

effect! {
    /// Installation errors of the accelerometers: xy, xz, yx, yz, zx, zy.
    ///
    /// - Equation: `d_f_i = sum over j != i of m_ij f_j` (Eq. 23, 35). The first letter is the accelerometer
    ///   that reads, the second the axis it reads by mistake. All six, since b is tied to the gyros.
    /// - Sign: a positive `xy` makes accelerometer x read more under a force along +y.
    /// - Prior: 1 mrad: machining and mounting tolerance of a sensor block.
    AccelMisalignment {
        table: accel_misalignment,
        jacobian: input,
        needs: &[],
        prior: 1e-3,
        sheet: "arcsec" = ARCSEC,
    }
}
