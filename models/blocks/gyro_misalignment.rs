use super::units::ARCSEC;

effect! {
    /// Installation errors of the gyros: yx, zx, zy.
    ///
    /// - Equation: `d_omega_y = m_yx omega_x`, `d_omega_z = m_zx omega_x + m_zy omega_y` (Eq. 22, 24-34). The
    ///   first letter is the gyro that reads, the second the axis it reads by mistake.
    /// - Only three: b is tied to the gyros, x_b along the x gyro and y_b in the plane of the x and y gyros.
    /// - Sign: a positive `yx` makes gyro y read more when the body turns about +x.
    /// - Prior: 1 mrad: machining and mounting tolerance of a sensor block.
    GyroMisalignment {
        table: gyro_misalignment,
        jacobian: input,
        needs: &[],
        prior: 1e-3,
        sheet: "arcsec" = ARCSEC,
    }
}
