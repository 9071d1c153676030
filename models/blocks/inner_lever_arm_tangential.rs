use super::units::MILLI;

effect! {
    /// Inner lever arms across the accelerometers' axes: xy, xz, yx, yz, zx, zy.
    ///
    /// - Frame: accelerometer i sits at `r_ij` along axis j of b, from the IMU's sensitive centre; `xy` is
    ///   accelerometer x along y.
    /// - Equation: `u_i . (omega x (omega x r_i) + omega' x r_i)` with `r_i` perpendicular to `u_i` (Eq.
    ///   1-5); for x it is `(omega_x omega_y - omega'_z) r_xy + (omega_x omega_z + omega'_y) r_xz`. Dither
    ///   has no mean effect on it.
    /// - Observability: with [`InnerLeverArm`](crate::InnerLeverArm) and
    ///   [`OuterLeverArm`](crate::OuterLeverArm) three directions stay free, since a common shift of the
    ///   accelerometers is the same as moving the outer lever arm.
    /// - Sign: as in the equation; the reading, not its correction.
    /// - Prior: 0.1 m: the accelerometers are inside the case.
    InnerLeverArmTangential {
        table: inner_lever_arm_tangential,
        jacobian: input,
        needs: &[],
        prior: 0.1,
        sheet: "mm" = MILLI,
    }
}
