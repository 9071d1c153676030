use super::units::ARCSEC;

effect! {
    /// Small rotation from b to the body frame whose attitude the reference reports.
    ///
    /// - Frame: rotation vector m in b.
    /// - Equation: `C_ref = C (I + [m x])`, hence `z_a = C delta`. Not in the paper. It shows only where
    ///   attitude is measured.
    /// - Sign: a positive component turns the reference's body frame about that axis of b.
    /// - Prior: 10 mrad: a unit bolted to a table against a mark.
    ReferenceMisalignment {
        table: reference_misalignment,
        jacobian: measurement,
        needs: &[],
        prior: 1e-2,
        sheet: "arcsec" = ARCSEC,
    }
}
