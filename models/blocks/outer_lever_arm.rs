use super::units::MILLI;

effect! {
    /// Outer lever arm: from the IMU's sensitive centre to the observed point.
    ///
    /// - Frame: vector in b.
    /// - Equation: `z_v = v + C (omega_eb x l) - v_ref`, `z_p = p + C l - p_ref` (Eq. 36-37, 46-49).
    /// - Sign: residuals are predicted minus reference, the state is truth minus estimate; hence
    ///   `-C [omega_eb x]` and `-C`.
    /// - Prior: 0.5 m: an IMU put on a turntable by eye.
    OuterLeverArm {
        table: outer_lever_arm,
        jacobian: measurement,
        needs: &[],
        prior: 0.5,
        sheet: "mm" = MILLI,
    }
}
